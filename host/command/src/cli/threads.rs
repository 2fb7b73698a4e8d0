//! How many threads there are.

use crate::error::{Error, Result, within};

/// The most threads.
const MOST_THREADS: usize = 1024;

/// The variable by which rayon, which spreads work over threads, takes their number.
const THREADS: &str = "RAYON_NUM_THREADS";

/// Refuses more threads than `--threads` would take, before any is started.
pub(super) fn check_environment() -> Result<()> {
    match std::env::var(THREADS).ok().and_then(|value| value.trim().parse::<u64>().ok()) {
        Some(threads) if threads > MOST_THREADS as u64 => {
            Err(Error::new(format!("{THREADS} is {threads}; set it to at most {MOST_THREADS}, or leave it out")))
        }
        _ => Ok(()),
    }
}

/// `--threads`; 0 is one a core.
pub(super) fn chosen(wish: Option<usize>) -> Result<usize> {
    within("--threads", wish.as_slice(), 1..=MOST_THREADS)?;
    Ok(wish.unwrap_or(0))
}
