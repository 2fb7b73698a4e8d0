//! Numbers from a seed (splitmix64; Steele, Lea and Flood 2014), the same on every machine.

use glam::{DVec3, Vec3};

/// A sequence of numbers.
#[derive(Debug, Clone)]
pub struct Random(pub u64);

impl Random {
    /// 32 bits.
    pub fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 32) as u32
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f64 {
        f64::from(self.bits()) / 4_294_967_296.0
    }

    /// In [`least`, `greatest`).
    pub fn between(&mut self, least: f64, greatest: f64) -> f64 {
        least + (greatest - least) * self.unit()
    }

    /// Below `count`.
    pub fn index(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    /// In a cube of edge 2 around zero.
    pub fn cube(&mut self) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|_| self.between(-1.0, 1.0)))
    }

    /// Of unit length, every way as likely.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let v = self.cube();
            if (1e-4..=1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }

    /// Of either sign, its magnitude 10 to a power between these.
    pub fn magnitude(&mut self, least: f64, greatest: f64) -> f32 {
        let size = 10f64.powf(self.between(least, greatest)) as f32;
        if self.bits() & 1 == 0 { size } else { -size }
    }

    /// Three of [`Random::magnitude`].
    pub fn magnitudes(&mut self, least: f64, greatest: f64) -> Vec3 {
        Vec3::from_array(std::array::from_fn(|_| self.magnitude(least, greatest)))
    }

    /// Weights of a triangle's vertices, uniform over it.
    pub fn weights(&mut self) -> [f64; 3] {
        let (u, v) = (self.unit(), self.unit());
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        [1.0 - u - v, u, v]
    }
}
