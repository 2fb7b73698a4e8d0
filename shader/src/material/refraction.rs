//! Rough glass: facets that refract (Walter and others, Microfacet Models for Refraction through Rough Surfaces, 2007).

use super::Ggx;
use crate::real::{FAINT, SMALL, Scalar, V3};

/// The normal of the facets that refract light between the unit vectors `from`, on the near side, and `to`, on the far side, turned
/// to the near side; `eta` is the index of refraction on the near side over that on the far side. Zero if there is none.
#[inline(always)]
pub fn refracting<R: Scalar>(from: V3<R>, to: V3<R>, eta: R) -> V3<R> {
    let zero = R::splat(0.0);
    let h = (from * eta + to).map(|c| c.flush(SMALL)).direction_and_length().0.map(|c| c.flush(SMALL));
    let h = V3::select(h.z.lt(zero), -h, h);
    // Such a facet would have both on one side.
    let is_between = zero.lt(h.z) && zero.lt(h.dot(from)) && h.dot(to).lt(zero);
    V3::select(is_between, h, V3::zero())
}

/// What facets of normal `h` send from `to` to `from` over the irradiance, for a unit of what a facet lets pass, with the cosine of
/// `to`; and the density over solid angle of `to` where facets are sampled as they are visible. Radiance is compressed into the
/// narrower cones of a denser body.
// A function of its own on the GPU, so that a module holds it once.
#[cfg_attr(target_arch = "spirv", inline(never))]
#[cfg_attr(not(target_arch = "spirv"), inline(always))]
pub fn refracted<R: Scalar>(ggx: Ggx<R>, from: V3<R>, to: V3<R>, h: V3<R>, eta: R) -> (R, R) {
    let far = -to.z;
    let (near_cosine, far_cosine) = (from.dot(h), -to.dot(h));
    let sum = (eta * near_cosine - far_cosine).flush(SMALL);
    if sum.eq(R::splat(0.0)) {
        return (R::splat(0.0), R::splat(0.0));
    }
    let facets = (near_cosine * far_cosine).flush(SMALL).over(sum * sum) * ggx.density(h);
    let facets = (facets + facets).flush(FAINT);
    let (own, other) = (ggx.stretched(from), ggx.stretched(to));
    let value = (facets * eta * eta * far).over(own * far + other * from.z);
    (value, facets.over(from.z + own))
}
