//! Which settings are tried: first one change at a time, then combinations along the front.

use super::{Axes, Axis, Record, Setting, front};
use crate::error::Result;

/// Tries at most `most` settings, at least one: the base, the base with every value of every axis, and then, with
/// the fastest value on all axes that leave the picture as it is, neighbours on the trading axes of whatever is on
/// the front, until none of them is new: a Pareto local search (Paquete, Chiarandini and Stuetzle 2004).
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
    let mut search = Search { axes, base, tried: Vec::new(), records: Vec::new() };
    let most = most.max(1);
    while let Some(next) = search.next() {
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
    base: Setting,
    tried: Vec<Setting>,
    records: Vec<Record>,
}

impl Search<'_> {
    fn next(&self) -> Option<Setting> {
        let single = Axis::ALL.into_iter().flat_map(|axis| self.axes.along(axis, self.base));
        let single = single.filter(Setting::is_possible).map(|setting| setting.plain(&self.base));
        std::iter::once(self.base).chain(single).find(|setting| self.is_new(setting)).or_else(|| self.combined())
    }

    fn is_new(&self, setting: &Setting) -> bool {
        !self.tried.contains(setting)
    }

    /// A new neighbour of a member of the front, of which the fewest were tried: the front grows everywhere.
    fn combined(&self) -> Option<Setting> {
        let swiftest = self.swiftest();
        let points: Vec<_> = self.records.iter().map(|record| (record.time_ms, record.rmse)).collect();
        let members = front(&points).into_iter().map(|i| self.records[i].setting);
        let near = members.map(|member| {
            let member = Axis::FREE.iter().fold(member, |member, axis| axis.taken(member, &swiftest));
            [vec![member], self.neighbours(member)].concat()
        });
        let new = near.filter_map(|near| {
            let first = near.iter().copied().find(|setting| self.is_new(setting))?;
            Some((near.iter().filter(|setting| !self.is_new(setting)).count(), first))
        });
        new.min_by_key(|(tried, _)| *tried).map(|(_, first)| first)
    }

    /// The base with the value of each free axis that was fastest by itself, if that was clearly faster: even in
    /// its slowest repetition.
    fn swiftest(&self) -> Setting {
        let of = |setting: &Setting| self.records.iter().find(|record| record.setting == *setting);
        let least = of(&self.base).map_or(f64::INFINITY, |record| record.time_ms);
        Axis::FREE.into_iter().fold(self.base, |best, axis| {
            let all = self.axes.along(axis, self.base);
            let clear = all.iter().filter_map(of).filter(|record| record.slowest_ms < least);
            let fastest = clear.min_by(|a, b| a.time_ms.total_cmp(&b.time_ms));
            fastest.map_or(best, |fastest| axis.taken(best, &fastest.setting))
        })
    }

    /// One step on one trading axis.
    fn neighbours(&self, setting: Setting) -> Vec<Setting> {
        let near = Axis::trading().flat_map(|axis| {
            let all = self.axes.along(axis, setting);
            let here = all.iter().position(|other| *other == setting);
            let near = here.map_or([None, None], |i| [i.checked_sub(1), Some(i + 1)]);
            near.into_iter().flatten().filter_map(move |i| all.get(i).copied())
        });
        near.filter(Setting::is_possible).map(|setting| setting.plain(&self.base)).collect()
    }
}
