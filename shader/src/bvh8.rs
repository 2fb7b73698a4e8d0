//! The wide hierarchy as a CPU's vectors load it: boxes in full precision, triangles and spheres, as structures of arrays, with
//! nothing to decode or to shuffle. The same primitives have the same indices as in the other hierarchies.

use crate::data::Primitive;
use glam::Vec3;

/// Eight siblings. A box is wider than the primitives' own boxes below it by [`Bvh8Node::MARGIN`] on every side.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub struct Bvh8Node {
    /// For each axis the lower planes of all children, then the upper ones.
    pub planes: [[[f32; 8]; 2]; 3],
    /// The children, the larger first, see `traverse::bvh8`.
    pub children: [Bvh8Ref; 8],
}

impl Bvh8Node {
    /// How much wider than its contents a box is at least, except for one rounding of the plane.
    pub const MARGIN: f32 = 1.0 / (1 << 19) as f32;
    /// A pair of planes that no ray is between: the box of a missing child.
    pub const NOWHERE: [f32; 2] = [4.0, -4.0];
    /// No child.
    pub const EMPTY: Bvh8Node =
        Bvh8Node { planes: [[[Self::NOWHERE[0]; 8], [Self::NOWHERE[1]; 8]]; 3], children: [Bvh8Ref(0); 8] };
}

/// What a leaf holds: up to four triangles or spheres, which are tested side by side, or primitives that are tested one after
/// the other.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum LeafKind {
    /// A [`Triangle4`].
    Triangles,
    /// A [`Sphere4`].
    Spheres,
    /// A [`Mixed4`].
    Mixed,
}

/// A reference to a node, or to a leaf.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(transparent)]
pub struct Bvh8Ref(pub u32);

impl Bvh8Ref {
    const LEAF: u32 = 1 << 31;
    const SPHERES: u32 = 1 << 30;
    const MIXED: u32 = 1 << 29;
    const INDEX: u32 = Self::MIXED - 1;
    /// The node that a traversal starts with.
    pub const ROOT: Bvh8Ref = Bvh8Ref(0);

    /// The node of this number.
    pub fn inner(node: u32) -> Self {
        Bvh8Ref(node)
    }

    /// The leaf of the block of this number among those of its kind.
    pub fn leaf(kind: LeafKind, block: u32) -> Self {
        let bits = match kind {
            LeafKind::Triangles => 0,
            LeafKind::Spheres => Self::SPHERES,
            LeafKind::Mixed => Self::MIXED,
        };
        Bvh8Ref(block | bits | Self::LEAF)
    }

    /// Is this a leaf?
    #[inline(always)]
    pub fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    /// What a leaf holds.
    #[inline(always)]
    pub fn kind(self) -> LeafKind {
        match self.0 & (Self::SPHERES | Self::MIXED) {
            0 => LeafKind::Triangles,
            Self::SPHERES => LeafKind::Spheres,
            _ => LeafKind::Mixed,
        }
    }

    /// The number of the node, or of the leaf's block among those of its kind.
    #[inline(always)]
    pub fn index(self) -> usize {
        (self.0 & Self::INDEX) as usize
    }
}

/// The most primitives of a leaf.
pub const MOST: usize = 4;

/// Up to four triangles, in three lines of a cache: what their test decides by is all here.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Triangle4 {
    /// By vertex and axis a coordinate of each triangle; NaN, which is never hit, where there is none.
    pub vertices: [[[f32; MOST]; 3]; 3],
    /// The index of each triangle.
    pub primitive_indices: [u32; MOST],
    /// The number of each in the scene.
    pub numbers: [u32; MOST],
    /// The flags of each.
    pub flags: [u32; MOST],
}

impl Triangle4 {
    /// No triangle.
    pub const EMPTY: Triangle4 = Triangle4 {
        vertices: [[[f32::NAN; MOST]; 3]; 3],
        primitive_indices: [0; MOST],
        numbers: [0; MOST],
        flags: [0; MOST],
    };

    /// Triangles, each with its index.
    ///
    /// # Panics
    /// If there are more than [`MOST`].
    pub fn of<'t>(triangles: impl Iterator<Item = (u32, &'t Primitive)>) -> Self {
        let mut block = Triangle4::EMPTY;
        for (lane, (index, triangle)) in triangles.enumerate() {
            for (vertex, place) in triangle.vertices().iter().enumerate() {
                for axis in 0..3 {
                    block.vertices[vertex][axis][lane] = place[axis];
                }
            }
            block.primitive_indices[lane] = index;
            (block.numbers[lane], block.flags[lane]) = (triangle.number(), triangle.flags());
        }
        block
    }

    /// A triangle's record, but for its material.
    #[inline(always)]
    pub fn primitive(&self, lane: usize) -> Primitive {
        let lane = lane % MOST;
        let place = |vertex: usize| Vec3::from([0, 1, 2].map(|axis| self.vertices[vertex][axis][lane]));
        Primitive::triangle([place(0), place(1), place(2)], self.numbers[lane], 0, self.flags[lane])
    }
}

/// Up to four spheres.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(16))]
pub struct Sphere4 {
    /// By axis a coordinate of each centre; NaN, which is never hit, where there is none.
    pub centres: [[f32; MOST]; 3],
    /// The radius of each.
    pub radii: [f32; MOST],
    /// The index of each.
    pub primitive_indices: [u32; MOST],
    /// The number of each in the scene.
    pub numbers: [u32; MOST],
}

impl Sphere4 {
    /// No sphere.
    pub const EMPTY: Sphere4 = Sphere4 {
        centres: [[f32::NAN; MOST]; 3],
        radii: [0.0; MOST],
        primitive_indices: [0; MOST],
        numbers: [u32::MAX; MOST],
    };

    /// Spheres, each with its index.
    ///
    /// # Panics
    /// If there are more than [`MOST`].
    pub fn of<'s>(spheres: impl Iterator<Item = (u32, &'s Primitive)>) -> Self {
        let mut block = Sphere4::EMPTY;
        for (lane, (index, sphere)) in spheres.enumerate() {
            for axis in 0..3 {
                block.centres[axis][lane] = sphere.centre()[axis];
            }
            block.radii[lane] = sphere.radius();
            block.primitive_indices[lane] = index;
            block.numbers[lane] = sphere.number();
        }
        block
    }
}

/// Up to four primitives of any kinds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixed4 {
    indices: [u32; MOST],
    count: u32,
}

impl Mixed4 {
    /// Primitives by their indices.
    ///
    /// # Panics
    /// If there are more than [`MOST`].
    pub fn of(primitives: impl Iterator<Item = u32>) -> Self {
        let mut block = Mixed4 { indices: [0; MOST], count: 0 };
        for index in primitives {
            block.indices[block.count as usize] = index;
            block.count += 1;
        }
        block
    }

    /// The index of each.
    #[inline(always)]
    pub fn indices(&self) -> &[u32] {
        &self.indices[..self.count as usize]
    }
}

/// A borrowed hierarchy. Empty unless the traversal method needs it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Bvh8View<'a> {
    /// Nodes, the root first.
    pub nodes: &'a [Bvh8Node],
    /// Leaves of triangles.
    pub triangles: &'a [Triangle4],
    /// Leaves of spheres.
    pub spheres: &'a [Sphere4],
    /// Leaves of other primitives, or of several kinds.
    pub mixed: &'a [Mixed4],
}

impl Bvh8View<'_> {
    /// What it takes of memory.
    pub fn bytes(&self) -> usize {
        size_of_val(self.nodes) + size_of_val(self.triangles) + size_of_val(self.spheres) + size_of_val(self.mixed)
    }
}
