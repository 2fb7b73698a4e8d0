//! Which stages a picture asks of devices: a file an integrator. What they do at a hit is in the file of the same name in
//! the shader.

mod sampled;
mod stages;
mod whitted;

pub use stages::{SAMPLED, Stages, WHITTED};

use crate::job::Job;
use crate::scene::Integrator;

/// What the integrator of a scene's settings asks for.
pub fn needs(packed: &Job) -> Needs {
    if packed.feature().is_some() {
        return sampled::first_hits();
    }
    match packed.settings().transport.integrator {
        Integrator::Whitted => whitted::whitted(packed),
        Integrator::Ao => sampled::first_hits(),
        Integrator::Distributed => sampled::distributed(packed),
        Integrator::Path => sampled::path(packed),
    }
}

/// What an integrator asks for.
#[derive(Clone, Copy, Debug)]
pub struct Needs {
    /// Shadow rays of a hit: one a light, or one in all where a light is chosen at random. Their answers are kept for the
    /// shading of the wave.
    pub shadow_rays: u32,
    /// Paths that a slot keeps: the one in hand and those that are followed later; none without further waves.
    pub paths: u32,
    /// How often rays go on.
    pub waves: Waves,
    /// Its table of stages.
    pub stages: &'static Stages,
}

/// How many waves follow that of the camera's rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Waves {
    /// At most so many: a ray goes on as one ray.
    AtMost(u32),
    /// Until no ray is left: rays branch, or go on through what is no vertex.
    Branching,
}
