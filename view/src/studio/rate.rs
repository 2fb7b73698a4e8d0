//! How fast pictures come, over the last while.

use std::time::{Duration, Instant};

use crate::news::Rates;

/// So long is counted before it is told.
const WHILE: Duration = Duration::from_millis(500);

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

    /// Counts a frame of so many samples.
    pub fn count(&mut self, samples: u64) {
        self.frames += 1;
        self.samples += samples;
    }

    /// What it has come to, every while; `clock` is the time that the device has been at work until now.
    pub fn rates(&mut self, clock: Option<Duration>) -> Option<Rates> {
        let seconds = self.since.elapsed();
        if seconds < WHILE {
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
