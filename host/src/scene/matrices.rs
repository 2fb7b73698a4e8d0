//! A camera as matrices, as programs that put pictures together want it.

use glam::{DMat4, DVec3, DVec4};

use super::{Camera, Projection};
use crate::math;

impl Camera {
    /// From world space to the camera's: x to the right, y up, and it looks along -z. For column vectors.
    pub fn world_to_camera(&self) -> DMat4 {
        let eye = self.eye.as_dvec3();
        let [right, up, forward] = self.axes();
        let row = |axis: DVec3| axis.extend(-axis.dot(eye));
        DMat4::from_cols(row(right), row(up), row(-forward), DVec4::W).transpose()
    }

    /// Turned around its target, about its up, by a share of a whole turn.
    #[must_use]
    pub fn turned(&self, share: f64) -> Camera {
        let (sin, cos) = math::sin_cos(share * std::f64::consts::TAU);
        let (axis, away) = (self.up.as_dvec3().normalize_or_zero(), (self.eye - self.target).as_dvec3());
        // Rodrigues' rotation.
        let turned = away * cos + axis.cross(away) * sin + axis * axis.dot(away) * (1.0 - cos);
        let eye = if share.fract() == 0.0 { self.eye } else { (self.target.as_dvec3() + turned).as_vec3() };
        Camera { eye, ..self.clone() }
    }

    /// From world space to an image of this size: x and y are -1 to 1 from left to right and from bottom to top, z is the distance in
    /// front of the camera's plane, all but that after a division by the last component. For column vectors. None of a camera that goes
    /// all around, which no matrix tells.
    pub fn world_to_ndc(&self, (width, height): (u32, u32)) -> Option<DMat4> {
        let aspect = f64::from(width) / f64::from(height);
        let (half, last) = match self.projection {
            Projection::Perspective { fov } => (math::tan(f64::from(fov).to_radians() / 2.0), DVec4::NEG_Z),
            Projection::Orthographic { height } => (f64::from(height) / 2.0, DVec4::W),
            Projection::Equirectangular | Projection::Fisheye { .. } => return None,
        };
        let [aside, above] = self.shift.map(|share| last * (2.0 * f64::from(share)));
        let rows = [DVec4::X / (half * aspect) - aside, DVec4::Y / half - above, DVec4::NEG_Z, last];
        Some(DMat4::from_cols_array_2d(&rows.map(|row| row.to_array())).transpose() * self.world_to_camera())
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, Vec3};

    use super::*;

    /// Corners of the image, as the camera's own angles tell.
    #[test]
    fn what_is_at_the_edge_of_the_view_is_at_the_edge_of_the_image() {
        let (eye, target, up) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(1.0, 2.0, -7.0), Vec3::Y);
        for projection in [Projection::Perspective { fov: 90.0 }, Projection::Orthographic { height: 10.0 }] {
            let camera = Camera { up, ..Camera::new("", eye, target, projection) };
            // Five in front of the camera half a field of 90 degrees is five high, and twice as wide.
            let corner = DVec3::new(1.0 + 10.0, 2.0 + 5.0, 3.0 - 5.0);
            assert_eq!(camera.world_to_camera().transform_point3(corner), DVec3::new(10.0, 5.0, -5.0));
            let at = camera.world_to_ndc((200, 100)).unwrap() * corner.extend(1.0);
            assert!((DVec2::new(at.x, at.y) / at.w - DVec2::ONE).length() < 1e-12, "{projection:?}: {at}");
            assert_eq!(at.z, 5.0);
            // An image that is moved to the right by a quarter of its width has it left of there by half of half its width.
            let shifted = Camera { shift: [0.25, -0.5], ..camera };
            let at = shifted.world_to_ndc((200, 100)).unwrap() * corner.extend(1.0);
            assert!((DVec2::new(at.x, at.y) / at.w - DVec2::new(0.5, 2.0)).length() < 1e-12, "{projection:?}: {at}");
        }
    }

    #[test]
    fn a_camera_on_its_side_has_its_own_up() {
        let projection = Projection::Perspective { fov: 40.0 };
        let camera = Camera { up: Vec3::Z, ..Camera::new("", Vec3::ZERO, Vec3::X, projection) };
        let seen = camera.world_to_camera().transform_vector3(DVec3::new(2.0, 3.0, 4.0));
        assert_eq!(seen, DVec3::new(-3.0, 4.0, -2.0));
    }
}
