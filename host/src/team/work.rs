//! What several devices have to do, and who takes how much of it.

use super::Lost;
use crate::film::Part;

/// How long a device should take for what it takes at once, in seconds.
const BLOCK: f64 = 0.3;

/// What is to be done, for whoever comes next.
pub(super) struct Work {
    /// Parts of a strip each.
    pub todo: Vec<Part>,
    pub members: Vec<Pace>,
    pub faults: Vec<Lost>,
}

/// How fast a member is.
#[derive(Clone, Copy)]
pub(super) struct Pace {
    pub is_lost: bool,
    /// Does it leave the rest to others?
    pub is_done: bool,
    /// Samples of a pixel a second, once that is known.
    pub rate: Option<f64>,
}

impl Pace {
    /// Is it faster than another member? Of two that are alike the first is.
    fn is_faster(&self, number: usize, other: Pace, other_number: usize) -> bool {
        let [own, other] = [self.rate, other.rate].map(|rate| rate.unwrap_or(0.0));
        own > other || own == other && number < other_number
    }
}

impl Work {
    /// Some samples of the strip that has most left, as many as suit the member; none if the others are done sooner without it.
    pub fn take(&mut self, number: usize) -> Option<Part> {
        let left: u64 = self.todo.iter().map(Part::volume).sum();
        let (at, strip) = self.todo.iter().enumerate().max_by_key(|(_, part)| part.samples.len())?;
        let (pixels, all) = (strip.region.pixels() as f64, strip.samples.len() as f64);
        let own = self.members[number];
        let all_rates: f64 = self.members.iter().filter(|pace| !pace.is_lost).filter_map(|pace| pace.rate).sum();
        // Only those count that stay: the fastest always does, so that some member does the rest.
        let stays =
            |&(other, pace): &(usize, &Pace)| !pace.is_lost && !pace.is_done && pace.is_faster(other, own, number);
        let others: f64 = self.members.iter().enumerate().filter(stays).filter_map(|(_, pace)| pace.rate).sum();
        let samples = match own.rate {
            None => 1.0,
            Some(rate) if others > 0.0 && pixels / rate > left as f64 / others => {
                self.members[number].is_done = true;
                return None;
            }
            // Less towards the end, and half of its share at most, so that all end together.
            Some(rate) => (rate * BLOCK).min(left as f64 * rate / (2.0 * all_rates.max(rate))) / pixels,
        };
        let taken = samples.clamp(1.0, all) as u32;
        let part = &mut self.todo[at];
        let (region, start) = (part.region, part.samples.start);
        part.samples.start += taken;
        if part.samples.is_empty() {
            self.todo.swap_remove(at);
        }
        Some(Part { region, samples: start..start + taken })
    }
}
