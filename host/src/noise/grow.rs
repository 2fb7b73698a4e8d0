//! Renders cells until each has enough samples.

use std::collections::BTreeMap;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use super::Target;
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
    let mut pace = Pace { start: Instant::now(), rate: None, last: 0 };
    while let Some((count, cells)) = open.take(|cells_of| pace.cells(&film.next_samples(cells_of), device, watch)) {
        let (samples, before) = (film.next_samples(count), Instant::now());
        let sums = device.cells(view, &cells, samples.clone())?;
        film.add_cells(&cells, samples.clone(), &sums)?;
        open.sort(&film, &cells);
        pace.took(cells.len() * samples.len(), cells.len(), before.elapsed());
        tell(&film, &open, watch);
        let is_late = watch.limit.is_some_and(|limit| pace.start.elapsed() >= limit);
        if is_late || watch.stop.load(Ordering::Relaxed) {
            break;
        }
    }
    Ok(film)
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
    cells: usize,
    of: usize,
}

impl Open {
    fn of(film: &Film) -> Open {
        let all: Vec<Region> = Target::cells(film.window()).collect();
        let mut open = Open { by_count: BTreeMap::new(), cells: 0, of: all.len() };
        open.sort(film, &all);
        open
    }

    /// Keeps those of some cells that are not done.
    fn sort(&mut self, film: &Film, cells: &[Region]) {
        let left = film.not_done(cells);
        self.cells += left.len();
        for cell in left {
            self.by_count.entry(film.samples_of_cell(cell)).or_default().push(cell);
        }
    }

    /// Some of those that have the fewest samples, and how many these are; `count` tells how many cells of so many samples are wanted.
    fn take(&mut self, count: impl FnOnce(u32) -> usize) -> Option<(u32, Vec<Region>)> {
        let mut first = self.by_count.first_entry()?;
        let samples = *first.key();
        let cells = first.get_mut();
        let taken: Vec<Region> = cells.drain(..count(samples).clamp(1, cells.len())).collect();
        if cells.is_empty() {
            first.remove();
        }
        self.cells -= taken.len();
        Some((samples, taken))
    }
}

/// How fast a device is, so that it is given as much at once as takes a step.
struct Pace {
    start: Instant,
    /// Samples of cells a second.
    rate: Option<f64>,
    /// Cells that it was given last.
    last: usize,
}

impl Pace {
    /// How many cells it is given next.
    fn cells(&self, samples: &std::ops::Range<u32>, device: &dyn Grows, watch: &Watch<'_>) -> usize {
        let Some(rate) = self.rate else { return FIRST };
        let left = watch.limit.map(|limit| limit.saturating_sub(self.start.elapsed()) / 2);
        let span = left.unwrap_or(Duration::MAX).min(device.step());
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
