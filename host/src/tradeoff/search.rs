//! Which settings are tried: first one change at a time, then combinations along the front.

use super::{Axes, Axis, Record, Setting, front};
use crate::error::Result;

/// Tries at most `most` settings, at least one: the base, the base with every value of every axis, the fastest
/// value on all axes that leave the picture as it is, and from there neighbours on the trading axes of whatever
/// is on the front, until none of them is new: a Pareto local search (Paquete, Chiarandini and Stuetzle 2004).
///
/// `measure` may leave a setting out. Returns what it measured, and whether any setting was left for want of
/// trials.
///
/// # Errors
/// Those of `measure`.
pub fn search(
    axes: &Axes,
    base: Setting,
    most: usize,
    measure: &mut dyn FnMut(&Setting) -> Result<Option<Record>>,
) -> Result<(Vec<Record>, bool)> {
    let mut search = Search { axes, tried: Vec::new(), records: Vec::new() };
    let most = most.max(1);
    while let Some(next) = search.next(base) {
        if search.tried.len() == most {
            return Ok((search.records, true));
        }
        search.tried.push(next);
        search.records.extend(measure(&next)?);
    }
    Ok((search.records, false))
}

struct Search<'a> {
    axes: &'a Axes,
    tried: Vec<Setting>,
    records: Vec<Record>,
}

impl Search<'_> {
    fn next(&self, base: Setting) -> Option<Setting> {
        let single = Axis::ALL.into_iter().flat_map(|axis| self.axes.along(axis, base));
        let new = |setting: &Setting| !self.tried.contains(setting);
        std::iter::once(base).chain(single).find(new).or_else(|| self.combined(base).find(new))
    }

    /// Neighbours of the front.
    fn combined(&self, base: Setting) -> impl Iterator<Item = Setting> {
        let swiftest = self.swiftest(base);
        let points: Vec<_> = self.records.iter().map(|record| (record.time_ms, record.rmse)).collect();
        let members = front(&points).into_iter().map(|i| self.records[i].setting);
        let members = members.map(move |member| Axis::FREE.iter().fold(member, |m, axis| axis.taken(m, &swiftest)));
        members.flat_map(|member| std::iter::once(member).chain(self.neighbours(member)))
    }

    /// The base with the value of each free axis that was fastest by itself.
    fn swiftest(&self, base: Setting) -> Setting {
        let time = |setting: &Setting| {
            let record = self.records.iter().find(|record| record.setting == *setting);
            record.map_or(f64::INFINITY, |record| record.time_ms)
        };
        Axis::FREE.into_iter().fold(base, |best, axis| {
            let all = self.axes.along(axis, base);
            let fastest = all.iter().min_by(|a, b| time(a).total_cmp(&time(b)));
            axis.taken(best, fastest.unwrap_or(&base))
        })
    }

    /// One step on one trading axis.
    fn neighbours(&self, setting: Setting) -> impl Iterator<Item = Setting> {
        Axis::TRADING.into_iter().flat_map(move |axis| {
            let all = self.axes.along(axis, setting);
            let here = all.iter().position(|other| *other == setting);
            let near = here.map_or([None, None], |i| [i.checked_sub(1), Some(i + 1)]);
            let near: Vec<Setting> = near.into_iter().flatten().filter_map(|i| all.get(i).copied()).collect();
            near
        })
    }
}
