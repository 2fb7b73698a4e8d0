//! A hierarchy in a file.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use super::read::list;
use crate::quality;

/// All of a file, mapped or in memory.
pub type Bytes = Arc<dyn AsRef<[u8]> + Send + Sync>;

/// The hierarchy that a binary scene brings along. It stays in its file until it is wanted.
#[derive(Clone)]
pub struct Hierarchy {
    quality: quality::Bvh,
    file: Bytes,
    /// Pairs, order and own boxes.
    sections: [Range<usize>; 3],
}

impl Hierarchy {
    /// That of these sections of a file, which lie inside.
    pub fn new(quality: quality::Bvh, file: Bytes, sections: [Range<usize>; 3]) -> Self {
        Hierarchy { quality, file, sections }
    }

    /// How well it was built.
    pub fn quality(&self) -> quality::Bvh {
        self.quality
    }

    /// A copy that nothing outside can change. It is not checked yet: see [`eyerays_bvh::Bvh::check`].
    pub fn read(&self) -> eyerays_bvh::Bvh {
        let [nodes, order, bounds] = self.slices();
        eyerays_bvh::Bvh { nodes: list(nodes), wide: Vec::new(), order: list(order), bounds: list(bounds) }
    }

    fn slices(&self) -> [&[u8]; 3] {
        self.sections.clone().map(|section| &(*self.file).as_ref()[section])
    }
}

impl PartialEq for Hierarchy {
    fn eq(&self, other: &Self) -> bool {
        self.quality == other.quality && self.slices() == other.slices()
    }
}

impl fmt::Debug for Hierarchy {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.debug_struct("Hierarchy").field("quality", &self.quality).field("sections", &self.sections).finish()
    }
}
