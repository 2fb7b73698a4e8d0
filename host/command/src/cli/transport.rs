//! How light is carried.

use clap::Args;

use super::choice::choice;
use crate::error::{Result, within};
use crate::preset::Preset;
use eyerays::scene::{self, Direct, Integrator, Settings};

/// How light is carried.
#[derive(Args, Clone, Copy, Default)]
#[command(next_help_heading = "Light")]
pub(super) struct Transport {
    /// How light comes from lights to the camera [default: the scene's]
    #[arg(long, value_parser = choice::<Integrator>())]
    integrator: Option<Integrator>,
    /// Other seeds give other noise [default: the scene's]
    #[arg(long, value_name = "N")]
    seed: Option<u32>,
    /// Path: bounces before chance may end a path early, which costs noise and saves time [default: the scene's]
    #[arg(long, value_name = "N")]
    roulette: Option<u32>,
    /// Path: the most that light adds to a sample which was scattered more than once, 0 for no limit; takes bright dots away,
    /// and some light with them [default: the scene's]
    #[arg(long, value_name = "RADIANCE")]
    clamp: Option<f32>,
    /// Path: how lights with extent are found [default: the scene's]
    #[arg(long, value_parser = choice::<Direct>())]
    direct: Option<Direct>,
    /// Ao: how far surfaces look, in the scene's units [default: the scene's]
    #[arg(long, value_name = "LENGTH")]
    ao_distance: Option<f32>,
}

impl Transport {
    /// With a settings file below the command line.
    pub fn over_file(self, file: &Preset) -> Transport {
        Transport {
            integrator: self.integrator.or(file.integrator),
            roulette: self.roulette.or(file.roulette),
            clamp: self.clamp.or(file.clamp),
            ..self
        }
    }

    /// The integrator that is asked for.
    pub fn integrator(&self) -> Option<Integrator> {
        self.integrator
    }

    /// With a scene's settings below.
    pub fn over(&self, own: &scene::Transport) -> Result<scene::Transport> {
        within("--roulette", self.roulette.as_slice(), 0..=Settings::MOST_BOUNCES)?;
        within("--clamp", self.clamp.as_slice(), 0.0..=f32::MAX)?;
        within("--ao-distance", self.ao_distance.as_slice(), f32::MIN_POSITIVE..=f32::INFINITY)?;
        Ok(scene::Transport {
            integrator: self.integrator.unwrap_or(own.integrator),
            seed: self.seed.unwrap_or(own.seed),
            roulette: self.roulette.unwrap_or(own.roulette),
            clamp: self.clamp.unwrap_or(own.clamp),
            direct: self.direct.unwrap_or(own.direct),
            ao_distance: self.ao_distance.unwrap_or(own.ao_distance),
        })
    }
}
