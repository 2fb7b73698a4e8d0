//! The strands of a file, before it is known what curves they are.

use std::borrow::Cow;
use std::path::Path;

use crate::error::{Error, Result};
use crate::scene::Unplaced;
use crate::scene::curves::{Basis, ControlPoint, Strand, Strands};
use crate::scene_io::budget::Budget;
use crate::scene_io::tally::Tally;
use crate::scene_io::{Warning, WarningKind};

/// What becomes of strands that make no sense.
pub const LEFT_OUT: &str = "left out";
/// What becomes of a file of no others.
pub const NONE_LEFT: &str = "left out, and no strand is left";
/// What a control point and its strand take of memory, in bytes, in lists that double as they grow.
const POINT: u64 = 2 * (size_of::<ControlPoint>() + size_of::<[f32; 4]>() + 2 * size_of::<usize>()) as u64;

/// Strands as a file has them.
#[derive(Debug, Clone, PartialEq)]
pub struct Listed {
    pub strands: Strands,
    /// The line of the file where each begins, or its number, counted from 1.
    pub places: Vec<usize>,
    /// Are these lines?
    pub has_lines: bool,
    /// What was left out when it was read.
    pub warning: Option<Warning>,
}

impl Listed {
    /// The strands that can be drawn as curves of a kind, and a warning of the others.
    ///
    /// # Errors
    /// There is none.
    pub fn sound(&self, path: &Path, basis: Basis) -> Result<(Cow<'_, Strands>, Option<Warning>)> {
        let mut tally = Tally::default();
        for (strand, &place) in self.strands.iter().zip(&self.places) {
            if let Some(fault) = strand.fault(basis) {
                let what = if self.has_lines { "strand " } else { "" };
                tally.add(place, format!("{what}(it {fault})"));
            }
        }
        let Some(fault) = tally.fault(path, LEFT_OUT) else { return Ok((Cow::Borrowed(&self.strands), None)) };
        let is_sound = |strand: &Strand| strand.fault(basis).is_none();
        let mut sound = Strands::default();
        self.strands.iter().filter(is_sound).for_each(|strand| sound.push(strand));
        if sound.is_empty() {
            let fault = tally.fault(path, NONE_LEFT).unwrap_or(fault);
            return Err(self.placed(fault));
        }
        Ok((Cow::Owned(sound), Some(Warning::of(WarningKind::LeftOut, &self.placed(fault)))))
    }

    /// A fault by the number of the strand, where that is known and no line.
    fn placed(&self, fault: Error) -> Error {
        match fault.place() {
            Some((path, Some(number))) if !self.has_lines => {
                Error::file(path, format!("strand number {number} {}", fault.message()))
            }
            _ => fault,
        }
    }
}

/// Refuses so many points, before there is room for them.
///
/// # Errors
/// What they would take of what there is.
pub fn check_room(points: u64, budget: Budget) -> Unplaced<()> {
    let fits = budget.check_bytes(points.saturating_mul(POINT));
    fits.map_err(|why| format!("its {points} control points {why}; split the file"))
}
