//! How light is carried: by which integrator, and what those that sample need to know.

use eyerays_shader::data::Launch;
use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::{Material, Scene};
use crate::choice::choices;

choices! {
    /// How light is carried from lights to the camera.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum Integrator {
        /// Hard shadows, mirrors and glass (thesis 3.3); lights do not fade with distance
        #[default]
        Whitted = "whitted",
        /// How much of a white sky surfaces see (thesis 3.4.2): needs samples
        Ao = "ao",
        /// Whitted's mirrors and glass, and soft shadows of lights with extent (thesis 3.4.1): needs samples
        Distributed = "distributed",
        /// All light that there is, from lights with and without extent (thesis 3.4.4): needs samples
        Path = "path",
    }
}

choices! {
    /// How a path finds lights with extent. All ways have the same mean.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum Direct {
        /// By samples of lights and of surfaces, weighted by the squares of their probabilities
        #[default]
        Power = "power",
        /// By both, weighted by their probabilities
        Balance = "balance",
        /// By samples of lights alone
        Light = "light",
        /// By samples of surfaces alone, as chance finds them
        Surface = "surface",
    }
}

/// What an integrator needs to know.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Transport {
    /// How light is carried.
    pub integrator: Integrator,
    /// What pixels draw their numbers from, beside their place: other seeds give other noise.
    pub seed: u32,
    /// Bounces before Russian roulette may end a path.
    pub roulette: u32,
    /// The most that light adds to a sample which was scattered more than once, 0 for no limit. It darkens the picture.
    pub clamp: f32,
    /// How a path finds lights with extent.
    pub direct: Direct,
    /// How far ambient occlusion looks, in the scene's units; infinite for all the way.
    pub ao_distance: f32,
}

impl Integrator {
    /// What of a scene it leaves out, in a line.
    pub fn ignored(self, scene: &Scene) -> Option<String> {
        match self {
            Integrator::Path => path_ignores(scene),
            Integrator::Whitted if scene.environment.is_some() && scene.lights.is_empty() => Some(
                "the environment lights nothing under the integrator whitted: choose path (--integrator path) or add a light"
                    .to_owned(),
            ),
            _ => None,
        }
    }

    /// Does it choose one light of all at each vertex?
    pub fn chooses_lights(self) -> bool {
        matches!(self, Integrator::Distributed | Integrator::Path)
    }

    /// Does it need samples, and have noise?
    pub fn samples(self) -> bool {
        self != Integrator::Whitted
    }
}

fn path_ignores(scene: &Scene) -> Option<String> {
    let any = |of: &dyn Fn(&Material) -> bool| scene.materials.iter().any(of);
    let has_ambient = scene.ambient != Vec3::ZERO && any(&|m| m.ambient() != Vec3::ZERO);
    let has_highlights = !scene.lights.is_empty() && any(&|m| m.physical.is_none() && m.specular != Vec3::ZERO);
    let what = match (has_ambient, has_highlights) {
        (true, true) => "ambient light and Phong's highlights are",
        (true, false) => "ambient light is",
        (false, true) => "Phong's highlights are",
        (false, false) => return None,
    };
    Some(format!("{what} not drawn: the integrator path finds all light by itself"))
}

impl Direct {
    /// Bits of the constant of kernels, see [`Launch`].
    pub fn bits(self) -> u32 {
        match self {
            Direct::Power => 0,
            Direct::Balance => Launch::BALANCED,
            Direct::Light => Launch::BY_LIGHT,
            Direct::Surface => Launch::BY_SURFACE,
        }
    }
}

impl Default for Transport {
    fn default() -> Self {
        Transport {
            integrator: Integrator::default(),
            seed: 0,
            roulette: 3,
            clamp: 0.0,
            direct: Direct::default(),
            ao_distance: f32::INFINITY,
        }
    }
}
