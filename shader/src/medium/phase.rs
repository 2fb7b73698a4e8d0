//! By which angle a medium scatters light (Henyey and Greenstein, Diffuse Radiation in the Galaxy, 1941).

use crate::geometry::tangents;
use crate::light::on_circle;
use crate::real::{FAINT, Scalar, TINY, V3};
use crate::sampler::unit;

/// One over the solid angle of all directions.
const EVEN: f32 = 0.25 * core::f32::consts::FRAC_1_PI;

/// Means of the cosine below this scatter evenly: their squares and quotients would be rounding alone, and no picture tells.
const LEAST: f32 = 1.0 / 1024.0;

/// The phase function of a mean cosine, in (-1, 1): a density over solid angle.
#[derive(Clone, Copy)]
pub struct Phase<R>(pub R);

impl<R: Scalar> Phase<R> {
    /// Is it the same in all directions?
    #[inline(always)]
    fn is_even(self) -> bool {
        self.0.abs().lt(R::splat(LEAST))
    }

    /// The density of being scattered by an angle of some cosine against the way on.
    #[inline(always)]
    pub fn density(self, cosine: R) -> R {
        let (one, g) = (R::splat(1.0), self.0);
        if self.is_even() {
            return R::splat(EVEN);
        }
        // At least (1 - |g|)^2, whatever rounding does to the cosine.
        let rest = one - g.abs();
        let under = (one + g * g - g * (cosine + cosine)).max(rest * rest);
        (R::splat(EVEN) * (one - g * g)).div(under * under.sqrt()).flush(FAINT)
    }

    /// A direction as likely as its density, and that, of light on its way in a unit direction.
    #[inline(always)]
    pub fn sample(self, direction: V3<R>, (cosine, angle): (u32, u32)) -> (V3<R>, R) {
        let (zero, one, two) = (R::splat(0.0), R::splat(1.0), R::splat(2.0));
        let (drawn, g) = (R::splat(unit(cosine)), self.0);
        let cosine = if self.is_even() {
            one - drawn * two
        } else {
            // Of the largest cosine first, as where light goes on.
            let square = (one - g * g).div(one + g - drawn * (g * two));
            (one + g * g - square * square).div(g * two)
        };
        let cosine = cosine.max(-one).min(one);
        let across = (one - cosine * cosine).max(zero).sqrt();
        let (x, y) = on_circle::<R>(angle);
        let [right, up] = tangents(direction);
        let beside = (right * x + up * y).map(|c| c.flush(TINY)) * across;
        let scattered = (beside + direction * cosine).map(|c| c.flush(TINY)).renormalised();
        (scattered, self.density(cosine))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Launch;
    use crate::sampler::{self, Key};

    const MEANS: [f64; 9] = [-0.9, -0.5, -0.1, -0.0009, 0.0, 0.002, 0.3, 0.75, 0.9];

    fn drawn(i: u32) -> (u32, u32) {
        let set = sampler::set(Launch(Launch::RANDOM), Key(3, 5), i, 1);
        (set.x, set.y)
    }

    #[test]
    fn all_that_is_scattered_goes_somewhere() {
        for g in MEANS {
            let steps = 200_000;
            let density = |i: u32| Phase(g).density((f64::from(i) + 0.5) / f64::from(steps) * 2.0 - 1.0);
            let sum: f64 = (0..steps).map(density).sum::<f64>() * std::f64::consts::TAU * 2.0 / f64::from(steps);
            assert!((sum - 1.0).abs() < 1e-4, "{g}: {sum}");
        }
    }

    /// Chi-square over 64 equal bins of the cosine by 8 of the azimuth, whose probabilities are the density's integral in closed form.
    #[test]
    fn directions_are_as_likely_as_their_density() {
        const BINS: usize = 64;
        let count = 1 << 19;
        for g in MEANS {
            let (forward, phase) = (V3::new(0.48, -0.6, 0.64), Phase(g));
            let [right, up] = tangents(forward);
            let mut bins = [[0f64; 8]; BINS];
            for i in 0..count {
                let (d, density) = phase.sample(forward, drawn(i));
                let cosine = d.dot(forward);
                assert!((d.dot(d) - 1.0).abs() < 1e-6);
                assert!((density / phase.density(cosine) - 1.0).abs() < 1e-4, "{g}: {cosine}");
                let turn = d.dot(up).atan2(d.dot(right)) / std::f64::consts::TAU + 0.5;
                let bin = ((cosine + 1.0) / 2.0 * BINS as f64) as usize;
                bins[bin.min(BINS - 1)][((turn * 8.0) as usize).min(7)] += 1.0;
            }
            // Henyey and Greenstein's integral up to a cosine; evenly without a mean.
            let below = |c: f64| {
                if g.abs() < f64::from(LEAST) {
                    return (1.0 + c) / 2.0;
                }
                (1.0 - g * g) / (2.0 * g) * (1.0 / (1.0 + g * g - 2.0 * g * c).sqrt() - 1.0 / (1.0 + g))
            };
            let edge = |i: usize| i as f64 / BINS as f64 * 2.0 - 1.0;
            let mut chi = 0.0;
            let mut freedom = -1.0;
            for (i, row) in bins.iter().enumerate() {
                let expected = (below(edge(i + 1)) - below(edge(i))) / 8.0 * f64::from(count);
                assert!(expected > 4.0, "{g}: a bin of {expected}");
                chi += row.iter().map(|seen| (seen - expected).powi(2) / expected).sum::<f64>();
                freedom += 8.0;
            }
            let deviations = (chi - freedom) / (2.0f64 * freedom).sqrt();
            assert!(deviations.abs() < 5.0, "{g}: {deviations}");
        }
    }

    #[test]
    fn no_cosine_makes_it_infinite_in_single_precision() {
        for g in [-0.999f32, -0.5, 0.999] {
            for cosine in [-1.000_001, -1.0, 0.0, 1.0, 1.000_001] {
                let density = Phase(g).density(cosine);
                assert!(density.is_finite() && density > 0.0, "{g}, {cosine}: {density}");
            }
        }
    }
}
