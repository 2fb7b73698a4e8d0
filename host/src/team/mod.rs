//! Several devices at one film: each takes samples of some strip of the image as soon as it is done with those before. Sums have no
//! order, so the film has the bits of any one device.

mod cells;
mod work;

#[cfg(test)]
mod tests;

use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use self::work::{Pace, Work};
use crate::error::{Error, Result};
use crate::film::{Coverage, Film, Part};
use crate::job::Job;
use crate::noise::CellSums;
use crate::view::{Region, View};
use crate::watch::Grows;

/// Strips of the image a device, so that a slow one can take little.
const STRIPS: u32 = 12;
/// Strips are whole blocks of pixels high.
const ROWS: u32 = 8;

/// A device of several that failed, by its name.
pub type Lost = (String, Error);

/// A device of several.
pub(crate) struct Member {
    name: String,
    device: Box<dyn Grows>,
    has: Coverage,
    is_lost: bool,
    /// Samples of a pixel a second, once that is known.
    rate: Option<f64>,
    /// The same for samples of cells.
    cell_rate: Option<f64>,
}

impl Member {
    /// A device that is ready, by its name.
    pub fn new(name: String, device: impl Grows + 'static) -> Self {
        Member { name, device: Box::new(device), has: Coverage::default(), is_lost: false, rate: None, cell_rate: None }
    }
}

/// Devices that share their work.
pub(crate) struct Team {
    members: Vec<Member>,
    view: Option<View>,
    coverage: Coverage,
    /// Strips of the image that each device may take apart.
    strips: u32,
    /// Of all renderings.
    lost: Vec<Lost>,
}

impl Team {
    /// Of devices that are ready.
    pub fn new(members: Vec<Member>) -> Self {
        let strips = STRIPS * members.len() as u32;
        Team { members, view: None, coverage: Coverage::default(), strips, lost: Vec::new() }
    }

    /// Shares samples of the whole image alone, since each part of a sample takes as long to get its photons ready as all of it.
    #[must_use]
    pub fn of_whole_samples(self) -> Self {
        Team { strips: 1, ..self }
    }

    /// Fails with the last fault if every device is lost.
    fn check(&mut self) -> Result<()> {
        if self.members.iter().any(|member| !member.is_lost) {
            return Ok(());
        }
        let fault = self.lost.pop().map(|(_, error)| error);
        Err(fault.unwrap_or_else(|| Error::new("every device has failed: render on another")))
    }

    /// Lets every member begin something, with no sample yet. Fails if all are lost.
    fn begin(&mut self, mut begin: impl FnMut(&mut dyn Grows) -> Result<()>) -> Result<()> {
        for member in self.members.iter_mut().filter(|member| !member.is_lost) {
            member.has = Coverage::default();
            if let Err(error) = begin(member.device.as_mut()) {
                member.is_lost = true;
                self.lost.push((member.name.clone(), error));
            }
        }
        self.check()
    }

    /// Lets every member work until all is done. Fails if all are lost.
    fn share(&mut self, todo: Vec<Part>) -> Result<()> {
        let pace = |member: &Member| Pace { is_lost: member.is_lost, is_done: false, rate: member.rate };
        let members = self.members.iter().map(pace).collect();
        let work = Mutex::new(Work { todo, members, faults: Vec::new() });
        while !locked(&work).todo.is_empty() {
            thread::scope(|scope| {
                for (number, member) in self.members.iter_mut().enumerate().filter(|(_, member)| !member.is_lost) {
                    let work = &work;
                    scope.spawn(move || member.run(number, work));
                }
            });
            let mut work = locked(&work);
            // Whoever left the rest to a member that failed is needed again.
            work.members.iter_mut().for_each(|pace| pace.is_done = false);
            let faults = std::mem::take(&mut work.faults);
            drop(work);
            self.lost.extend(faults);
            self.check()?;
        }
        Ok(())
    }
}

impl Grows for Team {
    fn turn(&mut self, job: &Job) -> Result<()> {
        // The film goes with all that any of them had.
        (self.view, self.coverage) = (None, Coverage::default());
        self.begin(|device| device.turn(job))
    }

    fn start(&mut self, view: &View, _: &[Region]) -> Result<()> {
        let strips = strips(view.region(), self.strips);
        self.begin(|device| device.start(view, &strips))?;
        (self.view, self.coverage) = (Some(*view), Coverage::default());
        Ok(())
    }

    fn add(&mut self, part: Part, done: &(dyn Fn(u64) + Sync)) -> Result<()> {
        let todo = strips(part.region, self.strips);
        let todo = todo.into_iter().map(|region| Part { region, samples: part.samples.clone() }).collect();
        self.share(todo)?;
        let (pixels, samples) = (part.region.pixels(), part.samples.len() as u64);
        self.coverage.add(part).map_err(Part::twice)?;
        let all = self.view.as_ref().map_or(1, View::samples);
        done(pixels * samples / u64::from(all));
        Ok(())
    }

    fn wait(&mut self) -> Result<()> {
        Ok(())
    }

    fn cells(&mut self, view: &View, cells: &[Region], samples: Range<u32>) -> Result<CellSums> {
        self.share_cells(view, cells, samples)
    }

    fn lost(&mut self) -> Vec<Lost> {
        std::mem::take(&mut self.lost)
    }

    /// Devices wait for each other at the end of each step.
    fn step(&self) -> Duration {
        Duration::from_secs(2)
    }

    fn film(&mut self) -> Result<Film> {
        loop {
            let mut redo = Vec::new();
            let mut films = Vec::new();
            for member in self.members.iter_mut().filter(|member| !member.is_lost) {
                match member.device.film() {
                    Ok(film) => films.push(film),
                    Err(error) => {
                        member.is_lost = true;
                        redo.extend_from_slice(member.has.parts());
                        self.lost.push((member.name.clone(), error));
                    }
                }
            }
            self.check()?;
            if !redo.is_empty() {
                // What went with it is done by the others, and then read with the rest.
                self.share(redo)?;
                continue;
            }
            let mut films = films.into_iter();
            let mut film = films.next().expect("some device is left");
            films.try_for_each(|other| film.absorb(&other))?;
            film.set_coverage(self.coverage.clone());
            return Ok(film);
        }
    }
}

impl Member {
    /// Works until there is nothing left for it, or it fails: then all that it had is to be done again.
    fn run(&mut self, number: usize, work: &Mutex<Work>) {
        loop {
            let Some(part) = locked(work).take(number) else { return };
            let before = Instant::now();
            let added = self.device.add(part.clone(), &|_| ()).and_then(|()| self.device.wait());
            let mut work = locked(work);
            if let Err(error) = added {
                self.is_lost = true;
                work.members[number].is_lost = true;
                work.todo.push(part);
                work.todo.extend_from_slice(self.has.parts());
                work.faults.push((self.name.clone(), error));
                return;
            }
            self.rate = Some(part.volume() as f64 / before.elapsed().as_secs_f64().max(1e-9));
            work.members[number].rate = self.rate;
            self.has.add(part).expect("nothing is done twice");
        }
    }
}

fn locked<T>(work: &Mutex<T>) -> MutexGuard<'_, T> {
    work.lock().unwrap_or_else(PoisonError::into_inner)
}

/// About so many strips of whole rows.
fn strips(region: Region, count: u32) -> Vec<Region> {
    let rows = region.height.div_ceil(count.max(1)).next_multiple_of(ROWS);
    region.pieces(region.width, rows).collect()
}
