//! What a ray has found, and how that lies in memory.

use crate::buffer::{read, write};
use crate::data::{Effects, Launch};
use crate::ray::{Hit, Ray};
use crate::real::{Scalar, V3};
use crate::scene::{LaunchContext, TraceContext};
use crate::traverse::leaf;

/// What a ray has found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found<R> {
    /// How far away, in lengths of the ray's direction.
    pub t: R,
    /// Where on the primitive, see [`leaf::coordinates`].
    pub coordinates: (R, R),
    /// The primitive's index in leaf order, or [`Hit::NOTHING`].
    pub index: u32,
    /// The copy of a mesh that it is in, or [`Hit::NOTHING`].
    pub instance: u32,
    /// When, see [`Ray::time`].
    pub time: f32,
}

impl<R: Scalar> Found<R> {
    /// What a traversal has left.
    #[inline(always)]
    pub fn of(context: &TraceContext<'_>, ray: &Ray<R>, hit: &Hit<R>) -> Self {
        let coordinates = leaf::coordinates(context, ray, hit);
        Found { t: hit.t, coordinates, index: hit.primitive_index, instance: hit.instance, time: ray.time }
    }

    /// Nothing.
    #[inline(always)]
    pub fn nothing() -> Self {
        let zero = R::splat(0.0);
        let (index, instance) = (Hit::<R>::NOTHING, Hit::<R>::NOTHING);
        Found { t: zero, coordinates: (zero, zero), index, instance, time: 0.0 }
    }

    /// Is it nothing?
    #[inline(always)]
    pub fn is_nothing(&self) -> bool {
        self.index == Hit::<R>::NOTHING
    }

    /// Records that it takes in device memory.
    #[inline(always)]
    pub fn records(effects: Effects) -> u32 {
        if effects.has(Effects::INSTANCED) { 2 } else { 1 }
    }

    /// What a slot's ray has found: (t, u, v) and the index; and behind those of all slots, where there are copies of meshes, when it
    /// was and their numbers.
    #[inline(always)]
    pub fn load(launch: &LaunchContext<'_>, slot: u32, hits: &[R::Record]) -> Self {
        let (place, index) = R::load(read(hits, slot));
        let (time, instance) = if launch.spec.effects.has(Effects::INSTANCED) {
            R::load(read(hits, launch.frame.slots + slot))
        } else {
            (V3::zero(), Hit::<R>::NOTHING)
        };
        let time = if launch.spec.launch.has(Launch::MOVING) { time.x.to_f32() } else { 0.0 };
        Found { t: place.x, coordinates: (place.y, place.z), index, instance, time }
    }

    /// The time of a slot's rays, which its last one has left; 0 where nothing has a time.
    #[inline(always)]
    pub fn time(launch: &LaunchContext<'_>, slot: u32, hits: &[R::Record]) -> f32 {
        if !launch.spec.launch.has(Launch::MOVING) || launch.frame.steps == 0 {
            return 0.0;
        }
        R::load(read(hits, launch.frame.slots + slot)).0.x.to_f32()
    }

    /// Keeps the time of a slot's first ray for [`Found::time`].
    #[inline(always)]
    pub fn start(time: f32, slots: u32, slot: u32, hits: &mut [R::Record]) {
        write(hits, slots + slot, R::store(V3::new(R::splat(time), R::splat(0.0), R::splat(0.0)), 0));
    }

    /// Keeps it where [`Found::load`] finds it.
    #[inline(always)]
    pub fn store(&self, launch: &LaunchContext<'_>, slot: u32, hits: &mut [R::Record]) {
        let Found { t, coordinates: (u, v), index, instance, time } = *self;
        write(hits, slot, R::store(V3::new(t, u, v), index));
        if launch.spec.effects.has(Effects::INSTANCED) {
            let time = V3::new(R::splat(time), R::splat(0.0), R::splat(0.0));
            write(hits, launch.frame.slots + slot, R::store(time, instance));
        }
    }
}
