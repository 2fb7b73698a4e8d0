//! What the stages of a launch exchange.

use eyerays_shader::real::Scalar;
use glam::UVec4;

/// The memory that the stages of a launch exchange.
pub struct Records<R: Scalar> {
    /// Paths by level, record and slot; empty without secondary rays.
    pub paths: Vec<R::Record>,
    /// What rays have found by slot, see [`Found`](eyerays_shader::stage::Found).
    pub hits: Vec<R::Record>,
    /// Answers of the shadow stage by light and slot.
    pub shadows: Vec<u32>,
    /// Shadow rays by record and slot, where the integrator samples.
    pub segments: Vec<R::Record>,
    /// Colour and counts by slot.
    pub sums: Vec<R::Record>,
    /// Photons that have landed, by slot and record, see [`Landed`](eyerays_shader::photon::Landed); empty but where slots are photons.
    pub landed: Vec<UVec4>,
}
