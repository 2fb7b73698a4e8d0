//! A test of every primitive, with no hierarchy and no box but the primitives' own.

use eyerays::device_scene::SceneView;
use eyerays::job::Job;
use eyerays::method::Traversal;
use eyerays::stream::{Stream, StreamRay};
use eyerays_shader::ray::{Hit, Ray};
use eyerays_shader::real::{F32xN, Scalar, U32xN, V3};
use eyerays_shader::traverse::{Closest, Leaf, Primitives};
use glam::{UVec4, Vec3};
use rayon::prelude::*;

/// Rays that are tested together.
const LANES: usize = 8;

/// What must be the same: the bits of (t, u, v), and the primitive or [`StreamRay::NOWHERE`].
pub type Found = [u32; 4];

/// The closest hits of a stream.
pub fn brute_force(packed: &Job, stream: &Stream) -> Vec<Found> {
    let (laid, frame) = (SceneView::new(packed, Traversal::default()), packed.stream_frame(stream.len()));
    let geometry = laid.stream(&frame);
    let starts: Vec<usize> = (0..stream.len()).step_by(LANES).collect();
    let found = starts.par_iter().flat_map_iter(|&start| {
        let ray = |i: usize| stream.ray((start + i).min(stream.len() - 1));
        let vector = |of: &dyn Fn(StreamRay) -> Vec3| V3::<F32xN<LANES>>::of_lanes(|i| V3::splat(of(ray(i))));
        let source_primitive = U32xN(std::array::from_fn(|i| ray(i).source_primitive));
        let packet = Ray::leaving(source_primitive, vector(&|r| r.origin), vector(&|r| r.direction));
        let mut hit = Hit::none(F32xN(std::array::from_fn(|i| ray(i).limit)));
        for slot in 0..packed.primitives().len() as u32 {
            Primitives::intersect::<Closest, F32xN<LANES>>(&geometry, (slot, u32::MAX), &packet, &mut hit);
        }
        (0..LANES.min(stream.len() - start)).map(move |i| {
            let hit = hit.lane::<f32>(i);
            let (u, v) = hit.coordinates();
            [hit.t.to_bits(), u.to_bits(), v.to_bits(), hit.primitive]
        })
    });
    found.collect()
}

/// The same in any arithmetic, a ray at a time.
pub fn brute_force_of<R: Scalar>(packed: &Job, stream: &Stream) -> Vec<Found> {
    let (laid, frame) = (SceneView::new(packed, Traversal::default()), packed.stream_frame(stream.len()));
    let geometry = laid.stream(&frame);
    let found = (0..stream.len()).into_par_iter().map(|i| {
        let StreamRay { origin, direction, limit, source_primitive } = stream.ray(i);
        let ray = Ray::<R>::leaving(R::index(source_primitive), V3::splat(origin), V3::splat(direction));
        let mut hit = Hit::none(R::splat(limit));
        for slot in 0..packed.primitives().len() as u32 {
            Primitives::intersect::<Closest, R>(&geometry, (slot, u32::MAX), &ray, &mut hit);
        }
        let (u, v) = hit.coordinates();
        [hit.t.to_f32().to_bits(), u.to_f32().to_bits(), v.to_f32().to_bits(), hit.primitive]
    });
    found.collect()
}

/// A hit as a traversal returns it: a split triangle may be met at any of its places.
pub fn found(packed: &Job, hit: UVec4) -> Found {
    let primitive = packed.primitives().get(hit.w as usize).map_or(hit.w, |primitive| primitive.number());
    [hit.x, hit.y, hit.z, primitive]
}
