//! Bringing a GPU to its own clocks.

use std::time::{Duration, Instant};

use crate::error::Result;

/// A run has settled once it takes more than this share of the best before.
const NOISE: f64 = 0.97;
/// Who has not settled by then never will.
const MOST: Duration = Duration::from_secs(2);

/// Runs until the time that `run` returns has settled, for `least` at least: an idle GPU has slow clocks (an H200 a
/// sixth of its own), and takes some tenths of a second of work to raise them, more with pauses in it.
///
/// # Errors
/// What a run reports.
pub fn warm(least: Duration, mut run: impl FnMut() -> Result<Duration>) -> Result<()> {
    let start = Instant::now();
    let mut best = Duration::MAX;
    loop {
        let took = run()?;
        let settled = took.as_secs_f64() >= NOISE * best.as_secs_f64();
        best = best.min(took);
        if start.elapsed() >= MOST || settled && start.elapsed() >= least {
            return Ok(());
        }
    }
}
