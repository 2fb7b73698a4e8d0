//! Numbers that look random and are the same everywhere: Steele, Lea and Flood's SplitMix64, and smooth noise.

use glam::DVec3;

/// A stream of numbers from a seed.
#[derive(Clone)]
pub struct Random(u64);

impl Random {
    /// The stream of a seed.
    pub fn new(seed: u64) -> Self {
        Random(mix(seed ^ 0x5851_f42d_4c95_7f2d))
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        mix(self.0)
    }

    /// From 0 to below 1.
    pub fn unit(&mut self) -> f64 {
        fraction(self.bits())
    }

    /// From `least` to below `most`.
    pub fn within(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.unit()
    }

    /// A direction, every one as likely.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let point = DVec3::new(self.within(-1.0, 1.0), self.within(-1.0, 1.0), self.within(-1.0, 1.0));
            if (0.01..=1.0).contains(&point.length_squared()) {
                return point.normalize();
            }
        }
    }
}

fn mix(mut bits: u64) -> u64 {
    bits = (bits ^ bits >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ bits >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ bits >> 31
}

fn fraction(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1u64 << 53) as f64
}

/// Smooth noise of -1 to 1 that changes over about one unit.
pub fn noise(seed: u64, point: DVec3) -> f64 {
    let cell = point.floor();
    let part = point - cell;
    let part = part * part * (DVec3::splat(3.0) - 2.0 * part);
    let value = |x: u64, y: u64, z: u64| {
        let add = |base: f64, step: u64| (base as i64 as u64).wrapping_add(step);
        let column = mix(add(cell.x, x).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ seed);
        let line = mix(column ^ add(cell.y, y).wrapping_mul(0xc2b2_ae3d_27d4_eb4f));
        fraction(mix(line ^ add(cell.z, z).wrapping_mul(0x1656_67b1_9e37_79f9)))
    };
    let blend = |a: f64, b: f64, share: f64| a + (b - a) * share;
    let line = |y, z| blend(value(0, y, z), value(1, y, z), part.x);
    let plane = |z| blend(line(0, z), line(1, z), part.y);
    2.0 * blend(plane(0), plane(1), part.z) - 1.0
}

/// Noise with finer and weaker noise upon it.
pub fn rough(seed: u64, point: DVec3) -> f64 {
    let octave = |n: u64| noise(seed.wrapping_add(n), point * (1 << n) as f64) / (1 << n) as f64;
    (octave(0) + octave(1) + octave(2)) / 1.75
}
