//! A prism, and the way of light through it by Snell's law.

use eyerays::scene::{Material, Scene};
use glam::{DVec3, Vec3};

use crate::model::add;

/// A long prism around the third axis, whose edge is up.
pub struct Prism {
    /// The angle at its edge, in radians.
    pub apex: f64,
    /// The index of refraction by which light goes through it symmetrically.
    pub symmetric: f64,
}

impl Prism {
    /// Adds it to a scene.
    pub fn add(&self, scene: &mut Scene, material: Material) {
        let (half, height) = ((self.apex / 2.0).sin() as f32, (self.apex / 2.0).cos() as f32);
        let at = |x: f32, y: f32, z: f32| Vec3::new(x, y + 0.5 * height, z);
        let end = |z: f32| [at(0.0, 0.0, z), at(-half, -height, z), at(half, -height, z)];
        let corners = [end(-1.0), end(1.0)].concat();
        let faces = [[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]];
        add(scene, material, &corners, &faces);
    }

    /// The direction of the light that comes to it.
    pub fn incident(&self) -> DVec3 {
        let angle = (self.symmetric * (self.apex / 2.0).sin()).asin() - self.apex / 2.0;
        DVec3::new(angle.cos(), angle.sin(), 0.0)
    }

    /// The direction of that light behind it where its index is this one.
    pub fn through(&self, index: f64) -> DVec3 {
        let refract = |d: DVec3, n: DVec3, eta: f64| {
            let cosine = -d.dot(n);
            eta * d + (eta * cosine - (1.0 - eta * eta * (1.0 - cosine * cosine)).sqrt()) * n
        };
        let face = |side: f64| DVec3::new(side * (self.apex / 2.0).cos(), (self.apex / 2.0).sin(), 0.0);
        let inside = refract(self.incident(), face(-1.0), 1.0 / index);
        refract(inside, -face(1.0), index)
    }
}
