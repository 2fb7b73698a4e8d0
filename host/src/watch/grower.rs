//! How many samples a film gets at a time, until it has all or somebody ends it.

use std::sync::atomic::Ordering;
use std::time::Instant;

use super::{Grows, Growth, Watch};
use crate::error::{Error, Result};
use crate::film::{Film, Part};
use crate::view::View;

/// Renders what a film has not yet of a view, until all is there, the time is up or somebody stops it.
///
/// # Errors
/// What the device reports, or a film of something else.
pub(crate) fn go_on(device: &mut dyn Grows, view: &View, from: Option<Film>, watch: &Watch<'_>) -> Result<Film> {
    let from = from.map(|film| prepared(film, view)).transpose()?;
    let missing = match &from {
        Some(film) => film.missing(view),
        None => vec![view.whole()],
    };
    let left = missing.iter().map(|part| part.volume()).sum();
    let mut grower = Grower { view, watch, film: from, left, start: Instant::now() };
    for part in missing {
        device.start(&view.part(part.region, part.samples.clone())?, &[part.region])?;
        let goes_on = grower.grow(device, part)?;
        grower.keep(device.end()?)?;
        if !goes_on {
            break;
        }
    }
    match grower.film {
        Some(film) => Ok(film),
        None => {
            device.start(view, &[view.region()])?;
            device.end()
        }
    }
}

/// A film as large as a view that goes on with it.
fn prepared(mut film: Film, view: &View) -> Result<Film> {
    film.widen(view.region())?;
    if film.window() != view.region() {
        return Err(Error::new("the film is of more than is rendered: render all that it shows, or name another film"));
    }
    Ok(film)
}

/// What a rendering has got, and what it has yet to get.
struct Grower<'a> {
    view: &'a View,
    watch: &'a Watch<'a>,
    /// Without the part under way.
    film: Option<Film>,
    /// Samples of all pixels that are missing.
    left: u64,
    start: Instant,
}

impl Grower<'_> {
    /// Adds samples until all of a part are there; false if it ends before that. Their number is chosen by what those before took.
    fn grow(&mut self, device: &mut dyn Grows, part: Part) -> Result<bool> {
        let Part { region, samples: all } = part;
        let (mut from, mut next) = (all.start, 1u32);
        while next > 0 {
            let before = Instant::now();
            device.add(Part { region, samples: from..from + next }, &|_| ())?;
            device.wait()?;
            from += next;
            self.left -= u64::from(next) * region.pixels();
            let each = (before.elapsed().as_secs_f64() / f64::from(next)).max(1e-9);
            self.tell(device);
            if self.watch.stop.load(Ordering::Relaxed) {
                return Ok(false);
            }
            let step = ((device.step().as_secs_f64() / each) as u32).max(1).min(next.saturating_mul(4));
            let left = match self.watch.limit {
                // Half of what should fit, since nobody knows what it takes; in the end one by one.
                Some(limit) => ((limit.saturating_sub(self.start.elapsed()).as_secs_f64() / each) as u32).div_ceil(2),
                None => u32::MAX,
            };
            next = step.min(left).min(all.end - from);
        }
        Ok(from == all.end)
    }

    fn tell(&self, device: &mut dyn Grows) {
        let (of, whole) = (self.view.samples(), self.view.whole());
        let samples = (whole.volume() - self.left) / whole.region.pixels();
        let mut film = || self.with(device.film()?);
        (self.watch.grown)(Growth { samples: samples as u32, of, cells: None, film: &mut film });
    }

    fn with(&self, part: Film) -> Result<Film> {
        match self.film.clone() {
            Some(mut film) => film.merge(part).map(|()| film),
            None => Ok(part),
        }
    }

    fn keep(&mut self, part: Film) -> Result<()> {
        match &mut self.film {
            Some(film) => film.merge(part)?,
            None => self.film = Some(part),
        }
        Ok(())
    }
}
