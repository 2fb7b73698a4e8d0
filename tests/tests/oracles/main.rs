//! What the kernels compute against what they should: exact arithmetic, intervals, other devices.
//!
//! `EYERAYS_BATTERY=full` takes all samples; `--nocapture` prints the counts of docs/numerics.md.

mod bounds;
mod corpus;
mod extremes;
mod functions;
mod hits;
mod moller;
mod subnormals;
