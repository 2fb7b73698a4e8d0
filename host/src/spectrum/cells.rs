//! The wavelengths that samples draw.

use std::sync::OnceLock;

use eyerays_shader::data::SpectrumRow;
use glam::{DMat3, DVec3};

use super::observer::{D65, FIRST, LAST, MATCHING, at};
use super::primaries::PRIMARIES;
use crate::image::from_xyz;

/// Sets of three wavelengths.
pub const SETS: usize = SpectrumRow::SETS as usize;
/// Steps of the integrals over wavelengths, in nanometres.
const STEP: f64 = 0.25;

/// A range of wavelengths, of which each is as likely to be drawn.
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    /// The middle, in nanometres.
    pub wavelength: f64,
    /// What light of these wavelengths that is as bright as D65 adds to red, green and blue, where all cells together add 1.
    pub response: DVec3,
}

/// All cells, by their wavelengths; set `s` is those of the numbers `s`, `s + SETS` and `s + 2 SETS`.
pub fn cells() -> &'static [Cell] {
    static CELLS: OnceLock<Vec<Cell>> = OnceLock::new();
    CELLS.get_or_init(|| {
        let mut cells = divided();
        // So that red, green and blue of any colour are what they were, however wide cells are.
        let seen: DMat3 =
            cells.iter().map(|cell| outer(cell.response, DVec3::from(at(&PRIMARIES, cell.wavelength)))).sum();
        let back = seen.inverse();
        for cell in &mut cells {
            cell.response = back * cell.response;
        }
        cells
    })
}

/// The matrix of the products of two vectors' numbers.
fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// Linear RGB that light at a wavelength has which is as bright as D65, up to a factor.
fn response(wavelength: f64) -> DVec3 {
    let power = at(&D65, wavelength)[0];
    DVec3::from(from_xyz(at(&MATCHING, wavelength).map(|matched| matched * power)))
}

/// Cells between which all is as likely, by the sum of the magnitudes of what they add; and a little anywhere.
fn divided() -> Vec<Cell> {
    let count = ((LAST - FIRST) / STEP) as usize;
    let middle = |step: usize| FIRST + (step as f64 + 0.5) * STEP;
    let responses: Vec<DVec3> = (0..count).map(|step| response(middle(step))).collect();
    let likely = |response: &DVec3| response.abs().element_sum();
    let some = 0.02 * responses.iter().map(likely).sum::<f64>() / count as f64;
    let whole: f64 = responses.iter().map(|response| likely(response) + some).sum();
    let share = whole / (3 * SETS) as f64;
    let (mut cells, mut step, mut used) = (Vec::with_capacity(3 * SETS), 0, 0.0);
    for _ in 0..3 * SETS {
        let (start, mut sum, mut left) = (middle(step) + (used - 0.5) * STEP, DVec3::ZERO, share);
        // The steps that it takes whole, and a part of the one after.
        while step + 1 < count && (likely(&responses[step]) + some) * (1.0 - used) <= left {
            left -= (likely(&responses[step]) + some) * (1.0 - used);
            sum += responses[step] * (1.0 - used);
            (step, used) = (step + 1, 0.0);
        }
        let part = (left / (likely(&responses[step]) + some)).min(1.0 - used);
        sum += responses[step] * part;
        used += part;
        let end = middle(step) + (used - 0.5) * STEP;
        cells.push(Cell { wavelength: 0.5 * (start + end), response: sum });
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_follow_each_other_over_all_wavelengths() {
        let cells = cells();
        assert_eq!(cells.len(), 3 * SETS);
        assert!(cells.windows(2).all(|two| two[0].wavelength < two[1].wavelength));
        assert!(cells[0].wavelength < 385.0 && cells[3 * SETS - 1].wavelength > 770.0);
    }

    #[test]
    fn no_cell_adds_many_times_more_than_another_of_its_colour() {
        let most = cells().iter().map(|cell| cell.response.abs().max_element() * (3 * SETS) as f64).fold(0.0, f64::max);
        assert!(most < 4.5, "{most}");
    }
}
