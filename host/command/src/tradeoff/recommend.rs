//! The setting that serves a wish best.

use std::fmt;

use super::Record;

/// What is wished of a setting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Wish {
    /// The fastest one whose root of the mean square error is at most this.
    MaxError(f64),
    /// The most accurate one that takes at most so many milliseconds, in the slowest of its repetitions.
    Budget(f64),
}

impl fmt::Display for Wish {
    /// As the command line asks for it.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Wish::MaxError(most) => write!(out, "--max-error {most}"),
            Wish::Budget(most) => write!(out, "--budget {most}"),
        }
    }
}

/// The record that serves a wish best; none if none does.
pub fn recommended(records: &[Record], wish: Wish) -> Option<usize> {
    let serves = |record: &Record| match wish {
        Wish::MaxError(most) => record.rmse <= most,
        Wish::Budget(most) => record.slowest_ms <= most,
    };
    let order = |record: &Record| match wish {
        Wish::MaxError(_) => (record.time_ms, record.rmse),
        Wish::Budget(_) => (record.rmse, record.time_ms),
    };
    let serving = (0..records.len()).filter(|&i| serves(&records[i]));
    serving.min_by(|&a, &b| {
        let (a, b) = (order(&records[a]), order(&records[b]));
        a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
    })
}
