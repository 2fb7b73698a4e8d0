//! Which samples of which pixels a film has.

use std::fmt;
use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::error::Error;
use crate::view::Region;

/// Samples of every pixel of a region: what a film is made of.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Part {
    /// Where in the image.
    pub region: Region,
    /// Which of each pixel's samples.
    pub samples: Range<u32>,
}

impl Part {
    /// How many samples of how many pixels that is, multiplied.
    pub fn volume(&self) -> u64 {
        self.region.pixels() * self.samples.len() as u64
    }

    /// What is wrong with adding what a film has.
    pub(crate) fn twice(self) -> Error {
        Error::new(format!("the film has {self} already"))
    }

    /// Columns, rows and samples.
    fn axes(&self) -> [Range<u32>; 3] {
        let Region { x, y, width, height } = self.region;
        // What a file says may be anything.
        [x..x.saturating_add(width), y..y.saturating_add(height), self.samples.clone()]
    }

    fn of([columns, rows, samples]: [Range<u32>; 3]) -> Part {
        let (width, height) = (columns.end - columns.start, rows.end - rows.start);
        Part { region: Region { x: columns.start, y: rows.start, width, height }, samples }
    }

    /// What both have.
    pub fn both(&self, other: &Part) -> Option<Part> {
        let (a, b) = (self.axes(), other.axes());
        let both = [0, 1, 2].map(|axis| a[axis].start.max(b[axis].start)..a[axis].end.min(b[axis].end));
        both.iter().all(|range| !range.is_empty()).then(|| Part::of(both))
    }

    /// What this has and another has not, in parts.
    fn without(&self, other: &Part) -> Vec<Part> {
        let Some(both) = self.both(other) else { return vec![self.clone()] };
        let (both, mut rest, mut parts) = (both.axes(), self.axes(), Vec::new());
        // Samples first: who goes on with whole pictures gets whole pictures.
        for axis in [2, 1, 0] {
            for range in [rest[axis].start..both[axis].start, both[axis].end..rest[axis].end] {
                if !range.is_empty() {
                    let mut part = rest.clone();
                    part[axis] = range;
                    parts.push(Part::of(part));
                }
            }
            rest[axis] = both[axis].clone();
        }
        parts
    }

    /// Both together, if that is a part.
    fn joined(&self, other: &Part) -> Option<Part> {
        let (a, b) = (self.axes(), other.axes());
        let differing: Vec<usize> = (0..3).filter(|&axis| a[axis] != b[axis]).collect();
        let &[axis] = &differing[..] else { return None };
        let touch = a[axis].end == b[axis].start || b[axis].end == a[axis].start;
        touch.then(|| self.around(other))
    }

    /// The least part that holds both.
    fn around(&self, other: &Part) -> Part {
        let (a, b) = (self.axes(), other.axes());
        Part::of([0, 1, 2].map(|axis| a[axis].start.min(b[axis].start)..a[axis].end.max(b[axis].end)))
    }
}

impl fmt::Display for Part {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Region { x, y, width, height }, Range { start, end }) = (self.region, &self.samples);
        write!(out, "samples {start} to {end} of the {width}x{height} pixels at {x},{y}")
    }
}

/// Parts of which no two have a sample of a pixel in common.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Coverage(Vec<Part>);

impl Coverage {
    /// The parts.
    pub fn parts(&self) -> &[Part] {
        &self.0
    }

    /// Samples of all pixels together.
    pub fn volume(&self) -> u64 {
        self.0.iter().map(Part::volume).sum()
    }

    /// Adds a part.
    ///
    /// # Errors
    /// What of it is there already.
    pub fn add(&mut self, part: Part) -> Result<(), Part> {
        if part.volume() == 0 {
            return Ok(());
        }
        if let Some(both) = self.0.iter().find_map(|own| own.both(&part)) {
            return Err(both);
        }
        let mut part = part;
        while let Some((i, joined)) = self.0.iter().enumerate().find_map(|(i, own)| Some((i, own.joined(&part)?))) {
            self.0.swap_remove(i);
            part = joined;
        }
        self.0.push(part);
        self.close();
        Ok(())
    }

    /// One part where all together are one, however they lie.
    fn close(&mut self) {
        let around = self.0.iter().cloned().reduce(|a, b| a.around(&b));
        if let Some(whole) = around
            && self.volume() == whole.volume()
        {
            self.0 = vec![whole];
        }
    }

    /// What of a part is not there.
    pub fn missing(&self, of: &Part) -> Vec<Part> {
        let all = if of.volume() == 0 { Vec::new() } else { vec![of.clone()] };
        self.0.iter().fold(all, |rest, own| rest.iter().flat_map(|part| part.without(own)).collect())
    }

    /// How many samples each pixel has of a row, from column `x` on.
    pub fn counts(&self, y: u32, x: u32, width: u32) -> Vec<u32> {
        let mut counts = vec![0; width as usize];
        let row = Part { region: Region { x, y, width, height: 1 }, samples: 0..u32::MAX };
        for both in self.0.iter().filter_map(|part| part.both(&row)) {
            let first = (both.region.x - x) as usize;
            for count in &mut counts[first..first + both.region.width as usize] {
                *count += both.samples.len() as u32;
            }
        }
        counts
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const WHOLE: (u32, u32, u32) = (6, 5, 8);

    fn part() -> impl Strategy<Value = Part> {
        let range = |size: u32| (0..size, 1..=size).prop_map(move |(start, length)| start..(start + length).min(size));
        (range(WHOLE.0), range(WHOLE.1), range(WHOLE.2)).prop_map(|(x, y, samples)| Part::of([x, y, samples]))
    }

    /// Every sample of every pixel of a part.
    fn cells(part: &Part) -> impl Iterator<Item = [u32; 3]> + use<> {
        let [x, y, samples] = part.axes();
        x.flat_map(move |x| {
            let samples = samples.clone();
            y.clone().flat_map(move |y| samples.clone().map(move |sample| [x, y, sample]))
        })
    }

    fn has(parts: &[Part], cell: [u32; 3]) -> usize {
        parts.iter().filter(|part| cells(part).any(|own| own == cell)).count()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]

        /// Cell by cell: what is added is there, what overlaps is refused and changes nothing, and the rest is missing.
        #[test]
        fn a_coverage_has_what_was_added_and_misses_the_rest(parts in prop::collection::vec(part(), 1..12)) {
            let (mut coverage, mut want) = (Coverage::default(), std::collections::HashSet::new());
            for part in parts {
                let before = coverage.clone();
                match coverage.add(part.clone()) {
                    Ok(()) => cells(&part).for_each(|cell| assert!(want.insert(cell))),
                    Err(both) => {
                        prop_assert!(cells(&both).all(|cell| want.contains(&cell) && has(std::slice::from_ref(&part), cell) == 1));
                        prop_assert_eq!(&coverage, &before);
                    }
                }
            }
            let whole = Part::of([0..WHOLE.0, 0..WHOLE.1, 0..WHOLE.2]);
            let missing = coverage.missing(&whole);
            for cell in cells(&whole) {
                let is_there = usize::from(want.contains(&cell));
                prop_assert_eq!((has(coverage.parts(), cell), has(&missing, cell)), (is_there, 1 - is_there));
            }
            for y in 0..WHOLE.1 {
                let counts = coverage.counts(y, 0, WHOLE.0);
                let of = |x| want.iter().filter(|cell| (cell[0], cell[1]) == (x, y)).count() as u32;
                prop_assert_eq!(counts, (0..WHOLE.0).map(of).collect::<Vec<_>>());
            }
        }
    }

    /// Four parts around a fifth, of which no two are one.
    #[test]
    fn parts_that_fill_a_whole_are_the_whole_however_they_lie() {
        let at = |x: Range<u32>, y: Range<u32>| Part::of([x, y, 3..7]);
        let mut coverage = Coverage::default();
        for part in [at(0..2, 0..1), at(2..3, 0..2), at(1..3, 2..3), at(0..1, 1..3), at(1..2, 1..2)] {
            coverage.add(part).unwrap();
        }
        assert_eq!(coverage.parts(), [at(0..3, 0..3)]);
    }
}
