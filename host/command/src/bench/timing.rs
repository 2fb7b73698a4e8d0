//! Times of repetitions.

use std::time::Duration;

/// What repetitions took, in seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timing {
    /// The median.
    pub median: f64,
    /// From the 10th to the 90th percentile, as a share of the median.
    pub spread: f64,
}

impl Timing {
    /// Of at least one repetition.
    ///
    /// # Panics
    /// If there is none.
    pub fn of(times: &[Duration]) -> Timing {
        let mut seconds: Vec<f64> = times.iter().map(Duration::as_secs_f64).collect();
        seconds.sort_unstable_by(f64::total_cmp);
        let last = seconds.len() - 1;
        let percentile = |p: usize| seconds[(last * p + 50) / 100];
        let median = (seconds[last / 2] + seconds[last.div_ceil(2)]) / 2.0;
        // A clock may be too coarse for a small stream.
        let median = median.max(1e-9);
        Timing { median, spread: (percentile(90) - percentile(10)) / median }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_in_the_middle_and_the_spread_without_the_extremes() {
        let of = |ms: &[u64]| Timing::of(&ms.iter().map(|&ms| Duration::from_millis(ms)).collect::<Vec<_>>());
        assert_eq!(of(&[7]), Timing { median: 0.007, spread: 0.0 });
        assert!((of(&[4, 2]).median - 0.003).abs() < 1e-12);
        let eleven = of(&[100, 10, 11, 12, 13, 14, 15, 16, 17, 18, 1]);
        assert!((eleven.median - 0.014).abs() < 1e-12);
        assert!((eleven.spread - 8.0 / 14.0).abs() < 1e-9);
    }
}
