//! Pixel filters: a pixel is the mean of what is around its middle, weighted by a filter. Samples are placed as often as the filter weighs
//! (Ernst, Stamminger and Greiner, Filter Importance Sampling, 2006), so that each counts as much and belongs to one pixel alone.

use crate::buffer::read;
use crate::data::Frame;

/// Steps of the table of a filter: of equal weight, each as wide as the numbers at its ends are apart.
pub const FILTER_STEPS: u32 = 1024;

/// Where a filter has a place in a pixel, which is given in halves of a cell from the pixel's edge, as the result is. `optics` begins with
/// the inverse of the filter's cumulative distribution: pixels from the middle.
#[inline(always)]
pub fn moved(frame: &Frame, optics: &[u32], from_edge: f32) -> f32 {
    let at = from_edge * frame.filter_steps;
    let step = at as u32;
    let step = if step < FILTER_STEPS { step } else { FILTER_STEPS - 1 };
    let number = |i: u32| f32::from_bits(read(optics, i));
    let (low, high) = (number(step), number(step + 1));
    let from_middle = low + (high - low) * (at - step as f32);
    let samples = if frame.samples == 0 { 1.0 } else { frame.samples as f32 };
    samples + from_middle * (2.0 * samples)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box's table is a straight line, a tent's half distances are roots.
    #[test]
    fn a_table_moves_places_as_it_says() {
        let table = |of: &dyn Fn(f64) -> f64| -> Vec<u32> {
            (0..=FILTER_STEPS).map(|i| (of(f64::from(i) / f64::from(FILTER_STEPS)) as f32).to_bits()).collect()
        };
        let plain = table(&|share| share - 0.5);
        let tent =
            table(&|share| if share < 0.5 { (2.0 * share).sqrt() - 1.0 } else { 1.0 - (2.0 - 2.0 * share).sqrt() });
        for samples in [1u32, 2, 3, 64] {
            let filter_steps = FILTER_STEPS as f32 / (2 * samples) as f32;
            let frame = Frame { samples, filter_steps, ..Frame::default() };
            let edge = 2.0 * samples as f32;
            for place in (0..200).map(|i| edge * i as f32 / 200.0).chain([edge.next_down()]) {
                assert!((moved(&frame, &plain, place) - place).abs() <= edge * 1e-6, "{place} of {edge}");
            }
            let [first, middle, last] =
                [0.0, edge / 2.0, edge.next_down()].map(|place| moved(&frame, &tent, place) / edge);
            assert!((first + 0.5).abs() < 1e-6 && (middle - 0.5).abs() < 1e-6 && (last - 1.5).abs() < 1e-4);
        }
    }
}
