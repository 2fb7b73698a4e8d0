//! A wide node's bytes.

use eyerays_shader::data::WideNode;
use glam::UVec4;

use super::grid::{Grid, Planes};

const ARITY: usize = WideNode::ARITY;
/// A child's byte is this or more, plus its slot, where it is an inner node.
const INNER: u8 = WideNode::INNER as u8 + 24;
/// The most triangles below one node that are in leaves of it.
const MOST: u32 = ARITY as u32 * WideNode::MAX_LEAF;
/// The bias of a single's exponent.
const BIAS: i32 = 127;

/// What sits in a slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Child {
    /// Nothing.
    None,
    /// The next of the node's inner children.
    Inner,
    /// So many triangles, from so many behind the node's first on.
    Leaf { place: u32, count: u32 },
}

/// A node, spelt out.
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
    pub fn encode(&self) -> WideNode {
        let inner = |slot: usize| u32::from(self.children[slot].0 == Child::Inner) << slot;
        let mask: u32 = (0..ARITY).map(inner).sum();
        let [x, y, z] = self.grid.exponent.map(|e| (e + BIAS) as u8);
        let [ox, oy, oz] = self.grid.origin.map(f32::to_bits);
        let [m0, m1] = words(|slot| meta(self.children[slot].0, slot));
        let planes = |side: usize, axis: usize| words(|slot| self.children[slot].1[side][axis]);
        let join = |[a, b]: [u32; 2], [c, d]: [u32; 2]| UVec4::new(a, b, c, d);
        WideNode {
            grid: UVec4::new(ox, oy, oz, u32::from_le_bytes([x, y, z, mask as u8])),
            children: UVec4::new(self.first_child, self.first_triangle, m0, m1),
            low_x_low_y: join(planes(0, 0), planes(0, 1)),
            low_z_high_x: join(planes(0, 2), planes(1, 0)),
            high_y_high_z: join(planes(1, 1), planes(1, 2)),
        }
    }

    /// What a node says; none if a child's byte or the mask is malformed.
    pub fn decode(node: &WideNode) -> Option<Self> {
        let [x, y, z, mask] = node.grid.w.to_le_bytes();
        let WideNode { low_x_low_y: a, low_z_high_x: b, high_y_high_z: c, .. } = *node;
        let planes = [
            [bytes([a.x, a.y]), bytes([a.z, a.w]), bytes([b.x, b.y])],
            [bytes([b.z, b.w]), bytes([c.x, c.y]), bytes([c.z, c.w])],
        ];
        let metas = bytes([node.children.z, node.children.w]);
        let mut children = [(Child::None, [[0; 3]; 2]); ARITY];
        for (slot, (child, its)) in children.iter_mut().enumerate() {
            *child = what(metas[slot], slot)?;
            *its = planes.map(|side| side.map(|axis| axis[slot]));
            if (*child == Child::Inner) != (mask >> slot & 1 == 1) {
                return None;
            }
        }
        let grid = Grid {
            origin: [node.grid.x, node.grid.y, node.grid.z].map(f32::from_bits),
            exponent: [x, y, z].map(|e| i32::from(e) - BIAS),
        };
        let (first_child, first_triangle) = (node.children.x, node.children.y);
        Some(Record { grid, first_child, first_triangle, children })
    }

    /// The box of planes that every slot without a child has.
    pub const NOWHERE: (Child, Planes) = (Child::None, [[u8::MAX; 3], [0; 3]]);
}

/// A child's byte.
fn meta(child: Child, slot: usize) -> u8 {
    match child {
        Child::None => 0,
        Child::Inner => INNER + slot as u8,
        Child::Leaf { place, count } => (((1 << count) - 1) << 5 | place) as u8,
    }
}

/// What a child's byte says; none if it is malformed.
fn what(meta: u8, slot: usize) -> Option<Child> {
    if meta == 0 {
        return Some(Child::None);
    }
    if meta == INNER + slot as u8 {
        return Some(Child::Inner);
    }
    let (bits, place) = (meta >> 5, u32::from(meta & 31));
    let count = u32::from(bits).trailing_ones();
    let is_unary = count > 0 && u32::from(bits) == (1 << count) - 1;
    (is_unary && place + count <= MOST).then_some(Child::Leaf { place, count })
}

/// Eight bytes as two words, the first in the lowest bits.
fn words(byte: impl Fn(usize) -> u8) -> [u32; 2] {
    [0, 4].map(|first| u32::from_le_bytes(std::array::from_fn(|i| byte(first + i))))
}

fn bytes(words: [u32; 2]) -> [u8; ARITY] {
    std::array::from_fn(|i| words[i / 4].to_le_bytes()[i % 4])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_survives_its_bytes() {
        let mut children = [Record::NOWHERE; ARITY];
        children[1] = (Child::Inner, [[1, 2, 3], [4, 5, 6]]);
        children[2] = (Child::Leaf { place: 21, count: 3 }, [[7, 8, 9], [10, 11, 12]]);
        children[7] = (Child::Inner, [[13, 14, 15], [16, 17, 255]]);
        children[6] = (Child::Leaf { place: 0, count: 1 }, [[0; 3], [255; 3]]);
        let grid = Grid { origin: [-1.0, 0.25, 0.5], exponent: [-30, -6, 0] };
        let record = Record { grid, first_child: 77, first_triangle: 99, children };
        let node = record.encode();
        assert_eq!(Record::decode(&node), Some(record));
        assert_eq!(node.grid.w, 0b1000_0010 << 24 | 127 << 16 | 121 << 8 | 97);
        assert_eq!(node.children.z, (0b111 << 5 | 21) << 16 | (32 + 25) << 8);
        assert_eq!(node.children.w, (32 + 31) << 24 | 32 << 16);
        assert_eq!(node.low_x_low_y.x, 255 | 1 << 8 | 7 << 16 | 255 << 24);
        assert_eq!(node.high_y_high_z.w, 255 << 16 | 255 << 24);
    }

    #[test]
    fn bytes_that_say_nothing_are_refused() {
        for meta in [1, 31, 2 << 5, 4 << 5, 5 << 5, 6 << 5, 32 + 24 + 3, 1 << 5 | 24, 7 << 5 | 22] {
            assert_eq!(what(meta, 2), None, "{meta}");
        }
    }
}
