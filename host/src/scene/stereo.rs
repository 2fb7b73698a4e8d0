//! Cameras with two eyes.

use eyerays_shader::data;
use serde::{Deserialize, Serialize};

use super::Projection;

crate::choice::choices! {
    /// How the images of two eyes lie in one.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum StereoLayout {
        /// The left eye's is the left half
        #[default]
        SideBySide = "side-by-side",
        /// The left eye's is the upper half
        TopBottom = "top-bottom",
    }
}

/// Two eyes, whose images share that of a camera.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Stereo {
    /// Where they lie.
    pub layout: StereoLayout,
    /// How far the eyes are apart, in world units, above 0.
    pub distance: f32,
    /// How far away both look at one place, which then seems to lie in the screen; without it they look in parallel. Of a perspective
    /// camera alone.
    pub convergence: Option<f32>,
}

impl Stereo {
    /// How far human eyes are apart in the mean, in metres.
    pub const HUMAN: f32 = 0.063;

    /// What of it a camera of a projection can't have, by its key, and why.
    pub fn misfit(&self, projection: Projection) -> Option<(&'static str, &'static str)> {
        if projection.is_orthographic() {
            return Some(("stereo", "along parallel rays two eyes see the same"));
        }
        let turns = self.convergence.is_some() && !projection.is_flat();
        turns.then_some(("convergence", "where an image goes all around eyes look in parallel"))
    }

    /// The size of an eye's image.
    pub fn halved(&self, (width, height): (u32, u32)) -> (u32, u32) {
        match self.layout {
            StereoLayout::SideBySide => (width / 2, height),
            StereoLayout::TopBottom => (width, height / 2),
        }
    }

    /// What a camera's record says of it.
    pub(crate) fn kind(&self) -> u32 {
        match self.layout {
            StereoLayout::SideBySide => data::Stereo::BESIDE,
            StereoLayout::TopBottom => data::Stereo::BELOW,
        }
    }
}
