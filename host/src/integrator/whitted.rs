//! Whitted's model (thesis 3.3): a shadow ray to every light, and a tree of reflected and refracted rays.

use eyerays_shader::data::Effects;

use super::{Needs, WHITTED, Waves};
use crate::job::Job;

/// What a scene asks for.
pub fn whitted(packed: &Job) -> Needs {
    let waves = if !packed.has_secondary_rays() {
        Waves::AtMost(0)
    } else if packed.effects().has(Effects::REFRACTION | Effects::THIN) {
        Waves::Branching
    } else {
        Waves::AtMost(packed.settings().bounces)
    };
    Needs { shadow_rays: packed.lights().len() as u32, paths: paths(packed, waves), waves, stages: &WHITTED }
}

/// A refracted ray waits at most once a bounce. Waiting rays and the one in hand share their pixel's light, a unit a colour
/// channel, and each has at least the least contribution of it.
fn paths(packed: &Job, waves: Waves) -> u32 {
    match waves {
        Waves::AtMost(0) => 0,
        Waves::AtMost(_) => 1,
        Waves::Branching => {
            let least = f64::from(packed.settings().min_contribution);
            let waiting = if least > 0.0 { (3.0 / least).ceil() + 1.0 } else { f64::from(u32::MAX) };
            1 + packed.settings().bounces.min(waiting as u32)
        }
    }
}
