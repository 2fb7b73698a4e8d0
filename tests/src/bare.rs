//! A few primitives in the normalised scene as they are, with no hierarchy and nothing that places them.

use eyerays::stream::StreamRay;
use eyerays_shader::bvh8::Bvh8View;
use eyerays_shader::data::{Effects, Frame, Primitive, Specialisation};
use eyerays_shader::ray::{Hit, Ray};
use eyerays_shader::real::{Scalar, V3};
use eyerays_shader::scene::{LaunchContext, TraceContext};
use eyerays_shader::traverse::{Leaf, Primitives, Query};

/// See the module.
#[derive(Debug)]
pub struct Bare {
    /// By their numbers.
    pub primitives: Vec<Primitive>,
    /// Those of spheres and disks.
    pub effects: Effects,
    frame: Frame,
}

impl Bare {
    /// Some primitives.
    pub fn new(primitives: Vec<Primitive>) -> Self {
        Bare { primitives, effects: Effects(Effects::SPHERE | Effects::DISK), frame: Frame::default() }
    }

    /// Tests a ray with all of them.
    pub fn hit<Q: Query, R: Scalar>(&self, ray: &Ray<R>, limit: f32) -> Hit<R> {
        let spec = Specialisation { effects: self.effects, ..Specialisation::default() };
        let primitives = bytemuck::cast_slice(&self.primitives);
        let context = TraceContext {
            base: LaunchContext::new(&self.frame, spec, primitives, &[]),
            nodes: &[],
            wide: &[],
            bvh8: Bvh8View::default(),
            cutout: Default::default(),
        };
        let mut hit = Hit::none(R::splat(limit));
        for index in 0..self.primitives.len() as u32 {
            Primitives::intersect::<Q, R>(&context, (index, u32::MAX), ray, &mut hit);
        }
        hit
    }
}

/// A ray of a stream, prepared.
pub fn prepared<R: Scalar>(ray: &StreamRay) -> Ray<R> {
    Ray::leaving(R::index(ray.source_primitive), V3::splat(ray.origin), V3::splat(ray.direction))
}
