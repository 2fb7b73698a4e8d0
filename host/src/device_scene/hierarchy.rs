//! The hierarchy of a scene, and what lies in its order.

use eyerays_bvh::linear::linear;
use eyerays_bvh::{BuildError, Bvh, Limits, Quality, Statistics};
use eyerays_shader::data::{CentredPair, NodePair, NodeRef, Primitive};
use rayon::prelude::*;

use super::{normalisation, records};
use crate::error::{Error, Result};
use crate::scene::Scene;

/// The hierarchy that kernels find a scene's primitives by: the one that the scene brings along if it has this quality,
/// checked, or a new one.
///
/// # Errors
/// As [`DeviceScene::new`](super::DeviceScene::new).
pub fn hierarchy(scene: &Scene, quality: Quality) -> Result<Bvh> {
    scene.check()?;
    if !scene.instances.is_empty() {
        return Err(Error::new("a hierarchy of copies of meshes is not kept: flatten the scene"));
    }
    kept_or_built(scene, &records::primitives(scene, &normalisation(scene), &[]), quality)
}

pub(super) fn kept_or_built(scene: &Scene, primitives: &[Primitive], quality: Quality) -> Result<Bvh> {
    if let Some(kept) = scene.hierarchy.as_ref().filter(|kept| kept.quality().quality() == quality) {
        let bvh = kept.read();
        return bvh.check(primitives).map(|()| bvh).map_err(|e| {
            let fault = format!("the hierarchy that the scene brings along is not its own: {e}");
            Error::new(format!("{fault}; write its file again with eyerays convert"))
        });
    }
    built(primitives, quality, Limits::default())
}

/// A new hierarchy.
pub(super) fn built(primitives: &[Primitive], quality: Quality, limits: Limits) -> Result<Bvh> {
    let references = match quality {
        Quality::Linear => linear(primitives),
        _ => eyerays_bvh::split(primitives, quality.split_budget()),
    };
    let references = references.map_err(refused)?;
    eyerays_bvh::build_within(&references, quality, limits).map_err(refused)
}

/// The figures of a hierarchy that is built as [`in_place`].
pub(super) fn statistics(triangles: &[Primitive]) -> Statistics {
    let bvh = built(triangles, Quality::Linear, Limits::SINGLE).expect("its triangles were checked");
    Statistics::of(&bvh, triangles)
}

/// The pairs of triangles that lie in any order, built when a device asks for them that can't build its own. Each leaf has one.
pub(super) fn in_place(triangles: &[Primitive]) -> Vec<CentredPair> {
    let bvh = built(triangles, Quality::Linear, Limits::SINGLE).expect("its triangles were checked");
    let mut pairs = centred(bvh.nodes);
    let slot =
        |child: NodeRef| if child.is_leaf() { NodeRef::leaf(bvh.order[child.index() as usize], 1) } else { child };
    pairs.par_iter_mut().for_each(|pair| {
        pair.left_centre.w = slot(pair.left()).0;
        pair.right_centre.w = slot(pair.right()).0;
    });
    pairs
}

/// The pairs as kernels test them, in the same memory.
pub(super) fn centred(mut pairs: Vec<NodePair>) -> Vec<CentredPair> {
    pairs.par_iter_mut().for_each(|pair| *pair = bytemuck::cast(CentredPair::from(&*pair)));
    bytemuck::cast_vec(pairs)
}

/// The primitives in the order of slots.
pub(super) fn gathered(primitives: Vec<Primitive>, order: &[u32]) -> Vec<Primitive> {
    order.par_iter().map(|&primitive| primitives[primitive as usize]).collect()
}

pub(super) fn refused(error: BuildError) -> Error {
    Error::new(error.to_string())
}
