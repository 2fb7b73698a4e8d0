//! How a camera maps a scene to an image.

use eyerays_shader::data::{self, Launch};
use serde::{Deserialize, Serialize};

/// What a camera's image holds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Projection {
    /// What is seen from the eye through a pinhole or a lens.
    Perspective {
        /// Vertical field of view in degrees, in (0, 180).
        fov: f32,
    },
    /// What is seen along parallel rays from a plane through the eye.
    Orthographic {
        /// The image's height in world units, above 0.
        height: f32,
    },
    /// All around, by longitude and latitude: the middle is where the camera looks, the image is twice as wide as high.
    Equirectangular,
    /// What a fisheye sees, in a circle as wide as the image's shorter side; around it the image is black.
    Fisheye {
        /// The angle of the whole circle in degrees, in (0, 360].
        fov: f32,
        /// What the distance from the middle is.
        mapping: Mapping,
    },
}

crate::choice::choices! {
    /// What the distance from the middle of a fisheye's image is.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum Mapping {
        /// The angle from the view
        #[default]
        Equidistant = "equidistant",
        /// The sine of half that angle: equal areas are equal solid angles
        Equisolid = "equisolid",
    }
}

impl Projection {
    /// Its vertical field of view in degrees, if it has one.
    pub fn fov(self) -> Option<f32> {
        match self {
            Projection::Perspective { fov } => Some(fov),
            _ => None,
        }
    }

    /// Are its rays parallel?
    pub fn is_orthographic(self) -> bool {
        matches!(self, Projection::Orthographic { .. })
    }

    /// Does it map to a plane? Then it may be shifted, and have a lens.
    pub fn is_flat(self) -> bool {
        matches!(self, Projection::Perspective { .. } | Projection::Orthographic { .. })
    }

    /// What a camera's record says of it.
    pub(crate) fn kind(self) -> u32 {
        match self {
            Projection::Perspective { .. } => data::Projection::PERSPECTIVE,
            Projection::Orthographic { .. } => data::Projection::PARALLEL,
            Projection::Equirectangular => data::Projection::EQUIRECTANGULAR,
            Projection::Fisheye { mapping: Mapping::Equidistant, .. } => data::Projection::EQUIDISTANT,
            Projection::Fisheye { mapping: Mapping::Equisolid, .. } => data::Projection::EQUISOLID,
        }
    }

    /// Bits of the constant of kernels for it, see [`Launch`].
    pub(crate) fn bits(self) -> u32 {
        match self {
            Projection::Perspective { .. } => 0,
            Projection::Orthographic { .. } => Launch::PARALLEL,
            Projection::Equirectangular | Projection::Fisheye { .. } => Launch::ROUND,
        }
    }
}
