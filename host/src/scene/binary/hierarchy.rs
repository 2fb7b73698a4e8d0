//! A hierarchy in a file.

use std::fmt;
use std::sync::Arc;

use super::read::list;
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
        eyerays_bvh::Bvh { nodes: list(nodes), wide: Vec::new(), order: list(order), bounds: list(bounds) }
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
