//! What leaves hold: triangles, spheres, disks and copies of meshes, and the boxes of their parts.

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

/// A primitive in leaf order: a triangle, or by its flags a sphere, a disk or a copy of a mesh. All kinds take as many words, so that one index
/// finds any of them.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Primitive {
    /// A triangle's first vertex, the centre or a copy's least corner, and the primitive's number in the scene (which decides ties) or
    /// that of the [`Instance`](super::Instance).
    pub a: UVec4,
    /// A triangle's second vertex, a disk's unit normal, a copy's greatest corner or zeros, and the material's index.
    pub b: UVec4,
    /// A triangle's third vertex, or the radius (0 of a copy) and zeros; and the flags.
    pub c: UVec4,
}

impl Primitive {
    /// The bits of the flags that tell the kind. A triangle has none of them.
    pub const KIND: u32 = 3;
    /// The kind of a sphere.
    pub const SPHERE: u32 = 1;
    /// The kind of a disk.
    pub const DISK: u32 = 2;
    /// The kind of a copy of a mesh.
    pub const INSTANCE: u32 = 3;
    /// The flag of a primitive that casts no shadow (thesis 3.2: opaque objects do).
    pub const TRANSPARENT: u32 = 4;
    /// The flag of a primitive that is not opaque everywhere.
    pub const CUTOUT: u32 = 8;
    /// The flag of a primitive that is never skipped because it is seen from behind.
    pub const TWO_SIDED: u32 = 16;
    /// The flag of a primitive that the camera does not see.
    pub const UNSEEN: u32 = 32;
    /// The flag of one that casts no shadow though it is opaque.
    pub const SHADOWLESS: u32 = 64;
    /// The flag of one that rays from other surfaces do not meet.
    pub const UNREFLECTED: u32 = 128;
    /// The flag of one that cuts a hole into the picture.
    pub const HOLDOUT: u32 = 256;
    /// The flag of one that shows only what others do to its light.
    pub const CATCHER: u32 = 512;
    /// The flag of one that is not there, but what is inside of it: only paths know of it, see [`Media::OPEN`](super::Media).
    pub const OPEN: u32 = 1024;
    /// The flag of one of hair, which rays do not meet from behind: light leaves a fibre where it came in.
    pub const HAIR: u32 = 2048;
    /// How far the flags are shifted beside the material of an indexed vertex.
    pub const FLAGS_SHIFT: u32 = 20;
    /// The bits of the material there.
    pub const MATERIAL: u32 = (1 << Self::FLAGS_SHIFT) - 1;

    /// A record of three vertices in the normalised scene.
    pub fn triangle(vertices: [Vec3; 3], number: u32, material: u32, flags: u32) -> Self {
        let [a, b, c] = vertices;
        Primitive { a: pack(a, number), b: pack(b, material), c: pack(c, flags) }
    }

    /// A record of a sphere in the normalised scene.
    pub fn sphere(centre: Vec3, radius: f32, number: u32, material: u32, flags: u32) -> Self {
        let radius = pack(Vec3::new(radius, 0.0, 0.0), flags | Self::SPHERE);
        Primitive { a: pack(centre, number), b: pack(Vec3::ZERO, material), c: radius }
    }

    /// A record of a disk in the normalised scene. `normal` is of unit length but for its rounding.
    pub fn disk(centre: Vec3, normal: Vec3, radius: f32, number: u32, material: u32, flags: u32) -> Self {
        let radius = pack(Vec3::new(radius, 0.0, 0.0), flags | Self::DISK);
        Primitive { a: pack(centre, number), b: pack(normal, material), c: radius }
    }

    /// A record of a copy of a mesh that lies between these corners of the normalised scene.
    pub fn instance(least: Vec3, greatest: Vec3, number: u32) -> Self {
        Primitive { a: pack(least, number), b: pack(greatest, 0), c: pack(Vec3::ZERO, Self::INSTANCE) }
    }

    /// A triangle's vertices in the normalised scene.
    #[inline(always)]
    pub fn vertices(&self) -> [Vec3; 3] {
        [numbers(self.a), numbers(self.b), numbers(self.c)]
    }

    /// The centre of a sphere or a disk.
    #[inline(always)]
    pub fn centre(&self) -> Vec3 {
        numbers(self.a)
    }

    /// The radius of a sphere or a disk.
    #[inline(always)]
    pub fn radius(&self) -> f32 {
        f32::from_bits(self.c.x)
    }

    /// The side that a disk faces.
    #[inline(always)]
    pub fn normal(&self) -> Vec3 {
        numbers(self.b)
    }

    /// Is it a sphere?
    #[inline(always)]
    pub fn is_sphere(&self) -> bool {
        self.c.w & Self::KIND == Self::SPHERE
    }

    /// Is it a disk?
    #[inline(always)]
    pub fn is_disk(&self) -> bool {
        self.c.w & Self::KIND == Self::DISK
    }

    /// Is it a copy of a mesh?
    #[inline(always)]
    pub fn is_instance(&self) -> bool {
        self.c.w & Self::KIND == Self::INSTANCE
    }

    /// Is it a triangle?
    #[inline(always)]
    pub fn is_triangle(&self) -> bool {
        self.c.w & Self::KIND == 0
    }

    /// The primitive's number in the scene, whatever the order of the leaves.
    #[inline(always)]
    pub fn number(&self) -> u32 {
        self.a.w
    }

    /// The flags, and the kind.
    #[inline(always)]
    pub fn flags(&self) -> u32 {
        self.c.w
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

    /// May it be skipped where it is seen from behind? The inside of glass is seen from its back side.
    #[inline(always)]
    pub fn is_culled(&self) -> bool {
        self.c.w & (Self::TRANSPARENT | Self::TWO_SIDED) == 0
    }

    /// Is it not opaque everywhere?
    #[inline(always)]
    pub fn is_cutout(&self) -> bool {
        self.c.w & Self::CUTOUT != 0
    }

    /// Has it any of these flags?
    #[inline(always)]
    pub fn has(&self, flags: u32) -> bool {
        self.c.w & flags != 0
    }

    /// The primitive's own box (least, greatest corner): its extent and [`BOX_PADDING`] around it.
    /// A hit must lie in it, so every box above must contain it exactly.
    #[cfg(not(target_arch = "spirv"))]
    pub fn bounds(&self) -> (Vec3, Vec3) {
        match self.c.w & Self::KIND {
            Self::SPHERE => self.sphere_bounds(),
            Self::DISK => self.disk_bounds(),
            Self::INSTANCE => (numbers(self.a), numbers(self.b)),
            _ => self.triangle_bounds(),
        }
    }

    /// As [`Primitive::bounds`], of a triangle.
    #[inline(always)]
    pub fn triangle_bounds(&self) -> (Vec3, Vec3) {
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

    /// As [`Primitive::bounds`], of a sphere.
    #[inline(always)]
    pub fn sphere_bounds(&self) -> (Vec3, Vec3) {
        around(self.centre(), Vec3::splat(self.radius()))
    }

    /// As [`Primitive::bounds`], of a disk: along an axis it reaches as far as its normal's part across that axis.
    #[inline(always)]
    pub fn disk_bounds(&self) -> (Vec3, Vec3) {
        let (n, radius) = (self.normal(), self.radius());
        let (x, y, z) = (n.x * n.x, n.y * n.y, n.z * n.z);
        let reach = |across: f32| radius * Real::sqrt(across);
        around(self.centre(), Vec3::new(reach(y + z), reach(x + z), reach(x + y)))
    }
}

/// The box with padding that reaches so far around a centre.
#[inline(always)]
fn around(centre: Vec3, reach: Vec3) -> (Vec3, Vec3) {
    let [low, high] = [centre - reach, centre + reach];
    (low - Vec3::splat(BOX_PADDING), high + Vec3::splat(BOX_PADDING))
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
