//! Triangles alone, or with spheres, disks and copies of meshes in any mixture.

use super::{Identity, Leaf, disk, hidden, sphere, triangle};
#[cfg(not(target_arch = "spirv"))]
use crate::bvh8::{Bvh8Ref, LeafKind};
use crate::data::{Effects, Primitive};
use crate::ray::{Hit, Ray};
#[cfg(not(target_arch = "spirv"))]
use crate::real::Lanes;
use crate::real::{Real, Scalar};
use crate::scene::TraceContext;
use crate::traverse::Query;
#[cfg(not(target_arch = "spirv"))]
use crate::traverse::nested;

/// Of any kind.
pub struct Primitives;

/// Of a scene that has nothing else. A GPU's kernels are folded to this; on a CPU the code of spheres that is never run would
/// take registers from the loops around it: half of the primary rays a second, of packets with AVX-512.
#[cfg(not(target_arch = "spirv"))]
pub struct Triangles;

impl Leaf for Primitives {
    #[inline(always)]
    fn intersect<Q: Query, R: Real>(
        context: &TraceContext<'_>,
        (index, instance): (u32, u32),
        ray: &Ray<R>,
        hit: &mut Hit<R>,
    ) {
        Q::on_primitive();
        let primitive = context.base.placed(index, instance, ray.time);
        let effects = context.base.spec.effects;
        if hidden::is_unmet::<Q, R>(context.base.spec, &primitive, ray) {
            return;
        }
        if effects.has(Effects::SPHERE) && primitive.is_sphere() {
            sphere::intersect::<Q, R>(context, &primitive, index, ray, hit);
        } else if effects.has(Effects::DISK) && primitive.is_disk() {
            disk::intersect::<Q, R>(context, &primitive, index, ray, hit);
        } else {
            let identity = Identity::within(index, instance, &primitive);
            triangle::intersect::<Q, R>(context, &primitive, identity, ray, hit);
        }
    }

    #[cfg(not(target_arch = "spirv"))]
    #[inline(always)]
    fn intersect_block<Q: Query, R: Scalar, F: Lanes<R>>(
        context: &TraceContext<'_>,
        leaf: Bvh8Ref,
        ray: &Ray<R>,
        hit: &mut Hit<R>,
    ) {
        let blocks = &context.bvh8;
        match leaf.kind() {
            LeafKind::Triangles => {
                triangle::intersect_four::<Q, R, F>(context, &blocks.triangles[leaf.index()], ray, hit)
            }
            LeafKind::Spheres => sphere::intersect_four::<Q, R, F>(context, &blocks.spheres[leaf.index()], ray, hit),
            LeafKind::Mixed => {
                for &index in blocks.mixed[leaf.index()].indices() {
                    nested::intersect::<Q, Self, R>(context, index, ray, hit);
                }
            }
        }
    }
}

#[cfg(not(target_arch = "spirv"))]
impl Leaf for Triangles {
    #[inline(always)]
    fn intersect<Q: Query, R: Real>(
        context: &TraceContext<'_>,
        (index, _): (u32, u32),
        ray: &Ray<R>,
        hit: &mut Hit<R>,
    ) {
        Q::on_primitive();
        let triangle = context.primitive(index);
        triangle::intersect::<Q, R>(context, &triangle, Identity::alone(index, &triangle), ray, hit);
    }

    #[inline(always)]
    fn intersect_block<Q: Query, R: Scalar, F: Lanes<R>>(
        context: &TraceContext<'_>,
        leaf: Bvh8Ref,
        ray: &Ray<R>,
        hit: &mut Hit<R>,
    ) {
        triangle::intersect_four::<Q, R, F>(context, &context.bvh8.triangles[leaf.index()], ray, hit);
    }
}

/// Does the query consider this primitive? Only opaque objects cast shadows (thesis 3.2).
#[inline(always)]
pub(super) fn counts<Q: Query>(effects: Effects, primitive: &Primitive) -> bool {
    !(Q::ANY && effects.has(Effects::TRANSPARENT) && primitive.is_transparent())
}

/// Where on its surface a ray has hit a primitive, or zeros if it has hit none: the weights of a triangle's second and third
/// vertex, the octahedral coordinates of a sphere's normal, or a disk's coordinates along its tangents, in radii.
///
/// A CPU keeps them with the hit. A GPU recomputes them, from the same numbers to the same bits: the fewer registers a
/// ray takes, the more rays it can switch to while one waits for memory.
#[inline(always)]
pub fn coordinates<R: Scalar>(context: &TraceContext<'_>, ray: &Ray<R>, hit: &Hit<R>) -> (R, R) {
    if cfg!(not(target_arch = "spirv")) {
        return hit.coordinates();
    }
    if hit.primitive_index == Hit::<R>::NOTHING {
        return (R::splat(0.0), R::splat(0.0));
    }
    let primitive = context.base.placed(hit.primitive_index, hit.instance, ray.time);
    let effects = context.base.spec.effects;
    if effects.has(Effects::SPHERE) && primitive.is_sphere() {
        sphere::coordinates(&primitive, ray)
    } else if effects.has(Effects::DISK) && primitive.is_disk() {
        disk::coordinates(&primitive, ray)
    } else {
        triangle::weights(context, &primitive, ray)
    }
}
