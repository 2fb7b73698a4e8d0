//! What is between surfaces: participating media.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::{Grid, Material, Temperature, Unplaced};

/// A homogeneous medium (pbrt-v4, chapter 11): what it does to light on a world unit of its way. Colours are linear RGB.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Medium {
    /// How likely light is scattered on a world unit of its way, over that unit; at least 0.
    pub scattering: Vec3,
    /// The same for being absorbed.
    pub absorption: Vec3,
    /// The mean cosine of the angle by which it is scattered (Henyey and Greenstein), in [-0.999, 0.999]: forward above 0, back below.
    pub anisotropy: f32,
    /// Radiance of what is so thick that nothing is seen through it, if it does not scatter; at least 0.
    pub emission: Vec3,
}

impl Medium {
    /// The largest anisotropy either way.
    pub const MOST_ANISOTROPY: f32 = 0.999;

    /// One through which light goes on average so far, in world units, before it is scattered or absorbed, and of which a thick body has
    /// this colour in white light, linear RGB in [0, 1]: by the single scattering albedo that Kulla and Conty fitted (Revisiting Physically
    /// Based Shading at Imageworks, 2017).
    pub fn of_colour(colour: Vec3, distance: Vec3, anisotropy: f32) -> Medium {
        let share = |colour: f32| {
            let colour = f64::from(colour);
            let s = 4.09712 + 4.20863 * colour - (9.59217 + 41.6808 * colour + 17.7126 * colour * colour).sqrt();
            ((1.0 - s * s) / (1.0 - f64::from(anisotropy) * s * s)).clamp(0.0, 1.0)
        };
        let shares = DVec3::new(share(colour.x), share(colour.y), share(colour.z));
        let extinction = DVec3::ONE / distance.as_dvec3();
        Medium {
            scattering: (extinction * shares).as_vec3(),
            absorption: (extinction * (DVec3::ONE - shares)).as_vec3(),
            anisotropy,
            emission: Vec3::ZERO,
        }
    }

    /// Refuses light of what absorbs none: in each channel it is sent where light would be absorbed.
    pub(crate) fn check_emission(&self) -> Unplaced<()> {
        let sends = |channel: usize| self.emission[channel] > 0.0 && self.absorption[channel] == 0.0;
        match (0..3).find(|&channel| sends(channel)) {
            Some(channel) => {
                let colour = ["red", "green", "blue"][channel];
                Err(format!("what sends {colour} light must absorb {colour} light: give it absorption"))
            }
            None => Ok(()),
        }
    }
}

impl Default for Medium {
    /// Nothing that is seen.
    fn default() -> Self {
        Medium { scattering: Vec3::ZERO, absorption: Vec3::ZERO, anisotropy: 0.0, emission: Vec3::ZERO }
    }
}

/// What the closed surfaces of a material are filled with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Volume {
    /// The medium inside.
    pub medium: Medium,
    /// Is the surface itself there? Else nothing of it is seen but its inside, and no light is bent or reflected.
    pub interface: bool,
    /// Where surfaces of several materials overlap, what has the highest is inside, of several what was entered last.
    pub priority: u8,
    /// What the coefficients are multiplied with, where they are not the same everywhere.
    #[serde(skip)]
    pub density: Option<Arc<Grid>>,
    /// What its emission is multiplied with, where it glows by temperature: then its emission is the radiance of the hottest place.
    #[serde(skip)]
    pub temperature: Option<Temperature>,
}

impl Volume {
    /// A medium without a surface.
    pub fn open(medium: Medium) -> Volume {
        Volume { medium, interface: false, priority: 0, density: None, temperature: None }
    }

    /// Is it denser or hotter in some places?
    pub(crate) fn has_grid(&self) -> bool {
        self.density.is_some() || self.temperature.is_some()
    }

    /// Why its temperature does nothing, and what to do.
    fn idle_temperature(&self) -> Option<&'static str> {
        let temperature = self.temperature.as_ref()?;
        if self.medium.emission == Vec3::ZERO {
            return Some("its volume has a temperature and an emission of 0; remove one of them");
        }
        temperature.is_dark().then_some(
            "the temperature of its volume is below 500 kelvins everywhere, where nothing is seen to glow; raise its kelvins, \
             or name another grid",
        )
    }
}

impl Material {
    /// Does light pass its surfaces into something inside?
    pub(crate) fn lets_light_in(&self) -> bool {
        match &self.physical {
            Some(physical) => physical.lets_light_in(),
            None => self.transmission != Vec3::ZERO,
        }
    }

    /// Why nobody sees its volume or its temperature, and what to do.
    pub(crate) fn idle_volume(&self) -> Option<&'static str> {
        let volume = self.volume.as_ref()?;
        if volume.interface && !self.lets_light_in() {
            return Some(
                "its volume is behind an opaque surface; give it transmission or diffuse_transmission, or set interface to false",
            );
        }
        volume.idle_temperature()
    }
}
