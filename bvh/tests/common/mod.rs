//! Meshes chosen to break builders, and a check of trees that shares nothing with the crate's own.

#![allow(dead_code, reason = "each test program uses a part")]

mod bvh8;

use eyerays_bvh::{Bvh, MAX_DEPTH, MAX_WIDE_DEPTH, Quality, References, build, split};
use eyerays_shader::data::{Bounds, CwbvhNode, MAX_LEAF, NodePair, NodeRef, Primitive, numbers};
use glam::{Vec3, vec3};

pub const QUALITIES: [Quality; 3] = [Quality::Fast, Quality::Medium, Quality::High];

/// Records of vertices, numbered from 0.
pub fn mesh(vertices: impl IntoIterator<Item = [Vec3; 3]>) -> Vec<Primitive> {
    let numbered = vertices.into_iter().zip(0..);
    numbered.map(|(v, i)| Primitive::triangle(v, i, 0, 0)).collect()
}

pub fn duplicates(count: u32) -> Vec<Primitive> {
    mesh((0..count).map(|_| [Vec3::ZERO, Vec3::X, Vec3::Y]))
}

/// Spokes of a wheel: all share the hub.
pub fn fan(spokes: u32) -> Vec<Primitive> {
    let rim = |i: u32| {
        let angle = i as f32 / spokes as f32 * std::f32::consts::TAU;
        vec3(angle.cos(), angle.sin(), 0.0)
    };
    mesh((0..spokes).map(|i| [Vec3::ZERO, rim(i), rim(i + 1)]))
}

/// Triangles that share a corner, each a little larger than the one before and around it.
pub fn nested(count: u32) -> Vec<Primitive> {
    mesh((1..=count).map(|i| {
        let size = i as f32 / count as f32;
        [Vec3::ZERO, vec3(size, 0.0, 0.0), vec3(0.0, size, 0.0)]
    }))
}

/// Triangles that share a corner, `each` of them per power of two.
pub fn shrinking(scales: u32, each: u32) -> Vec<Primitive> {
    mesh((0..scales * each).map(|i| {
        let size = 0.5f32.powi((i / each) as i32) * (1.0 - 0.4 * (i % each) as f32 / each as f32);
        [vec3(size, 0.0, 0.0), vec3(0.0, size, 0.0), vec3(0.0, 0.0, size)]
    }))
}

/// Triangles whose boxes have one centre and sizes of their own.
pub fn concentric(count: u32) -> Vec<Primitive> {
    mesh((1..=count).map(|i| {
        let size = i as f32 / count as f32;
        [vec3(-size, -size, -size), vec3(size, -size, 0.0), vec3(0.0, size, size)]
    }))
}

/// Triangles without area, evenly spaced along an axis.
pub fn collinear(count: u32) -> Vec<Primitive> {
    let at = |i: u32| vec3(i as f32 / (1 << 17) as f32, 0.0, 0.0);
    mesh((0..count).map(|i| [at(i), at(i + 1), at(i)]))
}

/// Two triangles a cell of a square grid: neighbours cost the same in every direction.
pub fn grid(edge: u32) -> Vec<Primitive> {
    let at = |x: u32, y: u32| vec3(x as f32, y as f32, 0.0) / 1024.0;
    mesh((0..edge * edge).flat_map(|i| {
        let (x, y) = (i % edge, i / edge);
        let (a, b) = (at(x + 1, y), at(x, y + 1));
        [[at(x, y), a, b], [at(x + 1, y + 1), a, b]]
    }))
}

/// Long thin triangles, as diagonals of the scene: their boxes overlap and they do not.
pub fn slivers(count: u32) -> Vec<Primitive> {
    let corner = |i: u32, z: f32| vec3(i as f32 / count as f32 - 1.0, 0.01 * z, z);
    mesh((0..count).map(|i| {
        let to = corner(i, 0.9) + vec3(1.0, 0.7, 0.0);
        [corner(i, -0.9), to, to + vec3(0.0, 0.01, 0.02)]
    }))
}

/// Small triangles all over, from a seed.
pub fn scattered(count: u32, seed: u32) -> Vec<Primitive> {
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

/// 300 triangles, some of which share leaves.
pub fn mixed() -> Vec<Primitive> {
    let mut triangles = scattered(280, 29);
    triangles.extend(duplicates(20));
    triangles
}

/// A reference for each triangle, as a scene without split triangles has.
pub fn whole(triangles: &[Primitive]) -> References {
    split(triangles, 0.0).expect("a valid mesh")
}

/// Builds and checks at every quality.
pub fn build_and_check_all(references: &References) {
    for quality in QUALITIES {
        build_and_check(references, quality);
    }
}

/// Builds, and checks every promise of the result, before it has wide nodes and with them.
pub fn build_and_check(references: &References, quality: Quality) -> Bvh {
    let bvh = build(references, quality).expect("valid references");
    let key = |triangle: u32, b: Bounds| (triangle, b.least.to_array(), b.greatest.to_array());
    let mut slots: Vec<_> = bvh.order.iter().zip(&bvh.bounds).map(|(&t, &b)| key(t, b)).collect();
    slots.sort();
    let count = references.list().len();
    let mut expected: Vec<_> = references.list().iter().map(|r| key(r.primitive, r.bounds)).collect();
    expected.sort();
    assert_eq!(slots, expected, "slots lost or doubled a reference");

    check_pairs(&bvh);
    bvh8::check(&bvh);
    let mut widened = bvh.clone();
    widened.widen().expect("a valid hierarchy");
    check_pairs(&widened);
    let mut walk = WideWalk { nodes: &widened.wide, bounds: &widened.bounds, next: 0, met: 1 };
    walk.node(0, 1);
    assert_eq!(walk.met as usize, widened.wide.len(), "wide nodes");
    assert_eq!(walk.next as usize, count, "slots of wide nodes");
    let mut again: Vec<_> = widened.order.iter().zip(&widened.bounds).map(|(&t, &b)| key(t, b)).collect();
    again.sort();
    assert_eq!(again, expected, "slots lost or doubled a reference");
    widened
}

fn check_pairs(bvh: &Bvh) {
    let mut walk = Walk { nodes: &bvh.nodes, bounds: &bvh.bounds, pairs: 0, met: vec![false; bvh.bounds.len()] };
    walk.pair(0, 1);
    assert_eq!(walk.pairs as usize, bvh.nodes.len(), "pairs");
    assert!(walk.met.iter().all(|met| *met), "slots");
}

/// A walk in depth-first order, which is the order that pairs must have.
struct Walk<'a> {
    nodes: &'a [NodePair],
    bounds: &'a [Bounds],
    pairs: u32,
    met: Vec<bool>,
}

type Corners = (Vec3, Vec3);

fn union(a: Corners, b: Corners) -> Corners {
    (a.0.min(b.0), a.1.max(b.1))
}

fn around(bounds: &[Bounds]) -> Corners {
    let corners = bounds.iter().map(|b| (numbers(b.least), numbers(b.greatest)));
    corners.reduce(union).expect("a leaf has triangles")
}

impl Walk<'_> {
    fn pair(&mut self, pair: u32, depth: u32) -> Corners {
        assert_eq!(pair, self.pairs, "pairs are not in depth-first order");
        assert!(depth <= MAX_DEPTH, "too deep");
        self.pairs += 1;
        let NodePair { left_min, left_max, right_min, right_max } = self.nodes[pair as usize];
        let left = (numbers(left_min), numbers(left_max));
        let right = (numbers(right_min), numbers(right_max));
        assert_eq!(self.child(NodeRef(left_min.w), depth), left, "left box");
        if self.bounds.len() == 1 {
            assert_eq!((right.0, right.1, NodeRef(right_min.w)), NodePair::EMPTY);
            return left;
        }
        assert_eq!(self.child(NodeRef(right_min.w), depth), right, "right box");
        union(left, right)
    }

    /// The box that a child must have, computed from what is below it.
    fn child(&mut self, child: NodeRef, depth: u32) -> Corners {
        if !child.is_leaf() {
            return self.pair(child.index(), depth + 1);
        }
        assert!(child.count() <= MAX_LEAF);
        let slots = child.index() as usize..(child.index() + child.count()) as usize;
        for met in &mut self.met[slots.clone()] {
            assert!(!std::mem::replace(met, true), "a slot is met twice");
        }
        around(&self.bounds[slots])
    }
}

/// A walk over wide nodes, whose slots must come in the order of the walk.
struct WideWalk<'a> {
    nodes: &'a [CwbvhNode],
    bounds: &'a [Bounds],
    /// The next slot.
    next: u32,
    /// Nodes met or known of.
    met: u32,
}

impl WideWalk<'_> {
    /// The box around what is below a node.
    fn node(&mut self, number: u32, depth: u32) -> Corners {
        assert!(depth <= MAX_WIDE_DEPTH, "too deep");
        let node = self.nodes[number as usize];
        let [leaves, inner] = [node.children.z.count_ones(), (node.grid.w >> 24).count_ones()];
        if leaves > 0 {
            assert_eq!(node.children.y, self.next, "a node's triangles come first");
        }
        if inner > 0 {
            assert_eq!(node.children.x, self.met, "inner children are in a row");
        }
        assert!(leaves <= 24 && leaves + inner > 0);
        (self.next, self.met) = (self.next + leaves, self.met + inner);
        let (mut child, mut triangle) = (node.children.x, node.children.y as usize);
        let mut all: Option<Corners> = None;
        for slot in 0..8 {
            let is_inner = node.grid.w >> (24 + slot) & 1 == 1;
            let below = match (is_inner, triangles(&node, slot)) {
                (true, count) => {
                    assert_eq!(count, 0, "an inner node holds no triangles");
                    child += 1;
                    self.node(child - 1, depth + 1)
                }
                (_, 0) => continue,
                (_, count) => {
                    triangle += count as usize;
                    around(&self.bounds[triangle - count as usize..triangle])
                }
            };
            keeps_margin(&node, slot, below);
            all = Some(all.map_or(below, |all| union(all, below)));
        }
        all.expect("a node has a child")
    }
}

/// Planes of eight children.
fn planes(words: [u32; 2]) -> [u8; 8] {
    std::array::from_fn(|i| (words[i / 4].rotate_right(CwbvhNode::TURN) >> (8 * (i % 4))) as u8)
}

/// Triangles of a child.
fn triangles(node: &CwbvhNode, slot: usize) -> u32 {
    let bits = node.children.z >> (3 * slot) & 7;
    assert_eq!(bits, (1 << bits.count_ones()) - 1, "a child's bits");
    bits.count_ones()
}

/// Checks a child's planes against what is below it, in whole multiples of 2^-80.
fn keeps_margin(node: &CwbvhNode, slot: usize, (least, greatest): Corners) {
    let CwbvhNode { low_x_low_y: a, low_z_high_x: b, high_y_high_z: c, grid, .. } = *node;
    let low = [[a.x, a.y], [a.z, a.w], [b.x, b.y]].map(|w| i128::from(planes(w)[slot]));
    let high = [[b.z, b.w], [c.x, c.y], [c.z, c.w]].map(|w| i128::from(planes(w)[slot]));
    for axis in 0..3 {
        let exponent = (grid.w >> (8 * axis) & 0xff) as i32 - 127 - 8;
        assert!((-30..=0).contains(&exponent));
        let origin = f32::from_bits(grid[axis]);
        assert!(origin.abs() <= 1.01);
        let plane = |number: i128| fixed(origin) + (number << (80 + exponent));
        let margin = fixed(CwbvhNode::MARGIN) + (1 << (80 + exponent - 6));
        assert!(plane(low[axis]) <= fixed(least[axis]) - margin);
        assert!(plane(high[axis]) >= fixed(greatest[axis]) + margin);
    }
}

/// A coordinate in multiples of 2^-80, in which all of the tests' are whole.
fn fixed(x: f32) -> i128 {
    let scaled = f64::from(x) * 2f64.powi(80);
    assert_eq!(scaled.fract(), 0.0, "{x}");
    scaled as i128
}
