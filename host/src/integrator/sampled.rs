//! Integrators that sample: one light at each vertex, and one direction in which to go on.

use super::{Needs, Waves, whitted};
use crate::device_scene::DeviceScene;
use crate::scene::Integrator;

/// What a scene asks for.
pub fn sampled(packed: &DeviceScene) -> Needs {
    let settings = packed.settings();
    let once = |waves| Needs { shadow_rays: 1, paths: 1, waves: Waves::AtMost(waves), is_sampled: true };
    match settings.transport.integrator {
        Integrator::Whitted | Integrator::Ao => once(0),
        Integrator::Distributed => {
            let Needs { paths, waves, .. } = whitted::whitted(packed);
            Needs { paths: paths.max(1), waves, ..once(0) }
        }
        // The last ray finds only what emits.
        Integrator::Path => once(settings.bounces + u32::from(packed.found_light().is_some())),
    }
}
