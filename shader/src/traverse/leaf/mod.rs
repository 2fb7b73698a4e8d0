//! What the leaves of a hierarchy hold. Every traversal method takes it as a type, as it takes what a ray searches for.

mod crossings;
mod cutout;
mod disk;
mod hidden;
mod primitives;
mod sphere;
#[cfg(test)]
mod tests;
mod triangle;

pub use crossings::{Crossings, crossing_weights};
pub use cutout::Cutout;
#[cfg(not(target_arch = "spirv"))]
pub use primitives::Triangles;
pub use primitives::{Primitives, coordinates};

use super::Query;
#[cfg(not(target_arch = "spirv"))]
use crate::bvh8::Bvh8Ref;
use crate::data::Primitive;
use crate::ray::{Hit, Ray};
#[cfg(not(target_arch = "spirv"))]
use crate::real::{Lanes, Scalar};
use crate::real::{Mask, Real};
use crate::scene::TraceContext;

/// What leaves hold, and how rays meet it. A leaf's box must contain the own box of all that it holds, in which a hit must lie, see
/// `accept`.
pub trait Leaf {
    /// Tests what is at an index in leaf order in a copy of a mesh, or in none, and takes the hit if it is the best so far.
    fn intersect<Q: Query, R: Real>(context: &TraceContext<'_>, place: (u32, u32), ray: &Ray<R>, hit: &mut Hit<R>);

    /// Tests a leaf of the hierarchy that a CPU loads, with as many of its contents at once as there are lanes.
    #[cfg(not(target_arch = "spirv"))]
    fn intersect_block<Q: Query, R: Scalar, F: Lanes<R>>(
        context: &TraceContext<'_>,
        leaf: Bvh8Ref,
        ray: &Ray<R>,
        hit: &mut Hit<R>,
    );
}

/// The limit of an any-hit ray that has found something: no box lies before it.
const FOUND: f32 = -1.0;

/// Has an any-hit ray found something opaque?
#[inline(always)]
pub fn occluded<R: Real>(hit: &Hit<R>) -> R::Mask {
    hit.t.lt(R::splat(0.0))
}

/// Where a ray meets a primitive.
struct Meeting<R: Real> {
    /// In which lanes?
    inside: R::Mask,
    /// The distance.
    t: R,
    /// The place on its surface, each to be multiplied by `scale`; see [`Hit`].
    u: R,
    v: R,
    scale: R,
}

/// A primitive by its index in leaf order, its number in the scene, and the copy of a mesh that it is in.
#[derive(Clone, Copy)]
struct Identity {
    index: u32,
    number: u32,
    instance: u32,
}

impl Identity {
    /// One that is in no copy.
    #[inline(always)]
    fn alone(index: u32, primitive: &Primitive) -> Self {
        Self::within(index, Hit::<f32>::NOTHING, primitive)
    }

    /// One that is in a copy, if it is in one.
    #[inline(always)]
    fn within(index: u32, instance: u32, primitive: &Primitive) -> Self {
        Identity { index, number: primitive.number(), instance }
    }
}

/// Takes the lesser (t, primitive).
///
/// A hit lies in the padded box of what was hit, so in every box that leads here: no order of visits can have culled it. A part of a
/// split triangle may find a hit in another part, which has the same t there.
#[inline(always)]
fn accept<Q: Query, R: Real>(met: Meeting<R>, of: Identity, hit: &mut Hit<R>) {
    let Identity { index, number, instance } = of;
    // Of what a ray starts in, rounding may put the end behind it.
    let (inside, t) = (met.inside, met.t.max(R::splat(0.0)));
    if Q::ANY {
        hit.t = R::select(inside & t.lt(hit.t), R::splat(FOUND), hit.t);
        return;
    }
    let tie = t.eq(hit.t) & R::precedes(number, hit.primitive);
    let better = inside & (t.lt(hit.t) | tie);
    if better.any() {
        hit.t = R::select(better, t, hit.t);
        if cfg!(not(target_arch = "spirv")) {
            hit.u = R::select(better, met.u, hit.u);
            hit.v = R::select(better, met.v, hit.v);
            hit.scale = R::select(better, met.scale, hit.scale);
        }
        hit.primitive_index = R::select_index(better, R::index(index), hit.primitive_index);
        hit.primitive = R::select_index(better, R::index(number), hit.primitive);
        hit.instance = R::select_index(better, R::index(instance), hit.instance);
    }
}
