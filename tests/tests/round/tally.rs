//! What was found of a case's rays, and the ray and the hit that both kinds judge.

use eyerays_shader::data::Primitive;
use eyerays_shader::ray::Hit;
use eyerays_shader::traverse::Closest;
use eyerays_tests::bare::{Bare, prepared};
use glam::Vec3;

use super::draw::Drawn;

/// What taking small differences to the centre for zero moves a place by.
pub const FLUSHED: f64 = 2.0 / (1u64 << 40) as f64;

/// Counts of rays, and the greatest errors over their bounds.
#[derive(Debug, Default, Clone, Copy)]
pub struct Tally {
    pub rays: usize,
    pub hits: usize,
    /// Hits of what is missed exactly, and misses of what is hit.
    pub wrong: usize,
    /// How far those are from right, of its bound.
    pub wrong_share: f64,
    /// The error of t.
    pub t_share: f64,
    /// The distance of a sphere's hit from its surface.
    pub off_share: f64,
    /// Rays so flat to a disk that the bound is more than the scene.
    pub flat: usize,
}

impl Tally {
    pub fn and(self, other: Tally) -> Tally {
        Tally {
            rays: self.rays + other.rays,
            hits: self.hits + other.hits,
            wrong: self.wrong + other.wrong,
            wrong_share: self.wrong_share.max(other.wrong_share),
            t_share: self.t_share.max(other.t_share),
            off_share: self.off_share.max(other.off_share),
            flat: self.flat + other.flat,
        }
    }
}

/// What the kernels say of a ray and one primitive.
pub struct Answer {
    pub is_hit: bool,
    pub t: f64,
    /// The ray's direction without what counts as zero.
    pub direction: Vec3,
}

impl Answer {
    pub fn of(primitive: Primitive, drawn: &Drawn) -> Self {
        let shot = prepared::<f32>(&drawn.ray);
        let hit = Bare::new(vec![primitive]).hit::<Closest, f32>(&shot, f32::MAX);
        Answer {
            is_hit: hit.primitive_index != Hit::<f32>::NOTHING,
            t: f64::from(hit.t),
            direction: Vec3::new(shot.direction.x, shot.direction.y, shot.direction.z),
        }
    }
}
