//! The command `eyerays` as a library: what it measures and makes, and how it speaks.

// A closed standard error makes these panic: the command speaks through `cli::console`.
#![cfg_attr(not(test), warn(clippy::print_stderr, clippy::print_stdout))]
// A test's expectation may err by a platform's last bit.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

pub mod bench;
pub mod cli;
pub mod error;
pub mod farm;
pub mod flip;
pub mod generate;
pub mod output;
pub mod preset;
pub mod remedy;
pub mod tradeoff;
