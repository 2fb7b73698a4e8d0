//! Triangles and nodes as kernels load them.

use std::borrow::Cow;
use std::collections::HashMap;

use eyerays_shader::data::{CompactPair, Primitive};
use glam::UVec4;

use super::DeviceScene;
use crate::method::Layout;

/// The words of all triangles in one of their layouts, see [`eyerays_shader::scene::LaunchContext::triangle`].
pub struct TriangleWords<'a>(pub Cow<'a, [UVec4]>);

impl<'a> TriangleWords<'a> {
    /// The triangles of a scene.
    pub fn of(packed: &'a DeviceScene, layout: Layout) -> Self {
        TriangleWords(match layout {
            Layout::Gathered | Layout::Compact => Cow::Borrowed(bytemuck::cast_slice(&packed.triangles)),
            Layout::Indexed => Cow::Owned(indexed(&packed.triangles)),
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
                let pairs: Vec<CompactPair> = packed.nodes.iter().map(CompactPair::from).collect();
                Cow::Owned(bytemuck::cast_slice(&pairs).to_vec())
            }
            Layout::Gathered | Layout::Indexed => Cow::Borrowed(bytemuck::cast_slice(&packed.nodes)),
        })
    }
}

/// A word of three vertices' numbers and the primitive for each triangle, then the vertices, each with its
/// triangles' material and flag: corners that share both and their place are one.
fn indexed(triangles: &[Primitive]) -> Vec<UVec4> {
    let mut numbers = HashMap::new();
    let mut words = Vec::with_capacity(2 * triangles.len());
    let mut vertices = Vec::new();
    for t in triangles {
        let clear = if t.is_transparent() { Primitive::CLEAR_VERTEX } else { 0 };
        let corner = [t.a, t.b, t.c].map(|corner| {
            let vertex = corner.truncate().extend(t.material() | clear);
            *numbers.entry(vertex).or_insert_with(|| {
                vertices.push(vertex);
                vertices.len() as u32 - 1
            })
        });
        words.push(UVec4::new(corner[0], corner[1], corner[2], t.primitive()));
    }
    words.extend(vertices);
    words
}
