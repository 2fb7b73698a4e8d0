//! A part of a triangle, and where a plane cuts it.

use eyerays_shader::data::{BOX_PADDING, NodeRef, Primitive};
use glam::{BVec3A, DVec3, Vec3A, Vec4};

use crate::bounds::Bounds;

/// The part of a triangle inside a box, which is as tight as the cuts so far allow.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    /// The least corner of its extent, without padding, and as bits the triangle's number and whether it is one.
    least: Vec4,
    greatest: Vec4,
}

/// Makes any triangle's number a normal floating-point number: the lane takes part in all operations, and a division of a
/// subnormal number takes as long as ten others.
const NORMAL: u32 = 1 << 30;

/// What is no triangle: the sign.
const OTHER: u32 = 1 << 31;

const _: () = assert!(NodeRef::MAX_INDEX < NORMAL);

/// More than the error of a cut, and less than padding: in [-1, 1] its double precision errs by less than
/// 2^-50, the conversion by 2^-25 and the slack's sum by 2^-24.
const SLACK: f32 = 1.0 / (1u64 << 23) as f32;

impl Part {
    /// What fills room.
    pub const NONE: Part = Part { least: Vec4::ZERO, greatest: Vec4::ZERO };

    /// All of a primitive.
    pub fn whole(number: u32, primitive: &Primitive) -> Self {
        if !primitive.is_triangle() {
            return Part::new(number | NORMAL | OTHER, Bounds::of(primitive));
        }
        let [a, b, c] = primitive.vertices().map(Vec3A::from);
        Part::new(number | NORMAL, Bounds::new(a.min(b).min(c), a.max(b).max(c)))
    }

    fn new(bits: u32, bounds: Bounds) -> Self {
        Part { least: bounds.min.extend(f32::from_bits(bits)), greatest: bounds.max.extend(1.0) }
    }

    /// The same of another extent.
    fn within(&self, bounds: Bounds) -> Part {
        Part::new(self.least.w.to_bits(), bounds)
    }

    /// The triangle's number.
    pub fn triangle(&self) -> u32 {
        self.least.w.to_bits() & !(NORMAL | OTHER)
    }

    /// Is it of a triangle? Else it is whole.
    pub fn is_triangle(&self) -> bool {
        self.least.w.to_bits() & OTHER == 0
    }

    /// The part's extent, without padding.
    pub fn bounds(&self) -> Bounds {
        Bounds { min: Vec3A::from_vec4(self.least), max: Vec3A::from_vec4(self.greatest) }
    }

    /// The parts on either side of a plane across `axis`; `None` for a side without a point. What is no triangle is not cut:
    /// it is whole on both sides, which never pays.
    pub fn cut(self, triangle: &Primitive, axis: usize, plane: f32) -> [Option<Part>; 2] {
        if !self.is_triangle() {
            return [Some(self); 2];
        }
        Edges::of(triangle, axis).sides(self.bounds(), plane).map(|side| side.map(|b| self.within(b)))
    }

    /// The part with its own box: its extent with padding. That is inside the triangle's own box, made of a larger extent by the same sums,
    /// and the triangle itself, which lies somewhere in memory, is not asked.
    pub fn own(self) -> Part {
        let (Bounds { min, max }, padding) = (self.bounds(), Vec3A::splat(BOX_PADDING));
        if self.is_triangle() { self.within(Bounds::new(min - padding, max + padding)) } else { self }
    }

    /// Is it room?
    pub fn is_none(&self) -> bool {
        self.least.w.to_bits() & NORMAL == 0
    }
}

/// A triangle that is cut at planes across an axis.
pub(super) struct Edges {
    axis: usize,
    /// The corners' coordinates along the axis, ascending.
    coordinates: [f32; 3],
    /// The box around as many of the first corners.
    first: [Bounds; 4],
    /// Around all but as many.
    last: [Bounds; 4],
    /// From the first corner to the second, from the second to the third, and from the first to the third.
    edges: [Edge; 3],
}

const AXES: [BVec3A; 3] =
    [BVec3A::new(true, false, false), BVec3A::new(false, true, false), BVec3A::new(false, false, true)];

/// An edge in the triangle's own direction, so that its crossing is the same in whichever triangle.
#[derive(Clone, Copy)]
struct Edge {
    from: DVec3,
    along: DVec3,
}

impl Edges {
    pub fn of(triangle: &Primitive, axis: usize) -> Self {
        let vertices = triangle.vertices().map(Vec3A::from);
        let mut order = [0, 1, 2];
        for (i, j) in [(0, 1), (1, 2), (0, 1)] {
            if vertices[order[j]][axis] < vertices[order[i]][axis] {
                order.swap(i, j);
            }
        }
        let edge = |(i, j): (usize, usize)| {
            let (a, b) = (order[i], order[j]);
            let (from, to) = if (a + 1) % 3 == b { (a, b) } else { (b, a) };
            let from = vertices[from].as_dvec3();
            Edge { from, along: vertices[to].as_dvec3() - from }
        };
        let [a, b, c] = order.map(|i| Bounds::point(vertices[i]));
        Edges {
            axis,
            coordinates: order.map(|i| vertices[i][axis]),
            first: [Bounds::EMPTY, a, a.union(b), a.union(b).union(c)],
            last: [a.union(b).union(c), b.union(c), c, Bounds::EMPTY],
            edges: [(0, 1), (1, 2), (0, 2)].map(edge),
        }
    }

    /// What is inside `bounds` on either side of a plane; `None` for a side without a point.
    #[inline]
    pub fn sides(&self, bounds: Bounds, plane: f32) -> [Option<Bounds>; 2] {
        let count = |is: &dyn Fn(f32) -> bool| self.coordinates.iter().map(|&c| usize::from(is(c))).sum::<usize>();
        let (below, up_to) = (count(&|c| c < plane), count(&|c| c <= plane));
        let mut sides = [self.first[up_to], self.last[below]];
        if let 1 | 2 = below {
            for edge in [self.edges[below - 1], self.edges[2]] {
                let crossing = edge.crossing(self.axis, plane);
                sides = sides.map(|side| side.union(crossing));
            }
        }
        let plane = |elsewhere| Vec3A::select(AXES[self.axis], Vec3A::splat(plane), Vec3A::splat(elsewhere));
        sides[0].max = sides[0].max.min(plane(f32::INFINITY));
        sides[1].min = sides[1].min.max(plane(f32::NEG_INFINITY));
        sides.map(|side| Some(side.intersection(bounds)).filter(|side| !side.is_empty()))
    }
}

impl Edge {
    /// A box around where the edge crosses a plane.
    #[inline]
    fn crossing(&self, axis: usize, plane: f32) -> Bounds {
        let along = (f64::from(plane) - self.from[axis]) / self.along[axis];
        let point = (self.from + self.along * along).as_vec3a();
        Bounds::new(point - SLACK, point + SLACK)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Vec3, vec3};

    #[test]
    fn a_triangle_is_cut_to_its_extent_on_either_side() {
        let triangle = Primitive::triangle([Vec3::ZERO, Vec3::X, vec3(0.0, 1.0, 0.5)], 0, 0, 0);
        let [left, right] = Part::whole(3, &triangle).cut(&triangle, 0, 0.75).map(Option::unwrap);
        assert_eq!((left.triangle(), right.triangle()), (3, 3));
        let (left, right) = (left.bounds(), right.bounds());
        assert_eq!(left, Bounds::new([0.0; 3], [0.75, 1.0, 0.5]));
        assert_eq!(right.min[0], 0.75);
        assert!((right.max[1] - 0.25).abs() < 1e-6 && right.max[1] >= 0.25);
        assert!((right.max[2] - 0.125).abs() < 1e-6 && right.max[2] >= 0.125);
    }

    #[test]
    fn a_part_beside_the_plane_stays_whole() {
        let triangle = Primitive::triangle([Vec3::ZERO, Vec3::X, Vec3::Y], 0, 0, 0);
        let [left, right] = Part::whole(0, &triangle).cut(&triangle, 1, 2.0);
        assert!(right.is_none());
        assert_eq!(left.unwrap().bounds(), Part::whole(0, &triangle).bounds());
    }

    #[test]
    fn a_whole_triangle_has_its_own_box() {
        let triangle = Primitive::triangle([Vec3::ZERO, vec3(0.3, 0.1, -0.7), Vec3::Y], 0, 0, 0);
        assert_eq!(Part::whole(0, &triangle).own().bounds(), Bounds::of(&triangle));
    }
}
