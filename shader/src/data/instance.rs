//! Where the copies of a mesh stand.

use bytemuck::{Pod, Zeroable};
use glam::{UVec4, Vec3};

use super::{numbers, pack};
use crate::geometry::Transform;
use crate::real::{Real, TINY};

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
    /// triangles have ([`Primitive`](super::Primitive)), with [`Instance::MIRRORS`] and [`Instance::MOVES`]; and the bits of
    /// [`Instance::margin`]. Of a key but the first, see [`Instance::MOVES`], the first integer is how far behind the triangles of the
    /// first key its own are in leaf order, 0 if they are the same.
    pub mesh: UVec4,
}

impl Instance {
    /// Numbers of primitives count up to here, and begin at zero again. Only the primitive that a ray leaves and ties are told by
    /// them, so that more primitives than this need no more bits.
    pub const NUMBERS: u32 = (1 << 31) - 2;

    /// The bit of its flags that says that its transform mirrors.
    pub const MIRRORS: u32 = 1 << 31;

    /// The bit that says that it moves: its record is the key at the opening of the shutter, and those of the ends of the
    /// [steps](super::Frame::steps) follow it.
    pub const MOVES: u32 = 1 << 30;

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
        self.mesh.z & !(Self::MIRRORS | Self::MOVES)
    }

    /// Does it move?
    #[inline(always)]
    pub fn moves(&self) -> bool {
        self.mesh.z & Self::MOVES != 0
    }

    /// It at a share of the way to another key: each number of its transform goes straight.
    #[inline(always)]
    pub fn towards(&self, end: &Instance, share: f32) -> Instance {
        let row = |a: UVec4, b: UVec4| {
            let added = between(f32::from_bits(a.w), f32::from_bits(b.w), share);
            pack(line(numbers(a), numbers(b), share), added.to_bits())
        };
        Instance { x: row(self.x, end.x), y: row(self.y, end.y), z: row(self.z, end.z), mesh: self.mesh }
    }

    /// The number in the scene of a triangle with this number in its mesh.
    #[inline(always)]
    pub fn number(&self, in_mesh: u32) -> u32 {
        let number = self.mesh.y + in_mesh;
        if number < Self::NUMBERS { number } else { number - Self::NUMBERS }
    }
}

/// The number at a share of the way from one to another. A difference of numbers of at least 2^-60 is none that is subnormal, nor is
/// its product with a share, which is zero or at least 2^-40.
#[inline(always)]
fn between(from: f32, to: f32, share: f32) -> f32 {
    (from + (to - from) * share).flush(TINY)
}

/// The place at a share of the straight way from one to another.
#[inline(always)]
pub fn line(from: Vec3, to: Vec3, share: f32) -> Vec3 {
    Vec3::new(between(from.x, to.x, share), between(from.y, to.y, share), between(from.z, to.z, share))
}
