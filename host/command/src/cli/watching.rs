//! A rendering as a person follows it: the bar, the picture so far under its own name, and the end that a signal asks for.

use std::cell::Cell;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};
use std::time::{Duration, Instant};

use indicatif::ProgressBar;

use super::checkpoint::Checkpoint;
use super::console;
use super::live::Live;
use super::look::Look;
use crate::error::Result;
use crate::output::{self, Destination};
use eyerays::film::{Film, Identity};
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
    pub look: Look,
    /// Between two pictures so far; zero is never.
    pub every: Option<Duration>,
    /// How long it may take.
    pub limit: Option<Duration>,
    /// Where its film is kept.
    pub checkpoint: Option<&'a Checkpoint>,
    /// What the film is of.
    pub identity: &'a Identity,
    /// Who sees the picture so far.
    pub live: Option<&'a Live>,
    pub quiet: bool,
}

/// What is done with a film so far.
#[derive(Clone, Copy)]
struct Due {
    /// Its picture is written.
    shows: bool,
    /// The film is.
    keeps: bool,
    /// The picture is sent to who watches.
    sends: bool,
}

/// When what was written last, and whether a fault of writing was told.
struct Written {
    picture: Cell<Instant>,
    film: Cell<Instant>,
    faulty: Cell<bool>,
    /// How many rays there were when.
    rays: Cell<(Instant, u64)>,
}

impl Watching<'_> {
    /// Renders by `work` under the eyes of this.
    pub fn follow<T>(&self, work: impl FnOnce(&Watch<'_>) -> T) -> T {
        let start = Instant::now();
        let written = Written {
            picture: Cell::new(start),
            film: Cell::new(start),
            faulty: Cell::new(false),
            rays: Cell::new((start, 0)),
        };
        let can_write = output::can_replace(self.destination) && !self.destination.is_film();
        let first = Cell::new(None);
        let grown = |growth: Growth<'_>| {
            let (done, of) = match growth.cells {
                Some((done, of)) => (done as u64, of as u64),
                None => (growth.samples.into(), growth.of.into()),
            };
            self.bar.set_length(of);
            self.bar.set_position(done);
            let is_over = done == of || STOP.load(Ordering::SeqCst);
            // What was there before took no time.
            let first = first.get().unwrap_or_else(|| {
                first.set(Some(growth.samples));
                growth.samples.saturating_sub(1)
            });
            let share =
                f64::from(growth.of.saturating_sub(first)) / f64::from(growth.samples.saturating_sub(first).max(1));
            // What ends by its noise may end at any time.
            let whole = if growth.cells.is_some() { start.elapsed() } else { start.elapsed().mul_f64(share) };
            let whole = self.limit.map_or(whole, |limit| whole.min(limit));
            let every = interval(self.every, whole).filter(|_| can_write);
            let shows = every.is_some_and(|every| written.picture.get().elapsed() >= every);
            let keeps = self.checkpoint.is_some_and(|to| to.is_due(written.film.get().elapsed(), whole));
            let sends = self.live.is_some_and(Live::is_due);
            if !is_over && (shows || keeps || sends) {
                self.write(growth, Due { shows, keeps, sends }, &written);
            }
        };
        WATCHED.store(true, Ordering::SeqCst);
        let done = work(&Watch { limit: self.limit, stop: &STOP, grown: &grown });
        WATCHED.store(false, Ordering::SeqCst);
        self.bar.finish_and_clear();
        done
    }

    /// What can't be written now may be later, and the rendering goes on.
    fn write(&self, growth: Growth<'_>, due: Due, written: &Written) {
        let samples = growth.samples;
        let done = growth.film().map_err(Into::into).and_then(|film| self.write_film(film, due, written));
        for (_, last) in
            [(due.shows, &written.picture), (due.keeps, &written.film)].iter().filter(|(is_done, _)| *is_done)
        {
            last.set(Instant::now());
        }
        if let Err(error) = done
            && !written.faulty.replace(true)
            && !self.quiet
        {
            self.bar.suspend(|| console::say(format_args!("warning: the picture of {samples} samples: {error}")));
        }
    }

    fn write_film(&self, mut film: Film, due: Due, written: &Written) -> Result<()> {
        film.identity = self.identity.clone();
        if let Some(checkpoint) = self.checkpoint.filter(|_| due.keeps) {
            checkpoint.keep(&film)?;
        }
        let (picture, rays) = film.developed()?;
        let before = written.rays.replace((Instant::now(), rays.total()));
        let asked = film.cells().map_or(String::new(), |cells| format!(" with noise {}", cells.target().noise()));
        self.bar.set_message(asked + &told(picture.noise(), before, written.rays.get()));
        let sent = self.live.filter(|_| due.sends).map(|live| live.send(&self.destination.to_string(), &picture));
        if let Some(Err(gone)) = sent.filter(|_| !self.quiet) {
            self.bar.suspend(|| console::say(format_args!("warning: {gone}")));
        }
        if due.shows { self.look.write(&picture, self.destination) } else { Ok(()) }
    }
}

/// What is told of a rendering beside its samples: noise, and rays a second since it was told before.
fn told(noise: Option<f64>, before: (Instant, u64), now: (Instant, u64)) -> String {
    let noise = noise.map_or(String::new(), |noise| format!(", noise {:.1} %", 100.0 * noise));
    let seconds = now.0.duration_since(before.0).as_secs_f64().max(1e-9);
    format!("{noise}, {:.0} Mrays/s", now.1.saturating_sub(before.1) as f64 / seconds / 1e6)
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
    fn noise_and_rays_a_second_are_told() {
        let start = Instant::now();
        let later = start + Duration::from_secs(2);
        assert_eq!(told(Some(0.0321), (start, 10), (later, 4_000_010)), ", noise 3.2 %, 2 Mrays/s");
        assert_eq!(told(None, (start, 0), (later, 6_000_000)), ", 3 Mrays/s");
    }

    #[test]
    fn long_renderings_show_what_they_have_unless_nobody_wants_that() {
        let (short, long) = (Duration::from_secs(20), Duration::from_secs(21));
        assert_eq!((interval(None, short), interval(None, long)), (None, Some(EVERY)));
        let second = Duration::from_secs(1);
        assert_eq!((interval(Some(second), short), interval(Some(second), long)), (Some(second), Some(second)));
        assert_eq!(interval(Some(Duration::ZERO), long), None);
    }
}
