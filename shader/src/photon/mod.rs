//! Light that comes by mirrors and glass, which paths from the camera find by chance alone, told by photons (Jensen, Global Illumination
//! Using Photon Maps, 1996): paths that start at lamps, aimed at what casts caustics, and lie where they have come to after mirrors and
//! lenses alone. Each sample of a picture has photons of its own, and looks around itself for them as far as its number says, ever less
//! (Knaus and Zwicker, Progressive Photon Mapping: A Probabilistic Approach, 2011), so that the mean of samples comes as near to the truth as one
//! likes, and no sample depends on another.
//!
//! Photons are found by the cells of a grid, whose lists have any order; what they come to is summed in whole quanta, which have none.

mod casters;
mod grid;
mod landed;

pub use casters::Casters;
pub use grid::{Grid, file, radius};
pub use landed::{Landed, single, widened};

use crate::data::Frame;
use crate::sampler::Key;

/// Records that a photon takes in device memory.
pub const RECORDS: u32 = 3;
/// Lists of a grid for each photon that there may be.
pub const LISTS: u32 = 2;

/// The photons of a launch, as they lie in device memory.
#[derive(Clone, Copy)]
pub struct Photons<'a> {
    /// [`Landed`] by number: all of a sample before those of the next.
    pub records: &'a [glam::UVec4],
    /// The first of each list of the grid.
    pub heads: &'a [u32],
}

/// What the photons of a sample draw their numbers from: no pixel's.
#[inline(always)]
pub fn key(frame: &Frame, sample: u32) -> Key {
    /// Of photons alone.
    const SALT: u32 = 0x7a5d_31c3;
    Key::new((sample & 0xffff, sample >> 16), frame.seed ^ SALT)
}

/// Which photon of its sample a slot of a launch of photons follows.
#[inline(always)]
pub fn number(frame: &Frame, slot: u32) -> u32 {
    let photons = if frame.photons == 0 { 1 } else { frame.photons };
    (frame.photon + slot) % photons
}
