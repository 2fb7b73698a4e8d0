//! A rendering as a person follows it: the bar, the picture so far under its own name, and the end that a signal asks for.

use std::cell::Cell;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};
use std::time::{Duration, Instant};

use indicatif::ProgressBar;

use super::console;
use super::exposure::Brightness;
use crate::output::{self, Destination};
use eyerays::image::Encoding;
use eyerays::watch::{Growth, Watch};

/// A picture that takes longer than this is written while it is rendered ...
const LONG: Duration = Duration::from_secs(20);
/// ... so often, unless another interval is asked for.
const EVERY: Duration = Duration::from_secs(10);

/// Ends the rendering that is watched.
static STOP: AtomicBool = AtomicBool::new(false);
/// Is there one?
static WATCHED: AtomicBool = AtomicBool::new(false);
/// The signal that ended it; 0 is none.
static SIGNAL: AtomicI32 = AtomicI32::new(0);

/// Asks the rendering that is watched to end with what is done, because of a signal. False if there is none, or it was asked before.
#[cfg(unix)]
pub(super) fn end_by(signal: i32) -> bool {
    if !WATCHED.load(Ordering::SeqCst) || STOP.swap(true, Ordering::SeqCst) {
        return false;
    }
    SIGNAL.store(signal, Ordering::SeqCst);
    true
}

/// The signal that ended a rendering.
pub(super) fn ended_by() -> Option<i32> {
    match SIGNAL.load(Ordering::SeqCst) {
        0 => None,
        signal => Some(signal),
    }
}

/// What follows a rendering.
pub(super) struct Watching<'a> {
    pub bar: ProgressBar,
    pub destination: &'a Destination,
    pub encoding: Encoding,
    /// Is its exposure the picture's own?
    pub auto_exposure: bool,
    /// Between two pictures so far; zero is never.
    pub every: Option<Duration>,
    /// How long it may take.
    pub limit: Option<Duration>,
    pub quiet: bool,
}

impl Watching<'_> {
    /// Renders by `work` under the eyes of this.
    pub fn follow<T>(&self, work: impl FnOnce(&Watch<'_>) -> T) -> T {
        let (start, written, faulty) = (Instant::now(), Cell::new(Instant::now()), Cell::new(false));
        let can_write = output::can_replace(self.destination);
        let grown = |growth: Growth<'_>| {
            self.bar.set_length(growth.of.into());
            self.bar.set_position(growth.samples.into());
            let is_over = growth.samples == growth.of || STOP.load(Ordering::SeqCst);
            let whole = start.elapsed().mul_f64(f64::from(growth.of) / f64::from(growth.samples));
            let every = interval(self.every, self.limit.map_or(whole, |limit| whole.min(limit)));
            if can_write && !is_over && every.is_some_and(|every| written.get().elapsed() >= every) {
                self.write(growth, &faulty);
                written.set(Instant::now());
            }
        };
        WATCHED.store(true, Ordering::SeqCst);
        let done = work(&Watch { limit: self.limit, stop: &STOP, grown: &grown });
        WATCHED.store(false, Ordering::SeqCst);
        self.bar.finish_and_clear();
        done
    }

    /// What can't be written now may be later, and the rendering goes on.
    fn write(&self, growth: Growth<'_>, faulty: &Cell<bool>) {
        let samples = growth.samples;
        let written = growth.picture().map_err(Into::into).and_then(|picture| {
            let own = self.auto_exposure.then(|| Brightness::of(&picture).exposure());
            let encoding = Encoding { exposure_ev: own.unwrap_or(self.encoding.exposure_ev), ..self.encoding };
            output::write_picture(&picture, self.destination, &encoding)
        });
        if let Err(error) = written
            && !faulty.replace(true)
            && !self.quiet
        {
            self.bar.suspend(|| console::say(format_args!("warning: the picture of {samples} samples: {error}")));
        }
    }
}

/// How often the picture so far is written of a rendering that takes about so long as a whole, if ever; zero was asked for for never.
fn interval(asked: Option<Duration>, whole: Duration) -> Option<Duration> {
    match asked {
        Some(every) => (!every.is_zero()).then_some(every),
        None => (whole > LONG).then_some(EVERY),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_renderings_show_what_they_have_unless_nobody_wants_that() {
        let (short, long) = (Duration::from_secs(20), Duration::from_secs(21));
        assert_eq!((interval(None, short), interval(None, long)), (None, Some(EVERY)));
        let second = Duration::from_secs(1);
        assert_eq!((interval(Some(second), short), interval(Some(second), long)), (Some(second), Some(second)));
        assert_eq!(interval(Some(Duration::ZERO), long), None);
    }
}
