//! Cells of a picture that ends by its noise, shared among devices: each takes some as soon as it is done with those before.

use std::ops::Range;
use std::sync::Mutex;
use std::thread;
use std::time::Instant;

use super::{Lost, Member, Team, locked};
use crate::error::Result;
use crate::noise::CellSums;
use crate::view::{Region, View};

/// How long a device should take for what it takes at once, in seconds.
const SPAN: f64 = 0.3;

/// Samples of cells that a call asks for.
struct Asked<'a> {
    view: &'a View,
    cells: &'a [Region],
    samples: Range<u32>,
    work: Mutex<Work>,
}

/// What is to be done of it, and what is done.
struct Work {
    /// Places of cells.
    todo: Vec<usize>,
    sums: Vec<Vec<u32>>,
    secondary: u64,
    /// Samples of cells a second of each member that is at work, once that is known.
    rates: Vec<Option<f64>>,
    faults: Vec<Lost>,
}

impl Work {
    /// Places of as many cells as suit a member; none if others, who are faster, are done sooner without it.
    fn take(&mut self, number: usize, samples: usize) -> Vec<usize> {
        let (left, own) = (self.todo.len() as f64, self.rates[number]);
        let all: f64 = self.rates.iter().flatten().sum();
        let faster = |&(other, rate): &(usize, &Option<f64>)| {
            let [own, rate] = [own, *rate].map(|rate| rate.unwrap_or(0.0));
            rate > own || rate == own && other < number
        };
        let others: f64 = self.rates.iter().enumerate().filter(faster).filter_map(|(_, rate)| *rate).sum();
        let count = match own {
            None => 1.0,
            Some(rate) if others > 0.0 && 1.0 / rate > left / others => 0.0,
            // Less towards the end, so that all end together.
            Some(rate) => (rate * SPAN / samples as f64).min(left * rate / (2.0 * all)).max(1.0),
        };
        let from = self.todo.len().saturating_sub(count as usize);
        self.todo.split_off(from)
    }
}

impl Team {
    /// Lets every member work until all is done. Fails if all are lost.
    pub(super) fn share_cells(&mut self, view: &View, cells: &[Region], samples: Range<u32>) -> Result<CellSums> {
        let work = Work {
            todo: (0..cells.len()).collect(),
            sums: vec![Vec::new(); cells.len()],
            secondary: 0,
            rates: vec![None; self.members.len()],
            faults: Vec::new(),
        };
        let asked = Asked { view, cells, samples, work: Mutex::new(work) };
        while !locked(&asked.work).todo.is_empty() {
            // Whoever left the rest to a member that failed is needed again.
            locked(&asked.work).rates =
                self.members.iter().map(|member| member.cell_rate.filter(|_| !member.is_lost)).collect();
            thread::scope(|scope| {
                for (number, member) in self.members.iter_mut().enumerate().filter(|(_, member)| !member.is_lost) {
                    let asked = &asked;
                    scope.spawn(move || member.run_cells(number, asked));
                }
            });
            let faults = std::mem::take(&mut locked(&asked.work).faults);
            self.lost.extend(faults);
            self.check()?;
        }
        let Work { sums, secondary, .. } = asked.work.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        Ok(CellSums { sums, secondary })
    }
}

impl Member {
    /// Works until there is nothing left for it, or it fails: then others do what it was about.
    fn run_cells(&mut self, number: usize, asked: &Asked<'_>) {
        loop {
            let places = locked(&asked.work).take(number, asked.samples.len());
            if places.is_empty() {
                // It counts no longer for those who ask whether others are faster.
                locked(&asked.work).rates[number] = None;
                return;
            }
            let (cells, before): (Vec<Region>, _) =
                (places.iter().map(|&place| asked.cells[place]).collect(), Instant::now());
            let done = self.device.cells(asked.view, &cells, asked.samples.clone());
            let mut work = locked(&asked.work);
            match done {
                Ok(CellSums { sums, secondary }) => {
                    let samples = (cells.len() * asked.samples.len()) as f64;
                    self.cell_rate = Some(samples / before.elapsed().as_secs_f64().max(1e-9));
                    work.rates[number] = self.cell_rate;
                    work.secondary += secondary;
                    places.into_iter().zip(sums).for_each(|(place, sums)| work.sums[place] = sums);
                }
                Err(error) => {
                    self.is_lost = true;
                    work.rates[number] = None;
                    work.todo.extend(places);
                    work.faults.push((self.name.clone(), error));
                    return;
                }
            }
        }
    }
}
