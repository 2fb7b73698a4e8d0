//! Primitives and nodes as kernels load them.

use std::collections::HashMap;

use eyerays_shader::data::{CompactPair, Primitive};
use glam::UVec4;
use rayon::prelude::*;

use super::DeviceScene;
use crate::method::Layout;

/// The words of all primitives in one of their layouts, see [`eyerays_shader::scene::LaunchContext::primitive`]: none beside the scene's
/// own where these will do.
pub struct PrimitiveWords(Option<Vec<UVec4>>);

impl PrimitiveWords {
    /// For a layout of a scene's primitives.
    pub fn of(packed: &DeviceScene, layout: Layout) -> Self {
        PrimitiveWords(match layout {
            Layout::Gathered | Layout::Compact => None,
            Layout::Indexed => Some(indexed(&packed.primitives)),
        })
    }

    /// The words, of the scene that they were made for.
    pub fn words<'a>(&'a self, packed: &'a DeviceScene) -> &'a [UVec4] {
        self.0.as_deref().unwrap_or(bytemuck::cast_slice(&packed.primitives))
    }
}

/// The words of all pairs of nodes, see [`eyerays_shader::scene::Hierarchy::pair`], likewise.
pub struct NodeWords(Option<Vec<UVec4>>);

impl NodeWords {
    /// For a layout of a scene's hierarchy.
    pub fn of(packed: &DeviceScene, layout: Layout) -> Self {
        NodeWords(match layout {
            Layout::Compact => {
                let pairs: Vec<CompactPair> = packed.nodes().par_iter().map(CompactPair::from).collect();
                Some(bytemuck::cast_slice(&pairs).to_vec())
            }
            Layout::Gathered | Layout::Indexed => None,
        })
    }

    /// The words, of the scene that they were made for.
    pub fn words<'a>(&'a self, packed: &'a DeviceScene) -> &'a [UVec4] {
        self.0.as_deref().unwrap_or(bytemuck::cast_slice(packed.nodes()))
    }
}

/// A word of three vertices' numbers and the primitive's for each primitive, then the vertices, each with its primitives'
/// material and flags: corners that share both and their place are one. The numbers of a sphere or a disk lie as three
/// vertices would.
fn indexed(primitives: &[Primitive]) -> Vec<UVec4> {
    let mut numbers = HashMap::new();
    let mut words = Vec::with_capacity(2 * primitives.len());
    let mut vertices = Vec::new();
    for p in primitives {
        let beside = p.material() | p.c.w << Primitive::FLAGS_SHIFT;
        let corner = [p.a, p.b, p.c].map(|corner| {
            let vertex = corner.truncate().extend(beside);
            *numbers.entry(vertex).or_insert_with(|| {
                vertices.push(vertex);
                vertices.len() as u32 - 1
            })
        });
        words.push(UVec4::new(corner[0], corner[1], corner[2], p.number()));
    }
    words.extend(vertices);
    words
}
