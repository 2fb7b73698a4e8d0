//! What a test counted, printed for whoever runs it with `--nocapture`, and what it must be.

use std::fmt::Display;

/// Is every count to be as large as it is ever asked for? `EYERAYS_BATTERY=full` says so; by default samples do.
pub fn full() -> bool {
    std::env::var("EYERAYS_BATTERY").is_ok_and(|value| value == "full")
}

/// How many of something to test.
pub fn of(sample: usize, all: usize) -> usize {
    if full() { all } else { sample }
}

/// Prints a count.
pub fn line(what: impl Display, machine: impl Display, count: usize, of: usize) {
    println!("battery: {what}, {machine}: {count} of {of}");
}

/// Prints a count, which must be zero, of a number of cases, which must not.
///
/// # Panics
/// If it is otherwise.
pub fn none(what: impl Display, machine: impl Display, count: usize, of: usize) {
    line(&what, &machine, count, of);
    assert!(count == 0 && of > 0, "{what}, {machine}: {count} of {of}");
}
