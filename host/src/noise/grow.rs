//! Renders cells until each has enough samples.

use std::collections::{BTreeMap, VecDeque};
use std::ops::Range;
use std::sync::atomic::Ordering;
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

use super::{CellSums, Lot, Target};
use crate::error::{Error, Result};
use crate::film::Film;
use crate::view::{Region, View};
use crate::watch::{Grows, Growth, Watch};

/// Cells that are rendered at first, before it is known how long they take.
const FIRST: usize = 16;
/// Renders what a film has not yet of a view until its noise is low enough, the time is up or somebody stops it.
///
/// # Errors
/// What the device reports, or a film of something else.
pub(crate) fn go_on(
    device: &mut dyn Grows,
    view: &View,
    target: &Target,
    from: Option<Film>,
    watch: &Watch<'_>,
) -> Result<Film> {
    let mut film = match from {
        Some(film) => prepared(film, view, target)?,
        None => Film::of_cells(view, target)?,
    };
    let mut open = Open::of(&film);
    let mut pace = Pace { start: Instant::now(), step: device.step(), rate: None, last: 0 };
    // The cells of one decide while the device has the others.
    let lots = device.lots_at_once() + 1;
    thread::scope(|scope| {
        let (ask, asked) = mpsc::channel();
        let (answer, answered) = mpsc::channel();
        // Ends when nobody asks any more.
        scope.spawn(move || render(device, view, &asked, &answer));
        let (mut under_way, mut ends) = (VecDeque::new(), false);
        let mut free = Instant::now();
        loop {
            while under_way.len() < lots && !ends {
                let wanted = |count| pace.cells(&film.next_samples(count), watch);
                let left = lots - under_way.len();
                let Some(lot) = open.take(left, wanted, |count| film.next_samples(count)) else { break };
                under_way.push_back((lot.cells.clone(), lot.samples.clone(), Instant::now()));
                // A device that failed takes no more, and what it failed with is answered.
                let _ = ask.send(lot);
            }
            let Some((cells, samples, asked)) = under_way.pop_front() else { return Ok(film) };
            let Done { sums, at } = answered.recv().expect("the device answers");
            film.add_cells(&cells, samples.clone(), &sums?)?;
            open.sort(&film, &cells);
            // It began when it was free of the lot before.
            pace.took(cells.len() * samples.len(), cells.len(), at - asked.max(free));
            free = at;
            tell(&film, &open, watch);
            let is_late = watch.limit.is_some_and(|limit| pace.start.elapsed() >= limit);
            ends |= is_late || watch.stop.load(Ordering::Relaxed);
        }
    })
}

/// What came of a lot, and when.
struct Done {
    sums: Result<CellSums>,
    at: Instant,
}

/// Renders lots as they are asked for, until none is any more.
fn render(device: &mut dyn Grows, view: &View, asked: &mpsc::Receiver<Lot>, answer: &mpsc::Sender<Done>) {
    let mut next = |waits: bool| if waits { asked.recv().ok() } else { asked.try_recv().ok() };
    device.lots(view, &mut next, &mut |sums| {
        // Nobody hears it who has gone.
        let _ = answer.send(Done { sums, at: Instant::now() });
    });
}

/// A film as large as a view that goes on with it.
fn prepared(mut film: Film, view: &View, target: &Target) -> Result<Film> {
    if film.cells().is_none_or(|cells| cells.target() != target) {
        return Err(Error::new("the film is of another noise: ask for the same, or name another film"));
    }
    film.extend_cells(view)?;
    film.widen(view.region())?;
    if film.window() != view.region() {
        return Err(Error::new("the film is of more than is rendered: render all that it shows, or name another film"));
    }
    Ok(film)
}

/// Cells that need more samples, by how many they have.
struct Open {
    by_count: BTreeMap<u32, Vec<Region>>,
    /// How many of them nobody renders now.
    waiting: usize,
    /// How many there are.
    cells: usize,
    /// With those that are done.
    of: usize,
}

impl Open {
    fn of(film: &Film) -> Open {
        let all: Vec<Region> = Target::cells(film.window()).collect();
        let mut open = Open { by_count: BTreeMap::new(), waiting: 0, cells: all.len(), of: all.len() };
        open.sort(film, &all);
        open
    }

    /// Keeps those of some cells that are not done, which nobody renders any more.
    fn sort(&mut self, film: &Film, cells: &[Region]) {
        let left = film.not_done(cells);
        self.waiting += left.len();
        self.cells -= cells.len() - left.len();
        for cell in left {
            self.by_count.entry(film.samples_of_cell(cell)).or_default().push(cell);
        }
    }

    /// Some of those that have the fewest samples, so that as many `lots` are left to take; `wanted` tells how many cells of so many samples
    /// are wanted, and `next` which samples they get.
    fn take(
        &mut self,
        lots: usize,
        wanted: impl FnOnce(u32) -> usize,
        next: impl FnOnce(u32) -> Range<u32>,
    ) -> Option<Lot> {
        let most = self.waiting.div_ceil(lots);
        let mut first = self.by_count.first_entry()?;
        let samples = *first.key();
        let cells = first.get_mut();
        let taken: Vec<Region> = cells.drain(..wanted(samples).min(most).clamp(1, cells.len())).collect();
        if cells.is_empty() {
            first.remove();
        }
        self.waiting -= taken.len();
        Some(Lot { cells: taken, samples: next(samples) })
    }
}

/// How fast a device is, so that it is given as much at once as takes a step.
struct Pace {
    start: Instant,
    /// How long a lot should take.
    step: Duration,
    /// Samples of cells a second.
    rate: Option<f64>,
    /// Cells that it was given last.
    last: usize,
}

impl Pace {
    /// How many cells it is given next.
    fn cells(&self, samples: &Range<u32>, watch: &Watch<'_>) -> usize {
        let Some(rate) = self.rate else { return FIRST };
        let left = watch.limit.map(|limit| limit.saturating_sub(self.start.elapsed()) / 2);
        let span = left.unwrap_or(Duration::MAX).min(self.step);
        ((rate * span.as_secs_f64() / samples.len().max(1) as f64) as usize).min(4 * self.last)
    }

    fn took(&mut self, samples: usize, cells: usize, time: Duration) {
        (self.rate, self.last) = (Some(samples as f64 / time.as_secs_f64().max(1e-9)), cells);
    }
}

fn tell(film: &Film, open: &Open, watch: &Watch<'_>) {
    let samples = (film.volume() / film.window().pixels()) as u32;
    let of = film.cells().map_or(0, |cells| cells.most());
    let mut copy = || Ok(film.clone());
    let cells = Some((open.of - open.cells, open.of));
    (watch.grown)(Growth { samples, of, cells, film: &mut copy });
}
