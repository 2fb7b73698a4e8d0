//! What the battery draws at random, from a seed.

use fastrand::Rng;
use glam::{DVec3, Vec3};

/// A sequence of numbers.
#[derive(Debug, Clone)]
pub struct Random(Rng);

impl Random {
    /// The sequence of a seed.
    pub fn new(seed: u64) -> Self {
        Random(Rng::with_seed(seed))
    }

    /// 32 bits.
    pub fn bits(&mut self) -> u32 {
        self.0.u32(..)
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0.f64()
    }

    /// In [`least`, `greatest`).
    pub fn between(&mut self, least: f64, greatest: f64) -> f64 {
        least + (greatest - least) * self.unit()
    }

    /// Below `count`.
    pub fn index(&mut self, count: usize) -> usize {
        self.0.usize(..count)
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
        if self.0.bool() { size } else { -size }
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
