//! Whether two runs gave the same answers, bit for bit.

use eyerays_shader::data::Primitive;
use glam::UVec4;

use eyerays::stream::{Answers, StreamRay};

/// FNV-1a over words of 32 bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hash(pub u64);

impl Default for Hash {
    fn default() -> Self {
        Hash(0xcbf2_9ce4_8422_2325)
    }
}

impl Hash {
    /// Takes one more word in.
    pub fn add(&mut self, word: u32) {
        self.0 = (self.0 ^ u64::from(word)).wrapping_mul(0x0000_0100_0000_01b3);
    }

    /// The answers of a stream: bits of (t, u, v) and the primitive's number (a slot depends on how the
    /// hierarchy was built), or what is known of its end.
    pub fn of(primitives: &[Primitive], answers: &Answers) -> Hash {
        let mut hash = Hash::default();
        match answers {
            Answers::Closest(hits) => {
                hits.iter().flat_map(|&hit| comparable(primitives, hit).to_array()).for_each(|word| hash.add(word));
            }
            Answers::Occlusion(shadows) => shadows.iter().for_each(|&word| hash.add(word)),
        }
        hash
    }
}

impl std::fmt::Display for Hash {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(out, "{:016x}", self.0)
    }
}

/// A hit with its primitive instead of its slot.
fn comparable(primitives: &[Primitive], hit: UVec4) -> UVec4 {
    hit.truncate().extend(primitive(primitives, hit.w))
}

/// A slot's primitive. A slot that there is not can only come from a fault, and differs from every other.
pub(crate) fn primitive(primitives: &[Primitive], slot: u32) -> u32 {
    match primitives.get(slot as usize) {
        Some(primitive) => primitive.number(),
        None if slot == StreamRay::NOWHERE => slot,
        None => slot | 1 << 31,
    }
}

/// The first ray with another answer, or with none.
pub fn first_difference(primitives: &[Primitive], a: &Answers, b: &Answers) -> Option<usize> {
    let shorter = |a: usize, b: usize| (a != b).then(|| a.min(b));
    match (a, b) {
        (Answers::Closest(a), Answers::Closest(b)) => {
            let differs = |(&a, &b): (&UVec4, &UVec4)| comparable(primitives, a) != comparable(primitives, b);
            a.iter().zip(b).position(differs).or_else(|| shorter(a.len(), b.len()))
        }
        (Answers::Occlusion(a), Answers::Occlusion(b)) => {
            a.iter().zip(b).position(|(a, b)| a != b).or_else(|| shorter(a.len(), b.len()))
        }
        _ => Some(0),
    }
}

/// The share of rays that met another primitive, or were told another answer.
pub fn differing(primitives: &[Primitive], a: &Answers, b: &Answers) -> f64 {
    let share = |differing: usize, all: usize| differing as f64 / all.max(1) as f64;
    match (a, b) {
        (Answers::Closest(a), Answers::Closest(b)) => {
            let differs = |(a, b): &(&UVec4, &UVec4)| primitive(primitives, a.w) != primitive(primitives, b.w);
            share(a.iter().zip(b).filter(differs).count(), a.len())
        }
        (Answers::Occlusion(a), Answers::Occlusion(b)) => {
            share(a.iter().zip(b).filter(|(a, b)| a != b).count(), a.len())
        }
        _ => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::tests::cornell;

    fn hit(t: f32, slot: u32) -> UVec4 {
        UVec4::new(t.to_bits(), 0, 0, slot)
    }

    #[test]
    fn a_bit_or_a_primitive_makes_a_difference_and_a_slot_none() {
        let mut triangles = cornell((8, 8)).0.primitives().to_vec();
        triangles[1] = triangles[0];
        let triangles = &triangles[..];
        let of = |hits: &[UVec4]| Answers::Closest(hits.to_vec());
        let first = of(&[hit(1.0, 0), hit(2.0, StreamRay::NOWHERE), hit(3.0, 2)]);
        let same = of(&[hit(1.0, 1), hit(2.0, StreamRay::NOWHERE), hit(3.0, 2)]);
        let nearer = of(&[hit(1.0, 0), hit(2.0, StreamRay::NOWHERE), hit(3.0f32.next_down(), 2)]);
        let other = of(&[hit(1.0, 0), hit(2.0, 3), hit(3.0, u32::MAX - 1)]);
        assert_eq!(Hash::of(triangles, &first), Hash::of(triangles, &same));
        for (answers, ray, share) in [(&same, None, 0.0), (&nearer, Some(2), 0.0), (&other, Some(1), 2.0 / 3.0)] {
            assert_eq!(first_difference(triangles, &first, answers), ray);
            assert_eq!(differing(triangles, &first, answers), share);
            assert_eq!(Hash::of(triangles, &first) == Hash::of(triangles, answers), ray.is_none());
        }
        let shadows = [vec![0, 1, 1, 0], vec![0, 1, 0, 0]].map(Answers::Occlusion);
        assert_eq!(first_difference(triangles, &shadows[0], &shadows[1]), Some(2));
        assert_eq!(differing(triangles, &shadows[0], &shadows[1]), 0.25);
        assert_ne!(Hash::of(triangles, &shadows[0]), Hash::of(triangles, &shadows[1]));
        assert_eq!(first_difference(triangles, &shadows[0], &first), Some(0));
    }
}
