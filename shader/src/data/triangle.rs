//! Triangles, and the boxes of their parts.

use super::{BOX_PADDING, numbers, pack};
use crate::real::Real;
use bytemuck::{Pod, Zeroable};
use glam::{UVec4, Vec3};

/// What bounds a reference to a part of a triangle: the box of that part, padded by [`BOX_PADDING`].
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Bounds {
    /// Least corner; the integer is 0.
    pub least: UVec4,
    /// Greatest corner; the integer is 0.
    pub greatest: UVec4,
}

/// A triangle in leaf order.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Triangle {
    /// First vertex, and the primitive's number in the scene (which decides ties).
    pub a: UVec4,
    /// Second vertex, and the material's index.
    pub b: UVec4,
    /// Third vertex, and [`Triangle::TRANSPARENT`] or 0.
    pub c: UVec4,
}

impl Triangle {
    /// The flag of a triangle that casts no shadow (thesis 3.2: opaque objects do).
    pub const TRANSPARENT: u32 = 1;
    /// The same flag beside the material of an indexed triangle's vertex.
    pub const CLEAR_VERTEX: u32 = 1 << 31;

    /// A record of three vertices in the normalised scene.
    pub fn new(vertices: [Vec3; 3], primitive: u32, material: u32, flags: u32) -> Self {
        let [a, b, c] = vertices;
        Triangle { a: pack(a, primitive), b: pack(b, material), c: pack(c, flags) }
    }

    /// The vertices in the normalised scene.
    #[inline(always)]
    pub fn vertices(&self) -> [Vec3; 3] {
        [numbers(self.a), numbers(self.b), numbers(self.c)]
    }

    /// The primitive's number in the scene, whatever the order of the leaves.
    #[inline(always)]
    pub fn primitive(&self) -> u32 {
        self.a.w
    }

    /// The index of the material.
    #[inline(always)]
    pub fn material(&self) -> u32 {
        self.b.w
    }

    /// Does light pass?
    #[inline(always)]
    pub fn is_transparent(&self) -> bool {
        self.c.w & Self::TRANSPARENT != 0
    }

    /// The triangle's own box (least, greatest corner): its extent and [`BOX_PADDING`] around it.
    /// A hit must lie in it, so every box above must contain it exactly.
    #[inline(always)]
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let [a, b, c] = self.vertices();
        (
            Vec3::new(
                least(a.x, b.x, c.x) - BOX_PADDING,
                least(a.y, b.y, c.y) - BOX_PADDING,
                least(a.z, b.z, c.z) - BOX_PADDING,
            ),
            Vec3::new(
                greatest(a.x, b.x, c.x) + BOX_PADDING,
                greatest(a.y, b.y, c.y) + BOX_PADDING,
                greatest(a.z, b.z, c.z) + BOX_PADDING,
            ),
        )
    }
}

/// A zero's sign is lost in the padding.
#[inline(always)]
fn least(a: f32, b: f32, c: f32) -> f32 {
    a.lesser(b).lesser(c)
}

#[inline(always)]
fn greatest(a: f32, b: f32, c: f32) -> f32 {
    a.greater(b).greater(c)
}
