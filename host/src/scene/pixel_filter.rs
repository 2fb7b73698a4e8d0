//! What around a pixel's middle its colour is the mean of.

use std::f64::consts::{LOG2_E, TAU};

use crate::choice::choices;
use crate::math;

choices! {
    /// How a pixel weighs what is around its middle.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum PixelFilter {
        /// All of the pixel alike, and nothing else
        #[default]
        Box = "box",
        /// Less with the distance, up to the middles of its neighbours
        Tent = "tent",
        /// By Gauss' curve of a deviation of half a pixel, up to 1.5 pixels
        Gaussian = "gaussian",
        /// By the window of Blackman and Harris up to 1.5 pixels: edges are smooth and sharp; the default where light is sampled
        BlackmanHarris = "blackman-harris",
    }
}

impl PixelFilter {
    /// How far it reaches from the middle along each axis, in pixels.
    pub fn radius(self) -> f64 {
        match self {
            PixelFilter::Box => 0.5,
            PixelFilter::Tent => 1.0,
            PixelFilter::Gaussian | PixelFilter::BlackmanHarris => 1.5,
        }
    }

    /// Its weight at a distance along one axis in pixels, but for a factor; that of both axes is the product. 0 from [`PixelFilter::radius`]
    /// on.
    pub fn weight(self, distance: f64) -> f64 {
        let (at, radius) = (distance.abs(), self.radius());
        if at >= radius {
            return 0.0;
        }
        match self {
            PixelFilter::Box => 1.0,
            PixelFilter::Tent => 1.0 - at,
            PixelFilter::Gaussian => gauss(at) - gauss(radius),
            PixelFilter::BlackmanHarris => {
                // Harris, On the Use of Windows for Harmonic Analysis, 1978: four terms, 92 dB.
                let turn = TAU * (at / radius / 2.0 + 0.5);
                0.35875 - 0.48829 * math::cos(turn) + 0.14128 * math::cos(2.0 * turn) - 0.01168 * math::cos(3.0 * turn)
            }
        }
    }

    /// Where shares of the filter's weight end, from the least: the inverse of its cumulative distribution at `steps + 1` shares, in pixels
    /// from the middle. `steps` is even.
    pub(crate) fn inverse(self, steps: u32) -> Vec<f32> {
        /// Parts of half the filter, whose weight is that of their middles.
        const PARTS: usize = 1 << 16;
        let width = self.radius() / PARTS as f64;
        let mut sums = vec![0.0];
        for part in 0..PARTS {
            sums.push(sums[part] + self.weight((part as f64 + 0.5) * width));
        }
        let whole = sums[PARTS];
        // Of the half beyond the middle, whose mirror image is the other.
        let mut part = 0;
        let beyond: Vec<f32> = (0..=steps / 2)
            .map(|step| {
                let wanted = whole * f64::from(step) / f64::from(steps / 2);
                while part + 1 < PARTS && sums[part + 1] < wanted {
                    part += 1;
                }
                let within = (wanted - sums[part]) / (sums[part + 1] - sums[part]);
                ((part as f64 + within.clamp(0.0, 1.0)) * width) as f32
            })
            .collect();
        let before = beyond[1..].iter().rev().map(|&distance| -distance);
        before.chain(beyond.iter().copied()).collect()
    }
}

/// Of half a pixel's deviation.
fn gauss(distance: f64) -> f64 {
    math::exp2(-2.0 * distance * distance * LOG2_E)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::choice::Named;

    /// Means and variances of the distances at the middles of equal shares, beside integrals by other steps.
    #[test]
    fn a_table_has_the_filters_moments() {
        for &filter in PixelFilter::VARIANTS {
            let table = filter.inverse(1024);
            assert_eq!((table.len(), table[512], table[0]), (1025, 0.0, -table[1024]));
            assert!((f64::from(table[1024]) - filter.radius()).abs() < 1e-6, "{}", filter.name());
            assert!(table.windows(2).all(|pair| pair[0] <= pair[1]), "{}", filter.name());
            let steps = 30_000;
            let at = |i: u32| (f64::from(i) + 0.5) / f64::from(steps) * filter.radius();
            let weight = (0..steps).map(|i| filter.weight(at(i))).sum::<f64>();
            let moment = |n| (0..steps).map(|i| filter.weight(at(i)) * at(i).powi(n)).sum::<f64>() / weight;
            // Even between two entries.
            let own = |n: i32| {
                let mean = |pair: &[f32]| {
                    let [a, b] = [pair[0], pair[1]].map(f64::from);
                    if n == 1 { (a + b) / 2.0 } else { (a * a + a * b + b * b) / 3.0 }
                };
                table[512..].windows(2).map(mean).sum::<f64>() / 512.0
            };
            for n in [1, 2] {
                // What the widest step may be off, the last: half of what lies between its ends.
                let [last, end] = [table[1023], table[1024]].map(f64::from);
                let most = (end.powi(n) - last.powi(n)) / 512.0 / 2.0;
                let (own, wanted) = (own(n), moment(n));
                assert!((own - wanted).abs() < most, "{} {n}: {own} {wanted} {most}", filter.name());
            }
        }
    }

    /// The integral of the window over its width is its constant term.
    #[test]
    fn the_window_is_the_published_one() {
        let radius = PixelFilter::BlackmanHarris.radius();
        let sum: f64 =
            (0..1000).map(|i| PixelFilter::BlackmanHarris.weight((f64::from(i) + 0.5) / 1000.0 * radius)).sum();
        assert!((sum / 1000.0 - 0.35875).abs() < 1e-6 && (PixelFilter::BlackmanHarris.weight(0.0) - 1.0).abs() < 1e-12);
        assert!((PixelFilter::Gaussian.weight(0.5) - ((-0.5f64).exp() - (-4.5f64).exp())).abs() < 1e-12);
    }
}
