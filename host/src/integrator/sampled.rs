//! Integrators that sample: one light at each vertex, and one direction in which to go on.

use eyerays_shader::data::Media;

use super::{Needs, SAMPLED, Waves, whitted};
use crate::job::Job;

/// Of the camera's rays alone.
pub fn first_hits() -> Needs {
    once(0)
}

/// The waves of Whitted's tree.
pub fn distributed(packed: &Job) -> Needs {
    let Needs { paths, waves, .. } = whitted::whitted(packed);
    Needs { paths: paths.max(1), waves, ..once(0) }
}

/// The last ray finds only what emits. Through surfaces that are not there a path may go as often as it likes.
pub fn path(packed: &Job) -> Needs {
    let waves = packed.settings().bounces + u32::from(packed.found_light().is_some());
    // What goes straight on is no bounce.
    let is_open = packed.media_bits().has(Media::OPEN);
    Needs { waves: if is_open { Waves::Branching } else { Waves::AtMost(waves) }, ..once(waves) }
}

/// One path a slot, and one shadow ray at each of its vertices.
fn once(waves: u32) -> Needs {
    Needs { shadow_rays: 1, paths: 1, waves: Waves::AtMost(waves), stages: &SAMPLED }
}
