//! What a launch sees of the scene in device memory.

use crate::buffer::read;
#[cfg(not(target_arch = "spirv"))]
use crate::bvh8::Bvh8View;
use crate::data::{
    Bounds, CentredPair, CompactPair, CwbvhNode, Frame, Layout, Maps, Material, Normals, Primitive, Specialisation,
    numbers,
};
use crate::texture::Textures;
use crate::traverse::Cutout;
use glam::{UVec4, Vec3};

/// A launch, and the primitives of its scene.
#[derive(Clone, Copy)]
pub struct LaunchContext<'a> {
    /// What is rendered.
    pub frame: &'a Frame,
    /// What the kernel is compiled for; constants on the GPU.
    pub spec: Specialisation,
    /// Primitives in leaf order: [`Primitive`]s, or their indices and vertices ([`Layout::INDEXED`]).
    pub primitives: &'a [UVec4],
}

impl LaunchContext<'_> {
    /// The primitive at an index: a record of its own, gathered before; or a record of the numbers of its three words but
    /// for their integers, whose integer is its own number, and which carry the material and the flags.
    #[inline(always)]
    pub fn primitive(&self, index: u32) -> Primitive {
        let word = |i| read(self.primitives, i);
        if self.spec.layout.has(Layout::INDEXED) {
            let corners = word(index);
            let vertex = |i: u32| word(self.frame.vertices + i);
            let (mut a, mut b, mut c) = (vertex(corners.x), vertex(corners.y), vertex(corners.z));
            let flags = b.w >> Primitive::FLAGS_SHIFT;
            (a.w, b.w, c.w) = (corners.w, b.w & Primitive::MATERIAL, flags);
            Primitive { a, b, c }
        } else {
            Primitive { a: word(3 * index), b: word(3 * index + 1), c: word(3 * index + 2) }
        }
    }
}

/// A launch and what its rays meet.
#[derive(Clone, Copy)]
pub struct TraceContext<'a> {
    /// The launch and its primitives.
    pub base: LaunchContext<'a>,
    /// Words of child pairs, the root's first: [`CentredPair`]s, or [`CompactPair`]s ([`Layout::COMPACT`]).
    pub nodes: &'a [UVec4],
    /// Nodes of eight children; the root is node 0. Of the method `wide` alone.
    pub wide: &'a [CwbvhNode],
    /// The same for a CPU. Empty unless the method is `wide`.
    #[cfg(not(target_arch = "spirv"))]
    pub bvh8: Bvh8View<'a>,
    /// Bounds in leaf order ([`Layout::SPLIT`]).
    pub bounds: &'a [Bounds],
    /// Where primitives are not opaque.
    pub cutout: Cutout<'a>,
}

impl TraceContext<'_> {
    /// The child pair of this number.
    #[inline(always)]
    pub fn pair(&self, number: u32) -> CentredPair {
        let word = |i| read(self.nodes, i);
        if self.base.spec.layout.has(Layout::COMPACT) {
            CompactPair { left: word(2 * number), right: word(2 * number + 1) }.into()
        } else {
            let [left_centre, left_half] = [word(4 * number), word(4 * number + 1)];
            let [right_centre, right_half] = [word(4 * number + 2), word(4 * number + 3)];
            CentredPair { left_centre, left_half, right_centre, right_half }
        }
    }

    /// The primitive at an index.
    #[inline(always)]
    pub fn primitive(&self, index: u32) -> Primitive {
        self.base.primitive(index)
    }

    /// The box (least, greatest corner) that a ray must meet for a hit to count: that of the part of a triangle that is at
    /// the index, or else the primitive's own.
    #[inline(always)]
    pub fn bounds(&self, index: u32, own: impl FnOnce() -> (Vec3, Vec3)) -> (Vec3, Vec3) {
        if self.base.spec.layout.has(Layout::SPLIT) {
            let bounds = read(self.bounds, index);
            (numbers(bounds.least), numbers(bounds.greatest))
        } else {
            own()
        }
    }
}

/// What surfaces look like.
#[derive(Clone, Copy, Default)]
pub struct ShadingData<'a> {
    /// Vertex normals in leaf order ([`Effects::SMOOTH`](crate::data::Effects)).
    pub normals: &'a [Normals],
    /// Materials.
    pub materials: &'a [Material],
    /// Tangents in leaf order ([`Effects::TANGENTS`](crate::data::Effects)); the first vertex' integer is the bits of the sign of
    /// the bitangent. Three zeros stand for a triangle without.
    pub tangents: &'a [Normals],
    /// Their maps, by material ([`Effects::TEXTURED`](crate::data::Effects)).
    pub maps: &'a [Maps],
    /// What they are covered with.
    pub textures: Textures<'a>,
}
