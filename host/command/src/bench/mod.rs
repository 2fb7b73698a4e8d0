//! Measurements: the thesis' tables 7.1 to 7.3, for every method and device, over rays that are the same for all.

pub mod answers;
pub mod counts;
mod csv;
mod device;
mod kind;
mod markdown;
mod plan;
pub mod rays;
mod record;
mod run;
mod sample;
mod setup;
mod text;
mod timing;

#[cfg(test)]
mod tests;

pub use csv::csv;
pub(crate) use csv::quoted;
pub(crate) use device::OnGpu;
pub use kind::Kind;
pub use markdown::markdown;
pub use plan::{Plan, Subject};
pub use record::{Record, Report, SceneRow, ViewRow};
pub use run::{run, streams};
pub(crate) use setup::cpu_model;
pub(crate) use text::{escaped, short};
pub use timing::Timing;
