//! A part of a triangle, and where a plane cuts it.

use eyerays_shader::data::{BOX_PADDING, Primitive};
use glam::Vec3;

use crate::bounds::Bounds;

/// The part of a triangle inside a box, which is as tight as the cuts so far allow.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub triangle: u32,
    /// The part's extent, without padding.
    pub bounds: Bounds,
}

/// More than the error of a cut, and less than padding: in [-1, 1] its double precision errs by less than
/// 2^-50, the conversion by 2^-25 and the slack's sum by 2^-24.
const SLACK: f32 = 1.0 / (1u64 << 23) as f32;

impl Part {
    /// All of a primitive.
    pub fn whole(number: u32, primitive: &Primitive) -> Self {
        let bounds = if primitive.is_triangle() {
            Bounds::around(primitive.vertices().map(|v| Bounds::new(v, v)))
        } else {
            Bounds::of(primitive)
        };
        Part { triangle: number, bounds }
    }

    /// The parts on either side of a plane across `axis`; `None` for a side without a point. What is no triangle is not cut:
    /// it is whole on both sides, which never pays.
    pub fn cut(self, triangle: &Primitive, axis: usize, plane: f32) -> [Option<Part>; 2] {
        if !triangle.is_triangle() {
            return [Some(self); 2];
        }
        let mut sides = [Bounds::EMPTY; 2];
        let vertices = triangle.vertices();
        for (from, to) in [(0, 1), (1, 2), (2, 0)] {
            let (from, to) = (vertices[from], vertices[to]);
            let (below, above) = (from[axis] < plane, to[axis] < plane);
            if from[axis] <= plane {
                sides[0] = sides[0].union(Bounds::new(from, from));
            }
            if from[axis] >= plane {
                sides[1] = sides[1].union(Bounds::new(from, from));
            }
            if below != above {
                let crossing = crossing(from, to, axis, plane);
                sides = sides.map(|side| side.union(crossing));
            }
        }
        sides[0].max[axis] = sides[0].max[axis].min(plane);
        sides[1].min[axis] = sides[1].min[axis].max(plane);
        sides.map(|side| {
            let bounds = side.intersection(self.bounds);
            (!bounds.is_empty()).then_some(Part { bounds, ..self })
        })
    }

    /// The box with padding, inside the triangle's own.
    pub fn own_box(&self, triangle: &Primitive) -> Bounds {
        let Bounds { min, max } = self.bounds;
        let padded = Bounds { min: min.map(|c| c - BOX_PADDING), max: max.map(|c| c + BOX_PADDING) };
        padded.intersection(Bounds::of(triangle))
    }
}

/// A box around where an edge crosses a plane.
fn crossing(from: Vec3, to: Vec3, axis: usize, plane: f32) -> Bounds {
    let (from, to, plane) = (from.as_dvec3(), to.as_dvec3(), f64::from(plane));
    let along = (plane - from[axis]) / (to[axis] - from[axis]);
    let point = (from + (to - from) * along).as_vec3();
    Bounds::new(point - SLACK, point + SLACK)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::vec3;

    #[test]
    fn a_triangle_is_cut_to_its_extent_on_either_side() {
        let triangle = Primitive::triangle([Vec3::ZERO, Vec3::X, vec3(0.0, 1.0, 0.5)], 0, 0, 0);
        let [left, right] = Part::whole(3, &triangle).cut(&triangle, 0, 0.75).map(Option::unwrap);
        assert_eq!((left.triangle, right.triangle), (3, 3));
        assert_eq!((left.bounds.min, left.bounds.max), ([0.0; 3], [0.75, 1.0, 0.5]));
        assert_eq!(right.bounds.min[0], 0.75);
        assert!((right.bounds.max[1] - 0.25).abs() < 1e-6 && right.bounds.max[1] >= 0.25);
        assert!((right.bounds.max[2] - 0.125).abs() < 1e-6 && right.bounds.max[2] >= 0.125);
    }

    #[test]
    fn a_part_beside_the_plane_stays_whole() {
        let triangle = Primitive::triangle([Vec3::ZERO, Vec3::X, Vec3::Y], 0, 0, 0);
        let [left, right] = Part::whole(0, &triangle).cut(&triangle, 1, 2.0);
        assert!(right.is_none());
        assert_eq!(left.unwrap().bounds, Part::whole(0, &triangle).bounds);
    }

    #[test]
    fn a_whole_triangle_has_its_own_box() {
        let triangle = Primitive::triangle([Vec3::ZERO, vec3(0.3, 0.1, -0.7), Vec3::Y], 0, 0, 0);
        assert_eq!(Part::whole(0, &triangle).own_box(&triangle), Bounds::of(&triangle));
    }
}
