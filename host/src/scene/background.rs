//! What is behind everything.

use glam::Vec3;
use serde::{Deserialize, Serialize};

/// What a ray that hits nothing returns, linear RGB.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Background {
    /// The same every way.
    Colour(Vec3),
    /// From the horizon (and below it) to straight up.
    Gradient {
        /// At the horizon and below.
        horizon: Vec3,
        /// Straight up.
        zenith: Vec3,
    },
}
