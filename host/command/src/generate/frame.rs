//! Where a piece stands and which way it faces.

use glam::DVec3;

use super::circle::turn;

/// Axes at right angles, each as long as the piece's unit, and an origin.
#[derive(Clone, Copy)]
pub struct Frame {
    /// Where the piece's own origin lies.
    pub origin: DVec3,
    x: DVec3,
    y: DVec3,
    z: DVec3,
}

impl Frame {
    /// Upright at a place.
    pub fn at(x: f64, y: f64, z: f64) -> Self {
        Frame { origin: DVec3::new(x, y, z), x: DVec3::X, y: DVec3::Y, z: DVec3::Z }
    }

    /// Turned counter-clockwise about its own upright axis, seen from above.
    pub fn turned(self, turns: f64) -> Self {
        let (cosine, sine) = turn(turns);
        let (x, z) = (self.x, self.z);
        Frame { x: x * cosine - z * sine, z: x * sine + z * cosine, ..self }
    }

    /// Leaning about its own x axis: upright tips towards z.
    pub fn leaning(self, turns: f64) -> Self {
        let (cosine, sine) = turn(turns);
        let (y, z) = (self.y, self.z);
        Frame { y: y * cosine + z * sine, z: z * cosine - y * sine, ..self }
    }

    /// Larger or smaller.
    pub fn scaled(self, scale: f64) -> Self {
        Frame { x: self.x * scale, y: self.y * scale, z: self.z * scale, ..self }
    }

    /// Moved along its own axes.
    pub fn moved(self, x: f64, y: f64, z: f64) -> Self {
        Frame { origin: self.point(DVec3::new(x, y, z)), ..self }
    }

    /// A point of the piece in world units.
    pub fn point(&self, own: DVec3) -> DVec3 {
        self.origin + self.vector(own)
    }

    /// A direction of the piece.
    pub fn vector(&self, own: DVec3) -> DVec3 {
        self.x * own.x + self.y * own.y + self.z * own.z
    }
}
