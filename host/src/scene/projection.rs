//! How a camera maps a scene to an image.

use serde::{Deserialize, Serialize};

/// What a camera's image holds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Projection {
    /// What is seen from the eye through a pinhole.
    Perspective {
        /// Vertical field of view in degrees, in (0, 180).
        fov: f32,
    },
    /// What is seen along parallel rays from a plane through the eye.
    Orthographic {
        /// The image's height in world units, above 0.
        height: f32,
    },
}

impl Projection {
    /// Its vertical field of view in degrees, if it has one.
    pub fn fov(self) -> Option<f32> {
        match self {
            Projection::Perspective { fov } => Some(fov),
            Projection::Orthographic { .. } => None,
        }
    }

    /// Are its rays parallel?
    pub fn is_orthographic(self) -> bool {
        matches!(self, Projection::Orthographic { .. })
    }
}
