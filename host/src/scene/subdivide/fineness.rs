//! How often faces are divided.

use std::ops::RangeInclusive;

use glam::{DMat4, DVec3};

use super::Cage;
use crate::scene::{Camera, Projection};

/// How often each face of a cage is divided.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fineness {
    /// So often.
    Levels(u32),
    /// Until no edge is longer than so many pixels to any camera, at most `most` times.
    Pixels {
        /// In pixels of the image, above 0.
        length: f32,
        /// In [`Fineness::LEVELS`].
        most: u32,
    },
}

impl Fineness {
    /// How often a face may be divided.
    pub const LEVELS: RangeInclusive<u32> = 1..=8;

    /// The levels of a cage that stands in some places of the world, as some eyes see it.
    pub fn levels(self, cage: &Cage, places: &[DMat4], eyes: &[Eye]) -> u32 {
        let (length, most) = match self {
            Fineness::Levels(levels) => return levels,
            Fineness::Pixels { length, most } => (length, most),
        };
        let longest = places.iter().map(|place| cage.longest(place, eyes)).fold(0.0, f64::max);
        // Each level halves the edges.
        (1..most).find(|&level| longest <= f64::from(length) * f64::from(1 << level)).unwrap_or(most)
    }
}

/// A camera as edges are measured by it: whatever is as near as they are, and as wide, wherever it looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Eye {
    place: DVec3,
    /// What a pixel is of the distance.
    angle: f64,
    /// What it is at any distance.
    width: f64,
}

impl Eye {
    /// That of a camera, for an image of this size in pixels.
    pub fn of(camera: &Camera, (width, height): (u32, u32)) -> Eye {
        let (rows, least) = (f64::from(height), f64::from(width.min(height)));
        let (angle, width) = match camera.projection {
            Projection::Perspective { fov } => (2.0 * crate::math::tan(f64::from(fov).to_radians() / 2.0) / rows, 0.0),
            Projection::Orthographic { height } => (0.0, f64::from(height) / rows),
            Projection::Equirectangular => (std::f64::consts::PI / rows, 0.0),
            Projection::Fisheye { fov, .. } => (f64::from(fov).to_radians() / least, 0.0),
        };
        Eye { place: camera.eye.as_dvec3(), angle, width }
    }

    /// How many pixels an edge is long, seen at right angles.
    fn pixels(&self, [a, b]: [DVec3; 2]) -> f64 {
        let (way, from) = (b - a, self.place - a);
        let square = way.length_squared();
        let share = if square > 0.0 { (from.dot(way) / square).clamp(0.0, 1.0) } else { 0.0 };
        way.length() / (self.width + self.angle * (from - way * share).length())
    }
}

impl Cage {
    /// Its longest edge in pixels of the eye that sees it longest.
    fn longest(&self, place: &DMat4, eyes: &[Eye]) -> f64 {
        let positions: Vec<DVec3> = self.positions.iter().map(|&at| place.transform_point3(at)).collect();
        let edges = self.faces().flat_map(|face| {
            let next = face.iter().cycle().skip(1);
            face.iter().zip(next).map(|(a, b)| [a, b].map(|corner| positions[corner.vertex as usize]))
        });
        let all = edges.flat_map(|edge| eyes.iter().map(move |eye| eye.pixels(edge)));
        // At an eye edges are as long as can be.
        all.fold(0.0, |longest, own| if own > longest || own.is_nan() { own } else { longest })
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::scene::Mesh;

    /// A square of edges of 2 around the origin, across the z axis.
    fn square() -> Cage {
        let positions = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Vec3::new(x, y, 0.0));
        let mesh = Mesh {
            positions: positions.to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            materials: vec![0; 2],
            ..Mesh::default()
        };
        Cage::of(&mesh, &[2])
    }

    fn levels(length: f32, projection: Projection, distance: f32, scale: f64) -> u32 {
        let camera = Camera::new("c", Vec3::Z * distance, Vec3::ZERO, projection);
        let eye = Eye::of(&camera, (300, 100));
        Fineness::Pixels { length, most: 8 }.levels(&square(), &[DMat4::from_scale(DVec3::splat(scale))], &[eye])
    }

    /// A pixel of an image of 100 rows and 90 degrees is a fiftieth of the distance wide; the middles of the edges are at 10 from an eye
    /// at the root of 99, so that edges are 10 pixels long.
    #[test]
    fn edges_are_divided_until_they_are_as_short_as_asked() {
        let (at, wide) = (99f32.sqrt(), Projection::Perspective { fov: 90.0 });
        for (length, want) in [(20.0, 1), (5.001, 1), (4.999, 2), (2.501, 2), (2.499, 3), (0.1, 7), (1e-6, 8)] {
            assert_eq!(levels(length, wide, at, 1.0), want, "{length}");
        }
        // Twice as large and twice as far is as long.
        assert_eq!(levels(4.999, wide, 2.0 * at, 2.0), 2);
        assert_eq!(levels(4.999, wide, 2.0 * at, 1.0), 1);
        // However far it is: two units of twenty in 100 rows.
        let flat = Projection::Orthographic { height: 20.0 };
        assert_eq!((levels(5.001, flat, 1e3, 1.0), levels(4.999, flat, 1e3, 1.0)), (1, 2));
    }

    #[test]
    fn what_an_eye_touches_is_divided_as_often_as_it_may_be() {
        let (camera, projection) = (Vec3::new(1.0, 0.5, 0.0), Projection::Perspective { fov: 50.0 });
        let eye = Eye::of(&Camera::new("c", camera, Vec3::ZERO, projection), (100, 100));
        for most in [1, 3, 8] {
            let fineness = Fineness::Pixels { length: 1e6, most };
            assert_eq!(fineness.levels(&square(), &[DMat4::IDENTITY], &[eye]), most);
        }
        assert_eq!(Fineness::Levels(5).levels(&square(), &[], &[]), 5);
    }
}
