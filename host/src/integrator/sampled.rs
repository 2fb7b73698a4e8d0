//! Integrators that sample: one light at each vertex, and one direction in which to go on.

use super::{Needs, Waves};
use crate::device_scene::DeviceScene;
use crate::scene::Integrator;

/// What a scene asks for.
pub fn sampled(packed: &DeviceScene) -> Needs {
    let settings = packed.settings();
    let waves = match settings.transport.integrator {
        // The last ray finds only what emits.
        Integrator::Path => settings.bounces + u32::from(packed.found_light().is_some()),
        _ => 0,
    };
    Needs { shadow_rays: 1, paths: 1, waves: Waves::AtMost(waves), is_sampled: true }
}
