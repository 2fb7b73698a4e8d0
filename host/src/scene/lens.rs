//! The lens of a camera (thesis 3.4.6).

use glam::Vec3;
use serde::{Deserialize, Serialize};

use crate::math;

/// A thin lens: what is not in the plane of focus is spread over an image of its outline.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Lens {
    /// Its radius in world units, at least 0.
    pub radius: f32,
    /// Where it is sharp.
    pub focus: Focus,
    /// Blades of its diaphragm, the corners of its outline: 3 to [`Lens::MOST_BLADES`], or 0 for a circle.
    pub blades: u32,
    /// How far the outline is turned against the clock as the camera sees it, in degrees.
    pub rotation: f32,
    /// From straight edges (0) to a circle (1).
    pub roundness: f32,
    /// How many times it is as high as wide: 2 for the upright ovals of anamorphic lenses.
    pub ratio: f32,
}

/// Where a lens is sharp: on a plane through a place, straight across the view.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Focus {
    /// So far in front of the eye, in world units; may be infinite.
    Distance(f32),
    /// Where the camera looks.
    Target,
    /// Through this point.
    Point(Vec3),
}

impl Lens {
    /// The most blades.
    pub const MOST_BLADES: u32 = 32;
    /// The height of a full-frame sensor in millimetres.
    pub const SENSOR: f32 = 24.0;

    /// Can one have so many blades?
    pub fn can_have(blades: u32) -> bool {
        blades == 0 || (3..=Self::MOST_BLADES).contains(&blades)
    }

    /// A round one that is sharp where the camera looks.
    pub fn round(radius: f32) -> Lens {
        Lens { radius, focus: Focus::Target, blades: 0, rotation: 0.0, roundness: 0.0, ratio: 1.0 }
    }

    /// The radius of a lens by its f-number, in metres: half the focal length over it. The focal length follows from the vertical field of
    /// view in degrees and the height of the sensor in millimetres.
    pub fn radius_of(f_stop: f32, fov: f32, sensor: f32) -> f32 {
        let focal_length = f64::from(sensor) / 2.0 / math::tan(f64::from(fov).to_radians() / 2.0);
        (focal_length / f64::from(f_stop) / 2.0 / 1000.0) as f32
    }

    /// The vertical field of view in degrees of a focal length and a sensor's height, both in millimetres.
    pub fn field_of_view(focal_length: f32, sensor: f32) -> f32 {
        (2.0 * math::atan(f64::from(sensor) / 2.0 / f64::from(focal_length)).to_degrees()) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The field of view of a 50 mm lens on full frame is 26.99 degrees high; f/2 is an opening of 25 mm.
    #[test]
    fn a_photographers_numbers_are_a_radius_and_a_field_of_view() {
        let fov = Lens::field_of_view(50.0, Lens::SENSOR);
        assert!((fov - 26.991_467).abs() < 1e-4, "{fov}");
        assert!((Lens::radius_of(2.0, fov, Lens::SENSOR) - 0.0125).abs() < 1e-7);
        assert!((Lens::radius_of(4.0, 90.0, 36.0) - 0.00225).abs() < 1e-8);
    }
}
