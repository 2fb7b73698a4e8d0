//! Where triangles come nearest to points.

use std::sync::Arc;

use eyerays_shader::data::Primitive;
use eyerays_shader::geometry::{self, FARTHEST};
use eyerays_shader::real::V3;
use eyerays_shader::stage::Found;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::Queries;
use super::hits::{Answered, Place, Surfaces};
use crate::batch::Hit;
use crate::cpu;
use crate::device_scene::flushed;
use crate::error::Result;
use crate::stream::{Stream, StreamRay};

/// The triangles that are nearest to many points.
pub struct Nearest {
    surfaces: Arc<Surfaces>,
    /// In the normalised scene.
    points: Vec<DVec3>,
    found: Vec<Found<f32>>,
}

/// How far from a point and from the middle of the cube a triangle may seem nearer than it is: twice the 16 roundoffs of
/// [`geometry::nearest`].
const LOST: f64 = 1.0 / (1 << 19) as f64;

impl Nearest {
    pub(super) fn found(queries: &Queries, count: usize, point: &(impl Fn(usize) -> DVec3 + Sync)) -> Result<Self> {
        let Queries { surfaces, .. } = queries;
        surfaces.threads.install(|| {
            let normalisation = surfaces.job.normalisation();
            let points: Vec<DVec3> = (0..count).into_par_iter().map(|i| normalisation.exactly(point(i))).collect();
            let stream = Stream::new(points.iter().map(|&point| placed(point)));
            let found = match queries.gpu(count) {
                Some(gpu) => gpu.caster.nearest(&stream)?,
                None => cpu::nearest_here(&surfaces.job, &stream),
            };
            Ok(Nearest { surfaces: surfaces.clone(), points, found })
        })
    }

    fn nearest(&self, point: usize) -> Option<(Primitive, geometry::Nearest<f64>)> {
        let found = self.found.get(point)?;
        let primitive = self.surfaces.primitive((found.index, found.instance))?;
        let double = |p: DVec3| V3::<f64>::new(p.x, p.y, p.z);
        let [a, b, c] = primitive.vertices().map(|vertex| double(vertex.as_dvec3()));
        Some((primitive, geometry::nearest(a, b, c, double(self.points[point]))))
    }
}

/// A hit's distance is that of the point in the scene's units, and the error of its place bounds how much nearer any other triangle is. Which of
/// several it is that are equally near but for rounding is left to that; what is told of it is in double precision.
impl Answered for Nearest {
    fn hit(&self, point: usize) -> Option<Hit> {
        let (primitive, near) = self.nearest(point)?;
        let (v, w) = near.weights;
        let t = near.square.sqrt() / self.surfaces.job.normalisation().scale;
        let slot = (self.found[point].index, self.found[point].instance);
        Some(Hit { t, primitive: primitive.number(), coordinates: [v as f32, w as f32], slot })
    }

    fn surface(&self, hit: &Hit) -> Option<(u32, u32)> {
        self.surfaces.surface(hit)
    }

    fn place(&self, point: usize) -> Option<Place> {
        let (primitive, near) = self.nearest(point)?;
        let [a, b, c] = primitive.vertices().map(Vec3::as_dvec3);
        let (v, w) = near.weights;
        let normalisation = self.surfaces.job.normalisation();
        let at = a + (b - a) * v + (c - a) * w;
        let error = LOST * (self.points[point].abs().max_element() + 2.0) / normalisation.scale;
        let there = self.surfaces.place_on(&primitive, [v as f32, w as f32]);
        Some(Place { point: normalisation.inverse().transform_point3(at), error, ..there })
    }
}

/// A point as the origin of a ray, as kernels take it.
fn placed(point: DVec3) -> StreamRay {
    let far = point.abs().max_element() / f64::from(FARTHEST);
    let origin = if far > 1.0 { point / far } else { point };
    // Nothing is nearer than that.
    let limit = if point.is_finite() { f32::MAX } else { -1.0 };
    let origin = if point.is_finite() { flushed(origin.as_vec3()) } else { Vec3::ZERO };
    StreamRay { origin, direction: Vec3::X, limit, source_primitive: StreamRay::NOWHERE }
}
