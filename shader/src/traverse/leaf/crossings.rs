//! Triangles as a ray crosses them, one after the other, each surface once.

use super::{Identity, Leaf, triangle};
#[cfg(not(target_arch = "spirv"))]
use crate::bvh8::Bvh8Ref;
use crate::data::{Effects, Primitive};
use crate::ray::{Hit, Ray};
#[cfg(not(target_arch = "spirv"))]
use crate::real::Lanes;
use crate::real::{Real, Scalar};
use crate::scene::TraceContext;
use crate::traverse::Query;

/// What a ray [crosses](crate::geometry::crosses), instead of what it meets: the first that is not behind it ([`Ray::past`]). Spheres and
/// disks are crossed by none.
pub struct Crossings;

impl Leaf for Crossings {
    #[inline(always)]
    fn intersect<Q: Query, R: Real>(
        context: &TraceContext<'_>,
        (index, instance): (u32, u32),
        ray: &Ray<R>,
        hit: &mut Hit<R>,
    ) {
        Q::on_primitive();
        let primitive = context.base.placed(index, instance, ray.time);
        if is_triangle(context.base.spec.effects, &primitive) {
            let identity = Identity::within(index, instance, &primitive);
            triangle::cross::<Q, R>(context, &primitive, identity, ray, hit);
        }
    }

    #[cfg(not(target_arch = "spirv"))]
    fn intersect_block<Q: Query, R: Scalar, F: Lanes<R>>(_: &TraceContext<'_>, _: Bvh8Ref, _: &Ray<R>, _: &mut Hit<R>) {
        unreachable!("crossings are looked for by nodes of two children")
    }
}

/// Is it no sphere and no disk?
#[inline(always)]
fn is_triangle(effects: Effects, primitive: &Primitive) -> bool {
    !effects.has(Effects::SPHERE | Effects::DISK) || primitive.is_triangle()
}

/// Where on its triangle a crossing is: the weights of the second and the third vertex; zeros if there is none. As
/// [`coordinates`](super::coordinates), a CPU keeps them.
#[inline(always)]
pub fn crossing_weights<R: Scalar>(context: &TraceContext<'_>, ray: &Ray<R>, hit: &Hit<R>) -> (R, R) {
    if cfg!(not(target_arch = "spirv")) {
        return hit.coordinates();
    }
    if hit.primitive_index == Hit::<R>::NOTHING {
        return (R::splat(0.0), R::splat(0.0));
    }
    let primitive = context.base.placed(hit.primitive_index, hit.instance, ray.time);
    triangle::crossing_weights(context, &primitive, ray)
}
