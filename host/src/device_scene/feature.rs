//! What pictures show instead of light.

use eyerays_shader::data::{Effects, Launch};

/// Something of what the camera sees first; nothing of it is zero where a ray leaves the scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Feature {
    /// The share of white light from everywhere that a surface sends on, linear RGB in [0, 1].
    Albedo,
    /// Its shading normal on the viewer's side, in world axes: a unit vector in each sample.
    Normal,
    /// The distance from the camera's plane in the normalised scene, then one more than the number of the primitive as what is left
    /// of it over 2^16 and as how often that fits. Numbers have no mean: of one sample a pixel.
    Place,
    /// Where it is, in the normalised scene. Of one sample a pixel, too.
    Position,
}

impl Feature {
    /// What of a scene's effects matters to it.
    pub(super) fn asked(self, effects: Effects) -> Effects {
        const SHAPE: u32 = Effects::SPHERE
            | Effects::DISK
            | Effects::INSTANCED
            | Effects::CUTOUT
            | Effects::TEXTURED
            | Effects::COLOURED
            | SEEN;
        const SEEN: u32 = Effects::HIDDEN | Effects::HOLDOUT;
        let matters = match self {
            Feature::Albedo => SHAPE | Effects::CHECKER | Effects::PHYSICAL,
            Feature::Normal => SHAPE | Effects::SMOOTH | Effects::TANGENTS,
            Feature::Place | Feature::Position => SHAPE,
        };
        Effects(effects.0 & matters)
    }

    /// Bits of the constant of kernels, see [`Launch`].
    pub(crate) fn bits(self) -> u32 {
        match self {
            Feature::Albedo => Launch::ALBEDO,
            Feature::Normal => Launch::NORMAL,
            Feature::Place => Launch::PLACE,
            Feature::Position => Launch::POSITION,
        }
    }
}
