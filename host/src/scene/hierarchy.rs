//! A hierarchy that was built before.

use std::fmt;
use std::sync::Arc;

use bytemuck::Pod;
use rayon::prelude::*;

use crate::quality;

/// The hierarchy that a binary scene brings along, as its file has it until it is wanted.
#[derive(Clone, PartialEq)]
pub struct Hierarchy {
    quality: quality::Bvh,
    /// Pairs, order and own boxes.
    sections: Arc<[Vec<u8>; 3]>,
}

impl Hierarchy {
    /// That of these sections of a file.
    pub fn new(quality: quality::Bvh, sections: [&[u8]; 3]) -> Self {
        Hierarchy { quality, sections: Arc::new(sections.map(<[u8]>::to_vec)) }
    }

    /// How well it was built.
    pub fn quality(&self) -> quality::Bvh {
        self.quality
    }

    /// It is not checked yet: see [`eyerays_bvh::Bvh::check`].
    pub fn read(&self) -> eyerays_bvh::Bvh {
        let [nodes, order, bounds] = &*self.sections;
        eyerays_bvh::Bvh { nodes: records(nodes), wide: Vec::new(), order: records(order), bounds: records(bounds) }
    }
}

impl fmt::Debug for Hierarchy {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.debug_struct("Hierarchy")
            .field("quality", &self.quality)
            .field("bytes", &self.sections.each_ref().map(Vec::len))
            .finish()
    }
}

/// The records of a section of bytes; what is left of them after the last whole one is left out.
pub(crate) fn records<T: Pod + Send>(bytes: &[u8]) -> Vec<T> {
    bytes.par_chunks_exact(size_of::<T>()).map(bytemuck::pod_read_unaligned).collect()
}
