//! How fast pictures are, and so how large one may be while the camera moves.

use std::time::Duration;

/// A picture each so long looks smooth.
const SMOOTH: f64 = 1.0 / 60.0;
/// So long a hand may wait for what it does.
const LONGEST: f64 = 0.03;
/// Pictures of a moving camera are smaller by one of these.
const DIVISORS: [u32; 5] = [1, 2, 4, 8, 16];
/// A picture is made larger again where that leaves so much of the time unused.
const SPARE: f64 = 0.6;

/// What samples took lately.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pace {
    /// Of a sample of a pixel, in seconds; unknown before the first.
    each: Option<f64>,
    divisor: u32,
}

impl Pace {
    pub fn new() -> Pace {
        Pace { each: None, divisor: 4 }
    }

    /// Learns what so many samples of pixels took.
    pub fn learn(&mut self, samples: u64, took: Duration) {
        let each = took.as_secs_f64() / samples.max(1) as f64;
        self.each = Some(self.each.map_or(each, |before| 0.7 * before + 0.3 * each));
    }

    /// Forgets: another device or another integrator.
    pub fn forget(&mut self) {
        *self = Pace::new();
    }

    fn expected(&self, pixels: f64) -> Option<f64> {
        self.each.map(|each| each * pixels)
    }

    /// By what the edge of a picture of so many pixels is divided while its camera moves.
    pub fn divisor(&mut self, pixels: u64) -> u32 {
        let takes = |divisor: u32| self.expected(pixels as f64 / f64::from(divisor * divisor));
        let now = self.divisor;
        let fits = |divisor: u32| takes(divisor).is_some_and(|seconds| seconds <= SMOOTH);
        let has_spare = |divisor: u32| takes(divisor).is_some_and(|seconds| seconds <= SPARE * SMOOTH);
        let fitting =
            DIVISORS.into_iter().find(|&divisor| if divisor < now { has_spare(divisor) } else { fits(divisor) });
        let slowest = if self.each.is_some() { DIVISORS[DIVISORS.len() - 1] } else { now };
        self.divisor = fitting.unwrap_or(slowest);
        self.divisor
    }

    /// Rows of a part of a picture that does not let a hand wait.
    pub fn rows(&self, (width, height): (u32, u32)) -> u32 {
        match self.expected(f64::from(width)) {
            Some(row) => ((LONGEST / row) as u32).clamp(8.min(height), height),
            None => height,
        }
    }

    /// Samples of a picture's pixels at once.
    pub fn batch(&self, pixels: u64) -> u32 {
        self.expected(pixels as f64).map_or(1, |sample| ((LONGEST / sample) as u32).clamp(1, 64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(pixels_a_second: f64) -> Pace {
        let mut pace = Pace::new();
        pace.learn(1_000_000, Duration::from_secs_f64(1e6 / pixels_a_second));
        pace
    }

    #[test]
    fn a_moving_picture_is_as_large_as_sixty_a_second_allow() {
        let megapixel = 1 << 20;
        for (pixels_a_second, divisor) in
            [(1e9, 1), (61.0 * 1.05e6 / 4.0 / SPARE, 2), (61.0 * 1.05e6 / 16.0, 4), (1e5, 16)]
        {
            let mut pace = of(pixels_a_second);
            assert_eq!(pace.divisor(megapixel), divisor, "{pixels_a_second}");
        }
    }

    #[test]
    fn at_the_border_a_picture_does_not_change_its_size_all_the_time() {
        let mut pace = of(60.0 * 1e6 * 1.05);
        pace.divisor = 2;
        assert_eq!(pace.divisor(1_000_000), 2);
        pace.learn(1_000_000, Duration::from_millis(1));
        (0..20).for_each(|_| pace.learn(1_000_000, Duration::from_millis(1)));
        assert_eq!(pace.divisor(1_000_000), 1);
        (0..20).for_each(|_| pace.learn(1_000_000, Duration::from_millis(16)));
        assert_eq!(pace.divisor(1_000_000), 1);
    }

    #[test]
    fn a_slow_picture_is_made_of_strips_and_a_fast_one_of_many_samples() {
        assert_eq!(of(1e5).rows((1000, 500)), 8);
        assert_eq!(of(1e9).rows((1000, 500)), 500);
        assert_eq!(of(1e9).batch(500_000), 60);
        assert_eq!(of(1e5).batch(500_000), 1);
        assert_eq!(Pace::new().rows((1000, 500)), 500);
        assert_eq!(of(1.0).rows((1000, 3)), 3);
    }
}
