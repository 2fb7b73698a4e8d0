//! Where the numbers come from by which a path is sampled.

use crate::data::Launch;
use crate::sampler::{self, AFTER_LENS, FLIGHTS, Key};
use glam::UVec4;

/// The numbers that a slot draws.
#[derive(Clone, Copy)]
pub(super) struct Draws {
    /// Names the sampler.
    pub launch: Launch,
    /// The pixel's.
    pub key: Key,
    /// Which of the pixel's samples the slot is.
    pub sample: u32,
    /// Do the camera's rays go through a lens?
    pub has_lens: bool,
}

impl Draws {
    /// The numbers of a way through a medium, by how often its path was scattered and has crossed surfaces since that are not there.
    #[inline(always)]
    pub fn flight(self, bounces: u32, crossings: u32) -> UVec4 {
        self.set(FLIGHTS + ((bounces << 8) | crossings))
    }

    /// A set of numbers, see [`sampler::set`].
    #[inline(always)]
    pub fn set(self, set: u32) -> UVec4 {
        sampler::set(self.launch, self.key, self.sample, set)
    }

    /// The pair that belongs to the ray that finds a vertex. That of the camera's is the lens' where there is one.
    #[inline(always)]
    pub fn pair(self, vertex: u32) -> (u32, u32) {
        if self.has_lens && vertex == 0 {
            let set = self.set(AFTER_LENS);
            return (set.x, set.y);
        }
        let set = self.set(vertex);
        (set.z, set.w)
    }
}
