//! A wide node's bytes.

use eyerays_shader::data::CwbvhNode;
use glam::UVec4;

use super::grid::{Grid, Planes};

const ARITY: usize = CwbvhNode::ARITY;
/// The bias of a single's exponent.
const BIAS: i32 = 127;
/// The exponent of 256 steps over that of one.
const EXTENT: i32 = 8;
/// Bits of a child's triangles.
const LEAF: u32 = (1 << CwbvhNode::MAX_LEAF) - 1;

/// The child in a slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Child {
    /// Nothing.
    None,
    /// The next of the node's inner children.
    Inner,
    /// The next so many of the node's triangles.
    Leaf { count: u32 },
}

/// A node, decoded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Record {
    pub grid: Grid,
    /// Number of the first inner child.
    pub first_child: u32,
    /// Slot of the first triangle.
    pub first_triangle: u32,
    /// Each child and its planes.
    pub children: [(Child, Planes); ARITY],
}

impl Record {
    /// The node's 80 bytes.
    pub fn encode(&self) -> CwbvhNode {
        let inner = |slot: usize| u32::from(self.children[slot].0 == Child::Inner) << slot;
        let triangles = |slot: usize| leaf(self.children[slot].0) << (CwbvhNode::MAX_LEAF as usize * slot);
        let mask: u32 = (0..ARITY).map(inner).sum();
        let [x, y, z] = self.grid.exponent.map(|e| (e + EXTENT + BIAS) as u8);
        let [ox, oy, oz] = self.grid.origin.map(f32::to_bits);
        let planes = |side: usize, axis: usize| words(|slot| self.children[slot].1[side][axis]);
        let join = |[a, b]: [u32; 2], [c, d]: [u32; 2]| UVec4::new(a, b, c, d);
        CwbvhNode {
            grid: UVec4::new(ox, oy, oz, u32::from_le_bytes([x, y, z, mask as u8])),
            children: UVec4::new(self.first_child, self.first_triangle, (0..ARITY).map(triangles).sum(), 0),
            low_x_low_y: join(planes(0, 0), planes(0, 1)),
            low_z_high_x: join(planes(0, 2), planes(1, 0)),
            high_y_high_z: join(planes(1, 1), planes(1, 2)),
        }
    }

    /// The node's record; `None` if a child is both inner node and leaf, or if a leaf's bits have a gap.
    pub fn decode(node: &CwbvhNode) -> Option<Self> {
        let [x, y, z, mask] = node.grid.w.to_le_bytes();
        let CwbvhNode { low_x_low_y: a, low_z_high_x: b, high_y_high_z: c, .. } = *node;
        let planes = [
            [bytes([a.x, a.y]), bytes([a.z, a.w]), bytes([b.x, b.y])],
            [bytes([b.z, b.w]), bytes([c.x, c.y]), bytes([c.z, c.w])],
        ];
        if node.children.z >> (CwbvhNode::MAX_LEAF as usize * ARITY) != 0 {
            return None;
        }
        let mut children = [(Child::None, [[0; 3]; 2]); ARITY];
        for (slot, (child, its)) in children.iter_mut().enumerate() {
            let triangles = node.children.z >> (CwbvhNode::MAX_LEAF as usize * slot) & LEAF;
            *child = what(mask >> slot & 1 == 1, triangles)?;
            *its = planes.map(|side| side.map(|axis| axis[slot]));
        }
        let grid = Grid {
            origin: [node.grid.x, node.grid.y, node.grid.z].map(f32::from_bits),
            exponent: [x, y, z].map(|e| i32::from(e) - EXTENT - BIAS),
        };
        let (first_child, first_triangle) = (node.children.x, node.children.y);
        Some(Record { grid, first_child, first_triangle, children })
    }

    /// The box of planes that every slot without a child has.
    pub const NOWHERE: (Child, Planes) = (Child::None, [[u8::MAX; 3], [0; 3]]);
}

/// The bits of a leaf's triangles.
fn leaf(child: Child) -> u32 {
    match child {
        Child::None | Child::Inner => 0,
        Child::Leaf { count } => (1 << count) - 1,
    }
}

/// A child by its bits; `None` if they contradict each other.
fn what(is_inner: bool, triangles: u32) -> Option<Child> {
    match (is_inner, triangles.trailing_ones()) {
        (true, 0) if triangles == 0 => Some(Child::Inner),
        (false, 0) if triangles == 0 => Some(Child::None),
        (false, count) if triangles == (1 << count) - 1 => Some(Child::Leaf { count }),
        _ => None,
    }
}

/// Eight bytes as two words of planes.
fn words(byte: impl Fn(usize) -> u8) -> [u32; 2] {
    [0, 4].map(|first| u32::from_le_bytes(std::array::from_fn(|i| byte(first + i))).rotate_left(CwbvhNode::TURN))
}

fn bytes(words: [u32; 2]) -> [u8; ARITY] {
    std::array::from_fn(|i| words[i / 4].rotate_right(CwbvhNode::TURN).to_le_bytes()[i % 4])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_survives_its_bytes() {
        let mut children = [Record::NOWHERE; ARITY];
        children[1] = (Child::Inner, [[1, 2, 3], [4, 5, 6]]);
        children[2] = (Child::Leaf { count: 3 }, [[7, 8, 9], [10, 11, 12]]);
        children[7] = (Child::Inner, [[13, 14, 15], [16, 17, 255]]);
        children[6] = (Child::Leaf { count: 1 }, [[0; 3], [255; 3]]);
        let grid = Grid { origin: [-1.0, 0.25, 0.5], exponent: [-30, -6, 0] };
        let record = Record { grid, first_child: 77, first_triangle: 99, children };
        let node = record.encode();
        assert_eq!(Record::decode(&node), Some(record));
        assert_eq!(node.grid.w, 0b1000_0010 << 24 | 135 << 16 | 129 << 8 | 105);
        assert_eq!(node.children.z, 0b001 << 18 | 0b111 << 6);
        assert_eq!(node.low_x_low_y.x, (255u32 | 1 << 8 | 7 << 16 | 255 << 24).rotate_left(7));
        assert_eq!(node.high_y_high_z.w, (255u32 << 16 | 255 << 24).rotate_left(7));
    }

    #[test]
    fn bits_that_contradict_each_other_are_refused() {
        for (is_inner, triangles) in [(true, 1), (true, 7), (false, 2), (false, 4), (false, 5), (false, 6)] {
            assert_eq!(what(is_inner, triangles), None, "{is_inner} {triangles}");
        }
    }
}
