//! Where in an image a place of the world is seen.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::{Camera, Mapping, Projection};
use crate::math;

impl Camera {
    /// Where a place is seen in an image of this size, in pixels from its left and its top edge; it may be outside. None of what no ray of
    /// the camera leads to: behind it, or at its eye. Its lens and its second eye count for nothing.
    pub fn seen_at(&self, place: DVec3, size: (u32, u32)) -> Option<DVec2> {
        self.seen_along(place - self.eye.as_dvec3(), size)
    }

    /// The same of what is so far away from the eye.
    pub(crate) fn seen_along(&self, away: DVec3, (width, height): (u32, u32)) -> Option<DVec2> {
        let [right, up, forward] = self.axes();
        let (aside, above, along) = (away.dot(right), away.dot(up), away.dot(forward));
        let (width, height) = (f64::from(width), f64::from(height));
        let middle = DVec2::new(width, height) / 2.0;
        let from_middle = match self.projection {
            Projection::Perspective { fov } => {
                if along <= 0.0 {
                    return None;
                }
                DVec2::new(aside, -above) / along / half_height(fov) * middle.y
            }
            Projection::Orthographic { height } => DVec2::new(aside, -above) / f64::from(height) * (2.0 * middle.y),
            _ if away == DVec3::ZERO => return None,
            Projection::Equirectangular => {
                let turns = |y: f64, x: f64| math::atan2(y, x) / TAU;
                DVec2::new(turns(aside, along), -turns(above, DVec2::new(aside, along).length())) * width
            }
            Projection::Fisheye { fov, mapping } => {
                let outwards = DVec2::new(aside, -above);
                let angle = math::atan2(outwards.length(), along);
                let fov = f64::from(fov).to_radians();
                let share = match mapping {
                    Mapping::Equidistant => angle / fov,
                    Mapping::Equisolid => math::sin(angle / 2.0) / (2.0 * math::sin(fov / 4.0)),
                };
                outwards.normalize_or_zero() * (share * width.min(height))
            }
        };
        let shift = DVec2::new(-f64::from(self.shift[0]) * width, f64::from(self.shift[1]) * height);
        Some(middle + from_middle + shift)
    }

    /// The way from the eye through a place of an image of this size, of any length; none of parallel rays.
    pub(crate) fn way_through(&self, at: DVec2, (width, height): (u32, u32)) -> Option<DVec3> {
        let [right, up, forward] = self.axes();
        let (width, height) = (f64::from(width), f64::from(height));
        let shift = DVec2::new(f64::from(self.shift[0]) * width, -f64::from(self.shift[1]) * height);
        let from_middle = at + shift - DVec2::new(width, height) / 2.0;
        let [along, aside, above] = match self.projection {
            Projection::Orthographic { .. } => return None,
            Projection::Perspective { fov } => {
                let DVec2 { x, y } = from_middle / (height / 2.0) * half_height(fov);
                [1.0, x, -y]
            }
            Projection::Equirectangular => {
                let DVec2 { x, y } = from_middle / width * TAU;
                let ((sin, cos), (above, level)) = (math::sin_cos(x), math::sin_cos(-y));
                [level * cos, level * sin, above]
            }
            Projection::Fisheye { fov, mapping } => {
                let (share, fov) = (from_middle / width.min(height), f64::from(fov).to_radians());
                let angle = match mapping {
                    Mapping::Equidistant => share.length() * fov,
                    Mapping::Equisolid => 2.0 * math::asin((share.length() * 2.0 * math::sin(fov / 4.0)).min(1.0)),
                };
                let (outwards, (sin, cos)) = (share.normalize_or_zero(), math::sin_cos(angle));
                [cos, outwards.x * sin, -outwards.y * sin]
            }
        };
        Some(forward * along + right * aside + up * above)
    }

    /// To its right, up and forward, of unit length.
    pub(crate) fn axes(&self) -> [DVec3; 3] {
        let forward = self.forward();
        let right = forward.cross(self.up.as_dvec3()).normalize_or_zero();
        [right, right.cross(forward), forward]
    }
}

/// Half the height of what is seen at distance 1.
fn half_height(fov: f32) -> f64 {
    math::tan(f64::from(fov).to_radians() / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    const SIZE: (u32, u32) = (60, 30);

    fn cameras() -> impl Iterator<Item = Camera> {
        let (eye, target) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(4.0, 1.0, -2.0));
        let fisheye = |mapping| Projection::Fisheye { fov: 220.0, mapping };
        let projections = [
            Projection::Perspective { fov: 70.0 },
            Projection::Equirectangular,
            fisheye(Mapping::Equidistant),
            fisheye(Mapping::Equisolid),
        ];
        projections.into_iter().map(move |projection| Camera::new("", eye, target, projection))
    }

    #[test]
    fn what_lies_along_the_way_through_a_place_is_seen_there() {
        for camera in cameras() {
            let shifts: &[[f32; 2]] = if camera.projection.is_flat() { &[[0.0; 2], [0.25, -0.5]] } else { &[[0.0; 2]] };
            for &shift in shifts {
                let camera = Camera { shift, ..camera.clone() };
                for at in [[30.0, 15.0], [25.5, 4.5], [40.0, 20.0], [31.0, 2.0]].map(DVec2::from) {
                    let way = camera.way_through(at, SIZE).unwrap();
                    let seen = camera.seen_at(camera.eye.as_dvec3() + way * 7.0, SIZE).unwrap();
                    assert!((seen - at).length() < 1e-9, "{:?}: {at} is seen at {seen}", camera.projection);
                }
            }
        }
    }

    #[test]
    fn nothing_is_seen_behind_a_plane_or_at_the_eye() {
        for camera in cameras() {
            assert_eq!(camera.seen_at(camera.eye.as_dvec3(), SIZE), None);
            let behind = camera.eye.as_dvec3() - camera.forward();
            assert_eq!(camera.seen_at(behind, SIZE).is_none(), camera.projection.is_flat());
        }
    }
}
