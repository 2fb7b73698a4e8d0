//! Participating media: what happens to light between surfaces (thesis 3.5 names it as what Whitted's model leaves out).

mod flight;
mod grid;
mod inside;
mod phase;
mod tracking;

pub use flight::{Flight, transmittance};
pub use grid::glow;
pub use inside::{Inside, MOST_CROSSINGS};
pub use phase::Phase;
pub use tracking::{Chain, delta, ratio};
