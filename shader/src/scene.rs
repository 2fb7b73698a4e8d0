//! What a launch sees of the scene in device memory.

use crate::data::{Features, Frame, Light, Material, NodePair, Normals, Triangle, Tuning};

/// The launch and what its rays meet.
#[derive(Clone, Copy)]
pub struct Geometry<'a> {
    /// The launch.
    pub frame: &'a Frame,
    /// Which effects there are; a constant of the compiled kernel on the GPU.
    pub features: Features,
    /// When hybrid methods part; a constant of the compiled kernel on the GPU.
    pub tuning: Tuning,
    /// Child pairs; the root is pair 0.
    pub nodes: &'a [NodePair],
    /// Triangles in leaf order.
    pub triangles: &'a [Triangle],
}

impl Geometry<'_> {
    /// How many lights there are.
    #[inline(always)]
    pub fn light_count(&self) -> u32 {
        self.frame.top.w
    }

    /// Rays a launch has room for.
    #[inline(always)]
    pub fn slots(&self) -> u32 {
        self.frame.limits.z
    }
}

/// What surfaces look like. A buffer that no effect asks for is a dummy of one record.
#[derive(Clone, Copy)]
pub struct Looks<'a> {
    /// Vertex normals in leaf order ([`Features::SMOOTH`]).
    pub normals: &'a [Normals],
    /// Materials.
    pub materials: &'a [Material],
    /// Lights in file order.
    pub lights: &'a [Light],
}
