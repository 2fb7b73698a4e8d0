//! Diffuse reflection by Lambert's law, sampled in proportion to it.

use crate::geometry::tangents;
use crate::light::on_circle;
use crate::real::{Scalar, TINY, V3};
use crate::sampler::unit;

/// The radiance of a white surface over the irradiance that it gets.
pub const INVERSE_PI: f32 = core::f32::consts::FRAC_1_PI;

/// A direction around a unit normal whose density over solid angle is its cosine over pi, and that cosine, which is at least 2^-12:
/// uniform on a disk, and up from there (Malley's method). Of unit length but for a few roundoffs.
#[inline(always)]
pub fn cosine_direction<R: Scalar>(normal: V3<R>, (radius, angle): (u32, u32)) -> (V3<R>, R) {
    let square = R::splat(unit(radius));
    let (cosine, across) = ((R::splat(1.0) - square).sqrt(), square.sqrt());
    let (x, y) = on_circle::<R>(angle);
    let [right, up] = tangents(normal);
    let beside = (right * x + up * y).map(|c| c.flush(TINY)) * across;
    ((beside + normal * cosine).map(|c| c.flush(TINY)), cosine)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Launch;
    use crate::sampler::{self, Key};

    /// Means of powers of the cosine, (n + 2) / 2 over, and of the parts along the surface, within five standard errors.
    #[test]
    fn directions_are_as_likely_as_their_cosine() {
        let count = 1 << 16;
        for normal in [V3::new(0.0, 0.0, 1.0), V3::new(0.6, 0.0, -0.8), V3::new(0.48, -0.6, 0.64)] {
            let drawn = |i| sampler::set(Launch(Launch::RANDOM), Key(3, 5), i, 1);
            let directions: Vec<(V3<f64>, f64)> =
                (0..count).map(|i| cosine_direction(normal, (drawn(i).x, drawn(i).y))).collect();
            let mean =
                |of: &dyn Fn(V3<f64>) -> f64| directions.iter().map(|&(d, _)| of(d)).sum::<f64>() / f64::from(count);
            let error = 5.0 * 0.5 / f64::from(count).sqrt();
            for power in 1..5 {
                let got = mean(&|d| d.dot(normal).powi(power));
                assert!((got - 2.0 / f64::from(power + 2)).abs() < error, "{power}: {got}");
            }
            let [right, up] = tangents(normal);
            for (axis, other) in [(right, up), (up, right)] {
                assert!(mean(&|d| d.dot(axis)).abs() < 2.0 * error);
                assert!(mean(&|d| d.dot(axis) * d.dot(other)).abs() < error);
                assert!((mean(&|d| d.dot(axis) * d.dot(axis)) - 0.25).abs() < error);
            }
            for (d, cosine) in &directions {
                assert!((d.dot(normal) - cosine).abs() < 1e-6 && (d.dot(*d) - 1.0).abs() < 1e-6);
                assert!(*cosine >= 1.0 / 4096.0);
            }
        }
    }
}
