//! What speed costs: a scene rendered with the settings that trade speed for accuracy, the time and the error of
//! each, the Pareto front of both, and the setting that serves a wish best.
//!
//! The data run one way: [`Axes`] say what is tried, [`search`] in which order, `measure` how long each takes and
//! how far it is from the reference, and a [`Report`] of [`Record`]s is what tables and plots are made of.

mod axes;
mod axis;
mod csv;
mod front;
mod hits;
mod measure;
mod plot;
mod recommend;
mod record;
mod reference;
mod scale;
mod search;
mod setting;
mod table;

#[cfg(test)]
mod tests;

pub use axes::Axes;
pub use axis::Axis;
pub use csv::csv;
pub use front::front;
pub use hits::HitErrors;
pub use measure::{Plan, Subject, run, steps};
pub use plot::plot;
pub use recommend::{Wish, recommended};
pub use record::{Record, Report};
pub use search::search;
pub use setting::Setting;
pub use table::markdown;
