//! `--noise`: a picture ends when what is seen of it has so little noise.

use clap::Args;

use super::exposure::Exposure;
use super::look::Look;
use super::options::Effort;
use crate::error::{Error, Result};
use eyerays::choice::Named;
use eyerays::noise::Target;
use eyerays::scene::{Integrator, Scene};
use eyerays::view::{Region, View};

/// Samples of a cell at most, unless a number is asked for.
const MOST: u32 = 4096;

/// How much noise a picture may have.
#[derive(Args, Clone, Copy)]
pub(super) struct NoiseArgs {
    /// Stop where the noise is low enough: in each cell of 16x16 pixels a standard error of X of what is seen, for example 0.02, which
    /// depends on --exposure and --tone, not on --white-balance; with at least 64 and at most --spp samples [default of it: 4096].
    /// For integrators that sample
    #[arg(long, value_name = "X", conflicts_with_all = ["repeat", "samples", "samples_from", "samples_to"])]
    noise: Option<f64>,
}

impl NoiseArgs {
    /// Was it asked for?
    pub fn is_asked(self) -> bool {
        self.noise.is_some()
    }

    /// What was asked for, as the picture is looked at.
    pub fn target(self, look: &Look) -> Result<Option<Target>> {
        let Some(noise) = self.noise else { return Ok(None) };
        if !(Target::LEAST_NOISE..=1.0).contains(&noise) {
            let least = Target::LEAST_NOISE;
            return Err(Error::new(format!(
                "--noise {noise} is not from {least} to 1: 0.02 is a standard error of 2 %"
            )));
        }
        match look.exposure() {
            Exposure::Stops(stops) => Ok(Some(Target::new(noise, stops, look.tone())?)),
            Exposure::Auto => Err(Error::new(
                "--exposure auto is known when the picture is done, and --noise needs it before: give stops",
            )),
        }
    }

    /// With as many samples as cells may need, unless a number is asked for.
    pub fn effort(self, effort: Effort, scene: &Scene) -> Result<Effort> {
        if !self.is_asked() {
            return Ok(effort);
        }
        let integrator = effort.integrator().unwrap_or(scene.settings.transport.integrator);
        if integrator == Integrator::Whitted {
            return Err(eyerays::error::Error::NoNoise { integrator: Named::name(integrator) }.into());
        }
        effort.without_grid(scene, "--noise", MOST)
    }

    /// Refuses a view that cells can't decide about.
    pub fn check(self, view: &View) -> Result<()> {
        if !self.is_asked() {
            return Ok(());
        }
        let least = Target::LEAST_SAMPLES;
        if view.samples() < least {
            let asked = view.samples();
            return Err(Error::new(format!("--spp {asked}: --noise decides after {least} samples; ask for more")));
        }
        let (own, cut) = (view.region(), Target::around(view.region(), view.size()));
        if own != cut {
            let text = |Region { x, y, width, height }: Region| format!("--tile {x},{y},{width},{height}");
            let (own, cut) = (text(own), text(cut));
            return Err(Error::new(format!(
                "{own} cuts cells of 16x16 pixels, about which --noise decides: use {cut}"
            )));
        }
        Ok(())
    }
}
