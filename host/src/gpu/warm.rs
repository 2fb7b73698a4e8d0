//! Raising a GPU's clocks before measurements.

use std::time::{Duration, Instant};

use crate::error::Result;

/// A run has settled once it takes more than this share of the best before.
const NOISE: f64 = 0.97;
/// Gives up waiting for steady times after this long.
const MOST: Duration = Duration::from_secs(2);

/// Runs until the time that `run` returns has settled, for `least` at least: an idle GPU has slow clocks (an H200 a
/// sixth of its full ones), and takes some tenths of a second of work to raise them, more if the work pauses.
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
