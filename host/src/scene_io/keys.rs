//! Keys of a TOML scene: what something is at some times, and straight lines between.

use glam::Vec3;

use super::table::Table;
use crate::error::Result;
use crate::scene::Range;

/// So many triples at some times, in seconds.
#[derive(Debug, Clone, PartialEq)]
pub struct Keys<const N: usize> {
    times: Vec<f32>,
    values: Vec<[Vec3; N]>,
}

/// What a key may say: how it is called, and its range.
pub type Field = (&'static str, Range);

impl<const N: usize> Keys<N> {
    /// Reads every `[[...key]]` of a table, if it has any. What a key does not say is as in the table itself, `own`.
    ///
    /// # Errors
    /// A key without a time, or one that is not after that of the key before; a number out of range, or an unknown word.
    pub fn read(table: &mut Table, fields: [Field; N], own: [Vec3; N]) -> Result<Option<Keys<N>>> {
        let Some(tables) = table.tables("key")? else { return Ok(None) };
        let mut keys = Keys { times: Vec::new(), values: Vec::new() };
        for mut table in tables {
            table.rename("a key");
            let time = table.number("time", Range::ANY)?;
            let time = table.need("time", time)?;
            if let Some(last) = keys.times.last().filter(|&&last| last >= time) {
                let fault = format!("the key at {time} is not after the one at {last}; put keys into their order");
                return Err(table.fault_of("time", fault));
            }
            let mut value = own;
            for (value, (name, range)) in value.iter_mut().zip(fields) {
                *value = table.triple_or_number(name, range)?.unwrap_or(*value);
            }
            table.done()?;
            keys.times.push(time);
            keys.values.push(value);
        }
        Ok(Some(keys).filter(|keys| !keys.times.is_empty()))
    }

    /// The time of the last.
    pub fn last(&self) -> f32 {
        self.times.last().copied().unwrap_or(0.0)
    }

    /// The triples at a time; before the first key and after the last they stand still.
    pub fn at(&self, seconds: f64) -> [Vec3; N] {
        let next = self.times.partition_point(|&time| f64::from(time) <= seconds);
        if next == 0 || next == self.times.len() {
            return self.values[next.saturating_sub(1)];
        }
        let [start, end] = [next - 1, next].map(|key| f64::from(self.times[key]));
        let (share, from, to) = ((seconds - start) / (end - start), self.values[next - 1], self.values[next]);
        std::array::from_fn(|field| from[field].as_dvec3().lerp(to[field].as_dvec3(), share).as_vec3())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_keys_everything_goes_straight() {
        let value = |x: f32| [Vec3::splat(x), Vec3::splat(-x), Vec3::ONE];
        let keys = Keys { times: vec![0.5, 1.0, 3.0], values: vec![value(1.0), value(2.0), value(6.0)] };
        for (seconds, want) in [(-1.0, 1.0), (0.5, 1.0), (0.75, 1.5), (1.0, 2.0), (2.0, 4.0), (3.0, 6.0), (9.0, 6.0)] {
            assert_eq!(keys.at(seconds), value(want), "{seconds}");
        }
        assert_eq!(keys.last(), 3.0);
    }
}
