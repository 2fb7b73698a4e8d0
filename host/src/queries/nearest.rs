//! Where triangles come nearest to points.

use eyerays_shader::geometry::{self, FARTHEST};
use eyerays_shader::real::V3;
use eyerays_shader::stage::Found;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::Queries;
use super::surfaces::{Place, Surfaces};
use crate::batch::Hit;
use crate::cpu;
use crate::device_scene::flushed;
use crate::error::Result;
use crate::stream::{Stream, StreamRay};

/// How far from a point and from the middle of the cube a triangle may seem nearer than it is: twice the 16 roundoffs of
/// [`geometry::nearest`].
const LOST: f64 = 1.0 / (1 << 19) as f64;

/// See [`Queries::nearest`].
pub(super) fn nearest(
    queries: &Queries,
    count: usize,
    point: &(impl Fn(usize) -> DVec3 + Sync),
) -> Result<Vec<Option<(Hit, Place)>>> {
    let surfaces = &*queries.surfaces;
    surfaces.threads.install(|| {
        let normalisation = surfaces.job.normalisation();
        let points: Vec<DVec3> = (0..count).into_par_iter().map(|i| normalisation.exactly(point(i))).collect();
        let stream = Stream::new(points.iter().map(|&point| placed(point)));
        let found = match queries.gpu(count) {
            Some(caster) => caster.nearest(&stream)?,
            None => cpu::nearest_here(&surfaces.job, &stream),
        };
        Ok(points.par_iter().zip(&found).map(|(&point, found)| told(surfaces, point, found)).collect())
    })
}

/// What is told of the triangle that is nearest to a point of the normalised scene, in double precision.
fn told(surfaces: &Surfaces, point: DVec3, found: &Found<f32>) -> Option<(Hit, Place)> {
    let slot = (found.index, found.instance);
    let primitive = surfaces.primitive(slot)?;
    let double = |p: DVec3| V3::<f64>::new(p.x, p.y, p.z);
    let [a, b, c] = primitive.vertices().map(Vec3::as_dvec3);
    let near = geometry::nearest(double(a), double(b), double(c), double(seen(point)));
    let (normalisation, (v, w)) = (surfaces.job.normalisation(), near.weights);
    let coordinates = [v as f32, w as f32];
    let at = a + (b - a) * v + (c - a) * w;
    let t = length(at - point) / normalisation.scale;
    let place = Place {
        point: normalisation.inverse().transform_point3(at),
        error: LOST * (point.abs().max_element() + 2.0) / normalisation.scale,
        ..surfaces.place_on(&primitive, coordinates)
    };
    Some((Hit { t, primitive: primitive.number(), coordinates, slot }, place))
}

/// From where a far point sees the triangles as it does, but for rounding.
fn seen(point: DVec3) -> DVec3 {
    let far = point.abs().max_element() / f64::from(FARTHEST);
    if far > 1.0 { point / far } else { point }
}

/// A vector's length, whose square may be no number.
fn length(of: DVec3) -> f64 {
    let size = of.abs().max_element();
    if size == 0.0 { 0.0 } else { (of / size).length() * size }
}

/// A point as the origin of a ray, as kernels take it.
fn placed(point: DVec3) -> StreamRay {
    // Nothing is nearer than that.
    let limit = if point.is_finite() { f32::MAX } else { -1.0 };
    let origin = if point.is_finite() { flushed(seen(point).as_vec3()) } else { Vec3::ZERO };
    StreamRay { origin, direction: Vec3::X, limit, source_primitive: StreamRay::NOWHERE }
}
