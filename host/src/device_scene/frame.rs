//! What launches are told of a scene.

use eyerays_shader::data::{Frame, pack};
use glam::{UVec4, Vec3};

use super::{DeviceScene, copies, records};
use crate::scene::Background;

/// A corner beyond every scene.
const EVERYWHERE: Vec3 = Vec3::splat((1u64 << 40) as f32);

impl DeviceScene {
    /// The least and the greatest corner of all light that rays may find, which are far away where the background is light.
    pub(crate) fn found_light(&self) -> Option<[Vec3; 2]> {
        let is_black = match self.background {
            Background::Colour(colour) => colour == Vec3::ZERO,
            Background::Gradient { horizon, zenith } => horizon == Vec3::ZERO && zenith == Vec3::ZERO,
        };
        let is_black = is_black && self.environment.is_empty();
        if is_black { self.lamps.bounds } else { Some([-EVERYWHERE, EVERYWHERE]) }
    }

    /// What [`Frame::origin`] is.
    pub(crate) fn origin(&self) -> UVec4 {
        pack(copies::origin(&self.normalisation), 0)
    }

    /// The record of a launch that follows `count` rays of a stream.
    pub fn stream_frame(&self, count: usize) -> Frame {
        Frame {
            slots: count as u32,
            vertices: self.primitives.len() as u32,
            origin: self.origin(),
            pairs: self.pairs(),
            ..Frame::default()
        }
    }

    /// Light of the background at the horizon and below, and straight up: linear RGB.
    pub(crate) fn background(&self) -> [UVec4; 2] {
        let (horizon, zenith) = match self.background {
            Background::Colour(colour) => (colour, colour),
            Background::Gradient { horizon, zenith } => (horizon, zenith),
        };
        [horizon, zenith].map(|light| records::colour(light, 0))
    }
}
