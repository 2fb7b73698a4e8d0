//! Where the copies of a mesh stand.

use bytemuck::{Pod, Zeroable};
use glam::{UVec4, Vec3};

use super::numbers;
use crate::geometry::Transform;

/// A copy of a mesh. The mesh lies in a cube [-1, 1] of its own, from which its vertices and its boxes are moved to the normalised
/// scene when a ray comes to them.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Instance {
    /// What a place is multiplied with for its place on the first axis, and the bits of what is added.
    pub x: UVec4,
    /// On the second axis.
    pub y: UVec4,
    /// On the third.
    pub z: UVec4,
    /// The pair of nodes that the hierarchy of its mesh starts with; the number of its first triangle in the scene; flags that all its
    /// triangles have ([`Primitive`](super::Primitive)), with [`Instance::MIRRORS`]; and the bits of [`Instance::margin`].
    pub mesh: UVec4,
}

impl Instance {
    /// Numbers of primitives count up to here, and begin at zero again. Only the primitive that a ray leaves and ties are told by
    /// them, so that more primitives than this need no more bits.
    pub const NUMBERS: u32 = (1 << 31) - 2;

    /// The bit of its flags that says that its transform mirrors.
    pub const MIRRORS: u32 = 1 << 31;

    /// Nothing of any mesh.
    pub const NONE: Instance = Instance { x: UVec4::ZERO, y: UVec4::ZERO, z: UVec4::ZERO, mesh: UVec4::ZERO };

    /// Where vertices go.
    #[inline(always)]
    pub fn transform(&self) -> Transform {
        let added = |row: UVec4| f32::from_bits(row.w);
        Transform {
            x: numbers(self.x),
            y: numbers(self.y),
            z: numbers(self.z),
            translation: Vec3::new(added(self.x), added(self.y), added(self.z)),
            side: if self.mesh.z & Self::MIRRORS == 0 { 1.0 } else { -1.0 },
        }
    }

    /// How far boxes of the mesh are widened on every axis when they were moved to the scene: what the boxes of other nodes are wider
    /// than their contents, and more than what moving rounds.
    #[inline(always)]
    pub fn margin(&self) -> f32 {
        f32::from_bits(self.mesh.w)
    }

    /// The pair that its hierarchy starts with.
    #[inline(always)]
    pub fn root(&self) -> u32 {
        self.mesh.x
    }

    /// Flags that all its triangles have.
    #[inline(always)]
    pub fn flags(&self) -> u32 {
        self.mesh.z & !Self::MIRRORS
    }

    /// The number in the scene of a triangle with this number in its mesh.
    #[inline(always)]
    pub fn number(&self, in_mesh: u32) -> u32 {
        let number = self.mesh.y + in_mesh;
        if number < Self::NUMBERS { number } else { number - Self::NUMBERS }
    }
}
