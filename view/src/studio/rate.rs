//! How fast pictures come, over the last while.

use std::time::{Duration, Instant};

use crate::news::Rates;

/// So long is counted before it is told.
const WHILE: Duration = Duration::from_millis(500);
/// And so long where not even one picture is done.
const LONG: Duration = Duration::from_secs(4);

/// Counts since some moment.
pub(super) struct Meter {
    since: Instant,
    frames: u32,
    samples: u64,
    /// What the device's clock said then.
    clock: Option<Duration>,
}

impl Meter {
    pub fn new() -> Meter {
        Meter { since: Instant::now(), frames: 0, samples: 0, clock: None }
    }

    /// Counts samples of pixels, and pictures that they complete.
    pub fn count(&mut self, frames: u32, samples: u64) {
        self.frames += frames;
        self.samples += samples;
    }

    /// What it has come to, every while; `clock` is the time that the device has been at work until now.
    pub fn rates(&mut self, clock: Option<Duration>) -> Option<Rates> {
        let seconds = self.since.elapsed();
        if seconds < if self.frames > 0 { WHILE } else { LONG } {
            return None;
        }
        let each = |count: f64| count / seconds.as_secs_f64();
        let worked = clock.zip(self.clock).and_then(|(now, before)| now.checked_sub(before));
        let device = worked.map(|worked| each(worked.as_secs_f64()).min(1.0));
        let rates = Rates { frames: each(self.frames.into()), rays: each(self.samples as f64), device };
        *self = Meter { clock, ..Meter::new() };
        Some(rates)
    }
}
