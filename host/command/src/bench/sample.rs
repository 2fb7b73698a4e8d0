//! Directions at random that are the same on every machine: integers, and `+ - * /` and roots of numbers.

use eyerays_shader::real::V3;

/// Three numbers scrambled into three, each depending on all: `pcg3d` of Jarzynski and Olano 2020, Hash
/// Functions for GPU Rendering.
fn scrambled(v: [u32; 3]) -> [u32; 3] {
    let mut v = v.map(|x| x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    for round in 0..2 {
        v[0] = v[0].wrapping_add(v[1].wrapping_mul(v[2]));
        v[1] = v[1].wrapping_add(v[2].wrapping_mul(v[0]));
        v[2] = v[2].wrapping_add(v[0].wrapping_mul(v[1]));
        if round == 0 {
            v = v.map(|x| x ^ (x >> 16));
        }
    }
    v
}

/// A number in [-1, 1) on a grid of 2^-23.
fn signed(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / (1 << 23) as f32) - 1.0
}

/// Attempts that a sample may take to find the disc; each misses with a probability of 1 - pi/4.
const ATTEMPTS: u32 = 1 << 12;

/// A direction above the third axis whose probability goes with its cosine: a place in the unit disc, found
/// by rejection, and the height of the sphere above it (Malley's method).
pub fn cosine(pixel: u32, sample: u32, seed: u32) -> V3<f32> {
    for attempt in 0..ATTEMPTS {
        let [x, y, _] = scrambled([pixel, sample * ATTEMPTS + attempt, seed]).map(signed);
        let height = 1.0 - (x * x + y * y);
        // A direction within the surface would leave it on neither side.
        if height > 1e-6 {
            return V3::new(x, y, height.sqrt());
        }
    }
    V3::new(0.0, 0.0, 1.0)
}

/// A direction, given about the third axis, about a unit vector instead: the branchless basis of Duff and
/// others 2017, Building an Orthonormal Basis, Revisited.
pub fn about(axis: V3<f32>, direction: V3<f32>) -> V3<f32> {
    let sign = 1f32.copysign(axis.z);
    let a = -1.0 / (sign + axis.z);
    let b = axis.x * axis.y * a;
    let first = V3::new(1.0 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x);
    let second = V3::new(b, sign + axis.y * axis.y * a, -axis.y);
    (first * direction.x + second * direction.y + axis * direction.z).normalised().0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn many(seed: u32) -> impl Iterator<Item = V3<f32>> {
        (0..25_000).flat_map(move |pixel| (0..4).map(move |sample| cosine(pixel, sample, seed)))
    }

    #[test]
    fn directions_go_with_their_cosine() {
        // Means over the hemisphere by density cos / pi: of the height 2/3, of its square 1/2, of x and y 0.
        let mut sums = [0f64; 5];
        for d in many(0) {
            let (x, y, z) = (f64::from(d.x), f64::from(d.y), f64::from(d.z));
            for (sum, term) in sums.iter_mut().zip([z, z * z, x, y, x * y]) {
                *sum += term / 100_000.0;
            }
        }
        for (mean, expected) in sums.into_iter().zip([2.0 / 3.0, 0.5, 0.0, 0.0, 0.0]) {
            assert!((mean - expected).abs() < 0.005, "{sums:?}");
        }
    }

    #[test]
    fn samples_pixels_and_seeds_differ() {
        let first: Vec<_> = many(0).collect();
        assert!(many(1).zip(&first).filter(|(a, b)| a == *b).count() < 5);
        let mut bits: Vec<_> = first.iter().map(|d| (d.x.to_bits(), d.y.to_bits())).collect();
        bits.sort_unstable();
        bits.dedup();
        assert!(bits.len() > 99_900);
    }

    #[test]
    fn turned_directions_keep_length_and_cosine() {
        for (axis, d) in many(2).zip(many(3)) {
            for axis in [axis, -axis] {
                let turned = about(axis, d);
                assert!((turned.dot(turned) - 1.0).abs() < 1e-6);
                assert!((turned.dot(axis) - d.z).abs() < 1e-6, "{axis:?} {d:?} {turned:?}");
            }
        }
        let straight = V3::new(0.0, 0.0, -1.0);
        assert_eq!(about(straight, V3::new(0.0, 0.0, 1.0)), straight);
    }
}
