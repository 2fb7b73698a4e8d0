//! As many samples as fit a time.

use std::time::{Duration, Instant};

use crate::error::Result;

/// Adds samples until the time is up or there are `most`, at least one, and returns how many there are. `add` adds some more and
/// returns when they are done. Their number is chosen by what those before took, so that the last of them end in time.
///
/// # Errors
/// Those of `add`.
pub fn fill(limit: Duration, most: u32, mut add: impl FnMut(u32) -> Result<()>) -> Result<u32> {
    let start = Instant::now();
    let (mut samples, mut next) = (0u32, 1u32);
    loop {
        let before = start.elapsed();
        add(next)?;
        samples += next;
        let (now, took) = (start.elapsed(), start.elapsed().saturating_sub(before));
        let each = (took.as_secs_f64() / f64::from(next)).max(1e-9);
        let fits = (limit.saturating_sub(now).as_secs_f64() / each).min(f64::from(most - samples)) as u32;
        // Half of what should fit, since nobody knows what it takes; in the end one by one.
        next = fits.div_ceil(2).min(next.saturating_mul(4));
        if next == 0 {
            return Ok(samples);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of samples that take so long, each added in a batch.
    fn filled(limit_ms: u64, each: Duration, most: u32) -> (u32, Vec<u32>) {
        let mut batches = Vec::new();
        let count = fill(Duration::from_millis(limit_ms), most, |count| {
            batches.push(count);
            std::thread::sleep(each * count);
            Ok(())
        });
        (count.unwrap(), batches)
    }

    #[test]
    fn there_is_at_least_one_and_never_too_many() {
        assert_eq!(filled(0, Duration::from_millis(1), 9), (1, vec![1]));
        assert_eq!(filled(10_000, Duration::ZERO, 9).0, 9);
        assert_eq!(filled(10_000, Duration::ZERO, 1), (1, vec![1]));
    }

    #[test]
    fn batches_are_counted_and_none_is_empty() {
        let (count, batches) = filled(60, Duration::from_millis(2), 1 << 24);
        assert_eq!(count, batches.iter().sum::<u32>());
        assert!(batches.iter().all(|&batch| batch > 0) && count <= 31, "{batches:?}");
    }

    #[test]
    fn a_fault_ends_it() {
        assert!(fill(Duration::from_secs(9), 9, |_| Err(crate::error::Error::NoGpu)).is_err());
    }
}
