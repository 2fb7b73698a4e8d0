//! The records of launches, but for what a view says.

use eyerays_shader::data::{Frame, pack};
use glam::Vec3;

use super::normalisation::flushed;
use super::{DeviceScene, records};
use crate::scene::{Background, Transport};

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

    /// The record of a launch that follows `count` rays of a stream.
    pub fn stream_frame(&self, count: usize) -> Frame {
        Frame { slots: count as u32, vertices: self.primitives.len() as u32, ..Frame::default() }
    }

    /// Every launch's record but for what a view says.
    pub(crate) fn frame(&self) -> Frame {
        let (horizon, zenith) = match self.background {
            Background::Colour(colour) => (colour, colour),
            Background::Gradient { horizon, zenith } => (horizon, zenith),
        };
        let lights = self.lights.len() as u32;
        let Transport { seed, roulette, clamp, ao_distance, .. } = self.settings.transport;
        let [least, greatest] = self.found_light().unwrap_or([Vec3::ONE, Vec3::NEG_ONE]);
        let reach = (f64::from(ao_distance) * self.normalisation.scale).min(f32::MAX.into()) as f32;
        Frame {
            lamps: pack(flushed((least + greatest) * 0.5), 0),
            lamps_half: pack(flushed((greatest - least) * 0.5), 0),
            horizon: records::colour(horizon, 0),
            zenith: records::colour(zenith, 0),
            bounces: self.settings.bounces,
            min_contribution: self.settings.min_contribution,
            lights,
            shadow_rays: if self.is_sampled() { 1 } else { lights },
            seed,
            emitters: self.lighting.emitters.len() as u32,
            roulette,
            clamp,
            reach,
            environment: self.lighting.environment,
            far: self.lighting.far,
            vertices: self.primitives.len() as u32,
            ..Frame::default()
        }
    }
}
