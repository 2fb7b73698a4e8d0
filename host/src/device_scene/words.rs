//! Primitives and nodes as kernels load them.

use std::borrow::Cow;
use std::collections::HashMap;

use eyerays_shader::data::{CompactPair, Primitive};
use glam::UVec4;
use rayon::prelude::*;

use super::DeviceScene;
use crate::method::Layout;

/// The words of all primitives in one of their layouts, see [`eyerays_shader::scene::LaunchContext::primitive`].
pub struct PrimitiveWords<'a>(pub Cow<'a, [UVec4]>);

impl<'a> PrimitiveWords<'a> {
    /// The primitives of a scene.
    pub fn of(packed: &'a DeviceScene, layout: Layout) -> Self {
        PrimitiveWords(match layout {
            Layout::Gathered | Layout::Compact => Cow::Borrowed(bytemuck::cast_slice(&packed.primitives)),
            Layout::Indexed => Cow::Owned(indexed(&packed.primitives)),
        })
    }
}

/// The words of all pairs of nodes, see [`eyerays_shader::scene::TraceContext::pair`].
pub struct NodeWords<'a>(pub Cow<'a, [UVec4]>);

impl<'a> NodeWords<'a> {
    /// The hierarchy of a scene.
    pub fn of(packed: &'a DeviceScene, layout: Layout) -> Self {
        NodeWords(match layout {
            Layout::Compact => {
                let pairs: Vec<CompactPair> = packed.nodes.par_iter().map(CompactPair::from).collect();
                Cow::Owned(bytemuck::cast_slice(&pairs).to_vec())
            }
            Layout::Gathered | Layout::Indexed => Cow::Borrowed(bytemuck::cast_slice(&packed.nodes)),
        })
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
