//! Meshes chosen to break builders, and a check of trees that shares nothing with the crate's own.

#![allow(dead_code, reason = "each test program uses a part")]

use eyerays_bvh::{Bvh, MAX_DEPTH, Quality, build};
use eyerays_shader::data::{MAX_LEAF, NodePair, NodeRef, Triangle, numbers};
use glam::{Vec3, vec3};

pub const QUALITIES: [Quality; 3] = [Quality::Fast, Quality::Medium, Quality::High];

/// Records of vertices, numbered from 0.
pub fn mesh(vertices: impl IntoIterator<Item = [Vec3; 3]>) -> Vec<Triangle> {
    let numbered = vertices.into_iter().zip(0..);
    numbered.map(|(v, i)| Triangle::new(v, i, 0, 0)).collect()
}

pub fn duplicates(count: u32) -> Vec<Triangle> {
    mesh((0..count).map(|_| [Vec3::ZERO, Vec3::X, Vec3::Y]))
}

/// Spokes of a wheel: all share the hub.
pub fn fan(spokes: u32) -> Vec<Triangle> {
    let rim = |i: u32| {
        let angle = i as f32 / spokes as f32 * std::f32::consts::TAU;
        vec3(angle.cos(), angle.sin(), 0.0)
    };
    mesh((0..spokes).map(|i| [Vec3::ZERO, rim(i), rim(i + 1)]))
}

/// Triangles that share a corner, each a little larger than the one before and around it.
pub fn nested(count: u32) -> Vec<Triangle> {
    mesh((1..=count).map(|i| {
        let size = i as f32 / count as f32;
        [Vec3::ZERO, vec3(size, 0.0, 0.0), vec3(0.0, size, 0.0)]
    }))
}

/// Triangles that share a corner, `each` of them per power of two.
pub fn shrinking(scales: u32, each: u32) -> Vec<Triangle> {
    mesh((0..scales * each).map(|i| {
        let size = 0.5f32.powi((i / each) as i32) * (1.0 - 0.4 * (i % each) as f32 / each as f32);
        [vec3(size, 0.0, 0.0), vec3(0.0, size, 0.0), vec3(0.0, 0.0, size)]
    }))
}

/// Triangles whose boxes have one centre and sizes of their own.
pub fn concentric(count: u32) -> Vec<Triangle> {
    mesh((1..=count).map(|i| {
        let size = i as f32 / count as f32;
        [vec3(-size, -size, -size), vec3(size, -size, 0.0), vec3(0.0, size, size)]
    }))
}

/// Triangles without area, evenly spaced along an axis.
pub fn collinear(count: u32) -> Vec<Triangle> {
    let at = |i: u32| vec3(i as f32 / (1 << 17) as f32, 0.0, 0.0);
    mesh((0..count).map(|i| [at(i), at(i + 1), at(i)]))
}

/// Two triangles a cell of a square grid: neighbours cost the same in every direction.
pub fn grid(edge: u32) -> Vec<Triangle> {
    let at = |x: u32, y: u32| vec3(x as f32, y as f32, 0.0) / 1024.0;
    mesh((0..edge * edge).flat_map(|i| {
        let (x, y) = (i % edge, i / edge);
        let (a, b) = (at(x + 1, y), at(x, y + 1));
        [[at(x, y), a, b], [at(x + 1, y + 1), a, b]]
    }))
}

/// Small triangles all over, from a seed.
pub fn scattered(count: u32, seed: u32) -> Vec<Triangle> {
    let mut state = seed;
    let mut next = move || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (state >> 8) as f32 / (1 << 23) as f32 - 1.0
    };
    let mut point = move || vec3(next(), next(), next());
    mesh((0..count).map(|_| {
        let p = point() * 0.9;
        [p, p + point() * 0.05, p + point() * 0.05]
    }))
}

/// Builds and checks at every quality.
pub fn build_and_check_all(triangles: &[Triangle]) {
    for quality in QUALITIES {
        build_and_check(triangles, quality);
    }
}

/// Builds, and checks every promise of the result.
pub fn build_and_check(triangles: &[Triangle], quality: Quality) -> Bvh {
    let bvh = build(triangles, quality).expect("a valid mesh");
    let sorted = bvh.gather(triangles);
    let mut primitives: Vec<u32> = sorted.iter().map(Triangle::primitive).collect();
    primitives.sort();
    let mut expected: Vec<u32> = triangles.iter().map(Triangle::primitive).collect();
    expected.sort();
    assert_eq!(primitives, expected, "slots lost or doubled a triangle");

    let mut walk = Walk { nodes: &bvh.nodes, triangles: &sorted, pairs: 0, slots: 0 };
    walk.pair(0, 1);
    assert_eq!(walk.pairs as usize, bvh.nodes.len(), "pairs");
    assert_eq!(walk.slots as usize, triangles.len(), "slots");
    bvh
}

/// A walk in depth-first order, which is the order that pairs and slots must have.
struct Walk<'a> {
    nodes: &'a [NodePair],
    triangles: &'a [Triangle],
    pairs: u32,
    slots: u32,
}

type Corners = (Vec3, Vec3);

impl Walk<'_> {
    fn pair(&mut self, pair: u32, depth: u32) -> Corners {
        assert_eq!(pair, self.pairs, "pairs are not in depth-first order");
        assert!(depth <= MAX_DEPTH, "too deep");
        self.pairs += 1;
        let NodePair { left_min, left_max, right_min, right_max } = self.nodes[pair as usize];
        let left = (numbers(left_min), numbers(left_max));
        let right = (numbers(right_min), numbers(right_max));
        assert_eq!(self.child(NodeRef(left_min.w), depth), left, "left box");
        if self.triangles.len() == 1 {
            assert_eq!((right.0, right.1, NodeRef(right_min.w)), NodePair::EMPTY);
            return left;
        }
        assert_eq!(self.child(NodeRef(right_min.w), depth), right, "right box");
        (left.0.min(right.0), left.1.max(right.1))
    }

    /// The box that a child must have, computed from what is below it.
    fn child(&mut self, child: NodeRef, depth: u32) -> Corners {
        if !child.is_leaf() {
            return self.pair(child.index(), depth + 1);
        }
        assert_eq!(child.index(), self.slots, "slots are not in order");
        assert!(child.count() <= MAX_LEAF);
        self.slots += child.count();
        self.triangles[child.index() as usize..self.slots as usize]
            .iter()
            .map(Triangle::bounds)
            .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
            .expect("a leaf has triangles")
    }
}
