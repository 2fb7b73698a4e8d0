//! A logarithmic axis of a plot.

use std::ops::Range;

use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};

use eyerays::math;

/// The fewest marks that make an axis readable.
const FEWEST: usize = 4;

/// What an axis spans, above 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Scale(Range<f64>);

impl Scale {
    /// From the least to the greatest of some numbers, and some room; none if they are not above 0.
    pub fn of(numbers: impl Iterator<Item = f64>) -> Option<Scale> {
        let (least, greatest) = numbers.fold((f64::INFINITY, 0f64), |(a, b), x| (a.min(x), b.max(x)));
        (least > 0.0 && greatest.is_finite() && greatest > 0.0).then(|| Scale(least / 1.3..greatest * 1.3))
    }

    /// The same down to another start.
    pub fn down_to(self, start: f64) -> Scale {
        Scale(start..self.0.end)
    }

    /// The least number.
    pub fn start(&self) -> f64 {
        self.0.start
    }

    /// The greatest number.
    pub fn end(&self) -> f64 {
        self.0.end
    }

    /// Is the number on it?
    pub fn holds(&self, x: f64) -> bool {
        self.0.contains(&x)
    }

    /// Where a number lies: 0 at the start, 1 at the end.
    pub fn along(&self, x: f64) -> f64 {
        math::ln(x / self.0.start) / math::ln(self.0.end / self.0.start)
    }

    /// Powers of ten where there are enough of them, else also their doubles and fivefolds, or more still.
    pub fn marks(&self) -> Vec<f64> {
        let steps = [&[1.0][..], &[1.0, 2.0, 5.0], &[1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0]];
        let all = steps.map(|steps| self.multiples(steps));
        all.iter().find(|marks| marks.len() >= FEWEST).unwrap_or(&all[2]).clone()
    }

    fn multiples(&self, steps: &[f64]) -> Vec<f64> {
        let decades = math::log10(self.0.start).floor() as i32..=math::log10(self.0.end).ceil() as i32;
        let all = decades.flat_map(|decade| steps.iter().map(move |step| step * math::pow(10.0, decade.into())));
        all.filter(|&mark| self.holds(mark)).collect()
    }
}

impl Ranged for Scale {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (first, last): (i32, i32)) -> i32 {
        first + (self.along(*value) * f64::from(last - first)).round() as i32
    }

    fn key_points<H: KeyPointHint>(&self, _: H) -> Vec<f64> {
        self.marks()
    }

    fn range(&self) -> Range<f64> {
        self.0.clone()
    }
}
