//! Facets of a rough surface, distributed as Trowbridge and Reitz (GGX) have it, with Smith's masking, correlated by height (Heitz,
//! Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs, 2014).
//!
//! Directions are in the frame of the surface, whose normal is the third axis, point away from it, and are zero or at least 2^-40
//! in each component.

use super::INVERSE_PI;
use crate::light::on_circle;
use crate::real::{Real, SMALL, Scalar, V3};
use crate::sampler::unit;

/// Facets by their roughness along two axes, each in [`Ggx::LEAST`, 1].
#[derive(Clone, Copy)]
pub struct Ggx<R: Real> {
    /// Along the first axis.
    pub x: R,
    /// Along the second.
    pub y: R,
}

impl<R: Scalar> Ggx<R> {
    /// Is it so rough that light of a direction goes to half of all others?
    #[inline(always)]
    pub fn is_wide(self) -> bool {
        /// The square of the perceived roughness of 1/4.
        const LEAST: f32 = 1.0 / 16.0;
        R::splat(LEAST).le(self.y)
    }
}

// Functions of their own on the GPU, so that a module holds them once.
impl<R: Scalar> Ggx<R> {
    /// The least roughness that is told from a mirror: the cone of its highlight is a tenth of a degree wide.
    pub const LEAST: f32 = 1.0 / 1024.0;

    /// Facets' area for a unit of solid angle around the unit vector `h`, over that of the surface: equation 84 of Heitz.
    #[cfg_attr(target_arch = "spirv", inline(never))]
    #[cfg_attr(not(target_arch = "spirv"), inline(always))]
    pub fn density(self, h: V3<R>) -> R {
        // The equation's fraction extended by the fourth power of both, of which the least is 2^-80: one division of three.
        let both = self.x * self.y;
        let (x, y, z) = ((h.x * self.y).flush(SMALL), (h.y * self.x).flush(SMALL), (h.z * both).flush(SMALL));
        let sum = x * x + y * y + z * z;
        (R::splat(INVERSE_PI) * both * both * both).over(sum * sum)
    }

    /// The length of a unit vector where the surface is stretched until it is as rough as a sphere.
    #[cfg_attr(target_arch = "spirv", inline(never))]
    #[cfg_attr(not(target_arch = "spirv"), inline(always))]
    pub fn stretched(self, w: V3<R>) -> R {
        let v = self.stretch(w);
        v.dot(v).sqrt()
    }

    #[inline(always)]
    fn stretch(self, w: V3<R>) -> V3<R> {
        V3::new((w.x * self.x).flush(SMALL), (w.y * self.y).flush(SMALL), w.z)
    }

    /// The normal of a facet that is seen along `-w`, in proportion to its area as seen from there (Dupuy and Benyoub, Sampling
    /// Visible GGX Normals with Spherical Caps, 2023). The third component of `w` is above zero; so is that of the result, or
    /// all of it is zero.
    #[cfg_attr(target_arch = "spirv", inline(never))]
    #[cfg_attr(not(target_arch = "spirv"), inline(always))]
    pub fn visible(self, w: V3<R>, (height, angle): (u32, u32)) -> V3<R> {
        let (zero, one) = (R::splat(0.0), R::splat(1.0));
        let from = self.stretch(w).direction_and_length().0;
        // One less the height in the cap, so that nothing is lost near its pole.
        let below = R::splat(unit(height)) * (one + from.z);
        let across = (below * (one + one - below)).max(zero).sqrt();
        let (x, y) = on_circle::<R>(angle);
        let h = V3::new(
            (across * x + from.x) * self.x,
            (across * y + from.y) * self.y,
            (one - below + from.z).max(R::splat(SMALL)),
        );
        h.map(|c| c.flush(SMALL)).direction_and_length().0.map(|c| c.flush(SMALL))
    }

    /// What mirrors by facets send from the unit vector `from` to `to` over the irradiance, for a unit of what a facet reflects,
    /// with the cosine of `to`; and the density over solid angle of `to` where facets are sampled as they are [`visible`](Self::visible).
    /// Both vectors are on the surface's side; `h` is the one half-way.
    #[cfg_attr(target_arch = "spirv", inline(never))]
    #[cfg_attr(not(target_arch = "spirv"), inline(always))]
    pub fn reflected(self, from: V3<R>, to: V3<R>, h: V3<R>) -> (R, R) {
        let half = self.density(h) * R::splat(0.5);
        let (own, other) = (self.stretched(from), self.stretched(to));
        ((half * to.z).over(own * to.z + other * from.z), half.over(from.z + own))
    }
}
