//! A camera as kernels know it.

use super::{Launch, pack};
use bytemuck::{Pod, Zeroable};
use glam::{UVec4, Vec3};

/// A camera for an image of some size: vectors in the normalised scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Camera {
    /// Where it is. The integer is its [`Projection`].
    pub eye: UVec4,
    /// Step to the right for half a cell's width on the image plane, at distance one or where the camera is. Where rays go all around, a
    /// unit vector.
    pub right: UVec4,
    /// Step up for half a cell's height, or a unit vector.
    pub up: UVec4,
    /// The unit vector to the centre of the image plane. The integer is how two eyes share the image, see [`Stereo`].
    pub forward: UVec4,
    /// The lens' radius to the right. The integer has the bits of one over the distance of the plane of focus; 0 for far away.
    pub across: UVec4,
    /// Its radius upwards. The integer is the number of corners of its outline and, above the lowest eight bits, that of the first of them.
    pub above: UVec4,
}

/// How a camera maps directions to its image.
pub struct Projection;

impl Projection {
    /// Through a pinhole, or a lens, to a plane.
    pub const PERSPECTIVE: u32 = 0;
    /// Along parallel rays.
    pub const PARALLEL: u32 = 1;
    /// All around, by longitude and latitude.
    pub const EQUIRECTANGULAR: u32 = 2;
    /// By the angle from the middle.
    pub const EQUIDISTANT: u32 = 3;
    /// By the sine of half that angle: equal areas are equal solid angles.
    pub const EQUISOLID: u32 = 4;
}

/// How the images of two eyes lie in one.
pub struct Stereo;

impl Stereo {
    /// There is one eye.
    pub const NONE: u32 = 0;
    /// The left eye's is the left half.
    pub const BESIDE: u32 = 1;
    /// The left eye's is the upper half.
    pub const BELOW: u32 = 2;
}

impl Camera {
    /// A pinhole camera, from vectors in the normalised scene.
    pub fn new(eye: Vec3, right: Vec3, up: Vec3, forward: Vec3) -> Self {
        let record = |v| pack(v, 0);
        Camera { eye: record(eye), right: record(right), up: record(up), forward: record(forward), ..Camera::default() }
    }

    /// By another [`Projection`].
    #[must_use]
    pub fn projected(mut self, projection: u32) -> Self {
        self.eye.w = projection;
        self
    }

    /// With a lens of these radii, an outline by its first corner and how many there are, and one over the distance at which it is sharp.
    #[must_use]
    pub fn through(self, across: Vec3, above: Vec3, (first, corners): (u32, u32), over_focus: f32) -> Self {
        Camera { across: pack(across, over_focus.to_bits()), above: pack(above, first << 8 | corners), ..self }
    }

    /// Of two eyes ([`Stereo`]).
    #[must_use]
    pub fn seen_by(mut self, stereo: u32) -> Self {
        self.forward.w = stereo;
        self
    }

    /// Are rays parallel?
    #[inline(always)]
    pub fn is_parallel(&self, launch: Launch) -> bool {
        launch.has(Launch::PARALLEL) && self.eye.w == Projection::PARALLEL
    }

    /// Do rays go all around?
    #[inline(always)]
    pub fn is_round(&self, launch: Launch) -> bool {
        launch.has(Launch::ROUND) && self.eye.w >= Projection::EQUIRECTANGULAR
    }
}
