//! A scene as the kernels of a processor see it.

use eyerays_shader::bvh8::Bvh8View;
use eyerays_shader::data::{Features, Frame};
use eyerays_shader::scene::Geometry;

use super::{NodeWords, Packed, TriangleWords};
use crate::method::{Method, Traversal};

/// A scene laid out for a traversal, once for all launches.
pub struct Laid<'a> {
    /// The scene.
    pub packed: &'a Packed,
    /// How its rays are followed.
    pub traversal: Traversal,
    nodes: NodeWords<'a>,
    triangles: TriangleWords<'a>,
    bvh8: Bvh8View<'a>,
}

impl<'a> Laid<'a> {
    /// Lays out what the traversal does not take as it is packed.
    pub fn new(packed: &'a Packed, traversal: Traversal) -> Self {
        let (nodes, triangles) = (NodeWords::of(packed, traversal.layout), TriangleWords::of(packed, traversal.layout));
        let bvh8 = match traversal.method {
            Method::Auto | Method::Wide => packed.bvh8().borrow(),
            _ => Bvh8View::default(),
        };
        Laid { packed, traversal, nodes, triangles, bvh8 }
    }

    /// What the scene and the traversal ask of kernels.
    pub fn features(&self) -> Features {
        Features(self.packed.features.0 | self.traversal.features().0)
    }

    /// The scene for a launch of the camera's rays.
    pub fn geometry<'g>(&'g self, frame: &'g Frame) -> Geometry<'g> {
        Geometry {
            frame,
            features: self.features(),
            tuning: self.traversal.tuning,
            nodes: &self.nodes.0,
            wide: &self.packed.wide,
            bvh8: self.bvh8,
            triangles: &self.triangles.0,
            bounds: &self.packed.bounds,
        }
    }

    /// The scene for a launch of a stream's rays, see [`Packed::stream_frame`].
    pub fn stream<'g>(&'g self, frame: &'g Frame) -> Geometry<'g> {
        Geometry { features: Features(self.features().0 | Features::STREAM), ..self.geometry(frame) }
    }
}
