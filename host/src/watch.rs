//! Renderings that grow by samples while somebody looks on, and end early where that is wanted.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::error::Result;
use crate::picture::Picture;

/// How long samples take that are added at once, where one does not take longer: so soon a rendering ends that is stopped.
const STEP: Duration = Duration::from_secs(1);

/// Who looks on, and when it ends. See [`Backend::render_watched`](crate::render::Backend::render_watched).
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    /// As many samples as fit so long, at least one.
    pub limit: Option<Duration>,
    /// Once it is set, the rendering ends with the samples that are done.
    pub stop: &'a AtomicBool,
    /// Hears of samples that were added.
    pub grown: &'a dyn Fn(Growth<'_>),
}

/// A picture that has got some samples.
pub struct Growth<'a> {
    /// Samples of each pixel.
    pub samples: u32,
    /// Samples that it shall have.
    pub of: u32,
    picture: &'a mut dyn FnMut() -> Result<Picture>,
}

impl Growth<'_> {
    /// The picture so far: the bits of one of so many samples.
    ///
    /// # Errors
    /// What the device reports, or if there is no memory for the picture.
    pub fn picture(self) -> Result<Picture> {
        (self.picture)()
    }
}

/// A picture that samples are added to.
pub(crate) trait Grows {
    /// Adds samples and returns when they are done.
    fn add(&mut self, count: u32) -> Result<()>;

    /// The picture so far.
    fn picture(&mut self) -> Result<Picture>;
}

/// Adds samples until there are `most`, the time is up or somebody stops it. Their number is chosen by what those before took.
///
/// # Errors
/// Those of the picture.
pub(crate) fn grow(picture: &mut impl Grows, most: u32, watch: &Watch<'_>) -> Result<()> {
    let start = Instant::now();
    let (mut samples, mut next) = (0u32, 1u32);
    while next > 0 {
        let before = Instant::now();
        picture.add(next)?;
        samples += next;
        let each = (before.elapsed().as_secs_f64() / f64::from(next)).max(1e-9);
        (watch.grown)(Growth { samples, of: most, picture: &mut || picture.picture() });
        if watch.stop.load(Ordering::Relaxed) {
            break;
        }
        let step = ((STEP.as_secs_f64() / each) as u32).max(1).min(next.saturating_mul(4));
        let left = match watch.limit {
            // Half of what should fit, since nobody knows what it takes; in the end one by one.
            Some(limit) => ((limit.saturating_sub(start.elapsed()).as_secs_f64() / each) as u32).div_ceil(2),
            None => u32::MAX,
        };
        next = step.min(left).min(most - samples);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;

    /// A picture whose samples take so long each, and the batches that were added.
    struct Slow {
        each: Duration,
        batches: Vec<u32>,
        fails: bool,
    }

    impl Grows for Slow {
        fn add(&mut self, count: u32) -> Result<()> {
            self.batches.push(count);
            std::thread::sleep(self.each * count);
            if self.fails { Err(Error::NoGpu) } else { Ok(()) }
        }

        fn picture(&mut self) -> Result<Picture> {
            Picture::new(self.batches.iter().sum(), 1)
        }
    }

    fn slow(each: Duration) -> Slow {
        Slow { each, batches: Vec::new(), fails: false }
    }

    /// The batches of a rendering with a limit, in milliseconds.
    fn filled(limit: Option<u64>, each: Duration, most: u32) -> Vec<u32> {
        let mut picture = slow(each);
        let (stop, limit) = (AtomicBool::new(false), limit.map(Duration::from_millis));
        grow(&mut picture, most, &Watch { limit, stop: &stop, grown: &|_| () }).unwrap();
        picture.batches
    }

    #[test]
    fn there_is_at_least_one_and_never_too_many() {
        assert_eq!(filled(Some(0), Duration::from_millis(1), 9), [1]);
        assert_eq!(filled(Some(10_000), Duration::ZERO, 9).iter().sum::<u32>(), 9);
        assert_eq!(filled(Some(10_000), Duration::ZERO, 1), [1]);
        assert_eq!(filled(None, Duration::ZERO, 100), [1, 4, 16, 64, 15]);
    }

    #[test]
    fn batches_fit_the_limit_and_none_is_empty() {
        let batches = filled(Some(60), Duration::from_millis(2), 1 << 24);
        assert!(batches.iter().all(|&batch| batch > 0) && batches.iter().sum::<u32>() <= 31, "{batches:?}");
    }

    /// Three samples take more than a step.
    #[test]
    fn batches_are_short_enough_to_stop() {
        assert_eq!(filled(None, Duration::from_millis(400), 4), [1, 2, 1]);
    }

    #[test]
    fn whoever_looks_on_sees_the_samples_and_can_end_it() {
        let (stop, seen) = (AtomicBool::new(false), std::cell::RefCell::new(Vec::new()));
        let grown = |growth: Growth<'_>| {
            let (samples, of) = (growth.samples, growth.of);
            stop.store(samples >= 5, Ordering::Relaxed);
            seen.borrow_mut().push((samples, of, growth.picture().unwrap().pixels.len()));
        };
        let mut picture = slow(Duration::ZERO);
        grow(&mut picture, 100, &Watch { limit: None, stop: &stop, grown: &grown }).unwrap();
        assert_eq!(*seen.borrow(), [(1, 100, 1), (5, 100, 5)]);
    }

    #[test]
    fn a_fault_ends_it() {
        let (mut picture, stop) = (Slow { fails: true, ..slow(Duration::ZERO) }, AtomicBool::new(false));
        assert!(grow(&mut picture, 9, &Watch { limit: None, stop: &stop, grown: &|_| () }).is_err());
        assert_eq!(picture.batches, [1]);
    }
}
