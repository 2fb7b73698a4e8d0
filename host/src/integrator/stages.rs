//! Tables of stages: what each kind of integrator runs, and what its records take. A plan is made of one of them.

use eyerays_shader::data::{Launch, Media};
use eyerays_shader::stage::{RECORDS, shadow_records, state_records};

use crate::method::Coherence;
use crate::plan::Stage;

/// The stages of an integrator's launches.
#[derive(Debug)]
pub struct Stages {
    /// Do its launches always begin with rays of the camera in memory? Else they do only where such rays are kept ([`Launch::KEPT`]).
    pub generates: bool,
    /// Those of a wave, in their order; shadow rays only where there are any.
    pub wave: &'static [Stage],
    /// What ends a launch: it adds to the film.
    pub last: Stage,
    /// How the rays of further waves lie beside each other.
    pub further: Coherence,
    /// Bits of all stages where further waves follow.
    pub goes_on: u32,
    /// Bits of the stages that follow rays.
    pub rays: u32,
    /// Records that a path takes.
    pub path_records: fn(Media) -> u32,
    /// Records that a slot's shadow rays take.
    pub shadow_records: fn(Media) -> u32,
    /// Does it sample, so that its film tells the noise?
    pub tells_noise: bool,
}

/// Whitted's tree: shadow rays are made of a hit where they are followed.
pub static WHITTED: Stages = Stages {
    generates: false,
    wave: &[Stage::Trace, Stage::Shadow, Stage::Shade],
    last: Stage::Gather,
    further: Coherence::Secondary,
    goes_on: 0,
    rays: 0,
    path_records: |_| RECORDS,
    shadow_records: |_| 0,
    tells_noise: false,
};

/// Sampled light: a vertex is scattered before its shadow ray is followed, whose light the next stage of its slot adds. Rays lie in memory
/// as those of a stream, and what surfaces scatter has no order that a grid of threads could keep.
pub static SAMPLED: Stages = Stages {
    generates: true,
    wave: &[Stage::Trace, Stage::Scatter, Stage::Shadow, Stage::Transmit],
    last: Stage::Accumulate,
    further: Coherence::Scattered,
    goes_on: Launch::GOES_ON,
    rays: Launch::STREAM,
    path_records: state_records,
    shadow_records,
    tells_noise: true,
};
