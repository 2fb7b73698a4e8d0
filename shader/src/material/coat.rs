//! A clear layer over all else (KHR_materials_clearcoat): facets of the index of refraction 1.5 with a normal of their own.

use super::albedo::{Albedos, FacetAlbedo};
use super::frame::{half, local, world};
use super::fresnel::schlick;
use super::{Ggx, reflect};
use crate::data::Effects;
use crate::geometry::tangents;
use crate::real::{FAINT, Real, SMALL, Scalar, V3};
use glam::{UVec4, Vec3};

/// What it reflects at normal incidence.
const NORMAL: f32 = 0.04;

/// A coat, seen from a viewer.
#[derive(Clone, Copy)]
pub struct Coat<R: Real> {
    /// What it reflects of light to the viewer.
    pub albedo: R,
    /// Is it a mirror?
    pub is_smooth: bool,
    /// How much of the surface it is on.
    weight: R,
    ggx: Ggx<R>,
    /// The axes of its frame; the third is its normal.
    axes: [V3<R>; 3],
    /// Unit direction to the viewer, in the frame.
    viewer: V3<R>,
}

impl<R: Scalar> Coat<R> {
    /// No coat.
    #[inline(always)]
    pub fn none() -> Self {
        let (zero, up) = (R::splat(0.0), V3::splat(Vec3::Z));
        let (ggx, axes) = (Ggx { x: zero, y: zero }, [V3::splat(Vec3::X), V3::splat(Vec3::Y), up]);
        Coat { albedo: zero, is_smooth: true, weight: zero, ggx, axes, viewer: up }
    }

    /// One of a weight in [0, 1] and a unit normal, seen along a unit direction from the normal's side.
    #[inline(always)]
    pub fn new(
        effects: Effects,
        albedos: Albedos<'_>,
        (normal, direction): (V3<R>, V3<R>),
        (weight, ggx): (R, Ggx<R>),
    ) -> Self {
        let [x, y] = tangents(normal);
        let axes = [x, y, normal];
        let own = local(axes, -direction);
        let viewer = V3::new(own.x, own.y, own.z.max(R::splat(SMALL)));
        let is_smooth = ggx.x.eq(R::splat(0.0));
        let one_way = if effects.has(Effects::COMPENSATED) && !is_smooth {
            let (near, grazing) = FacetAlbedo::new(Effects(0), ggx).reflected(albedos, viewer);
            near * R::splat(NORMAL) + grazing
        } else {
            fresnel(viewer.z)
        };
        Coat { albedo: weight * one_way, is_smooth, weight, ggx, axes, viewer }
    }

    /// Is it a mirror, or so rough that it scatters widely?
    #[inline(always)]
    pub fn is_wide(&self) -> bool {
        self.is_smooth || self.ggx.is_wide()
    }

    /// What it sends to the viewer of light from a unit direction, with its own cosine, and the density with which it is sampled.
    #[inline(always)]
    pub fn scattering(&self, direction: V3<R>) -> (R, R) {
        let (zero, to) = (R::splat(0.0), local(self.axes, direction));
        if self.is_smooth || !zero.lt(to.z) {
            return (zero, zero);
        }
        let h = half(self.viewer, to);
        let (mirrored, likely) = self.ggx.reflected(self.viewer, to, h);
        (self.weight * fresnel(self.viewer.dot(h)) * mirrored, likely)
    }

    /// The direction in which a facet sends the path, in the world.
    #[inline(always)]
    pub fn sample(&self, pair: UVec4) -> V3<R> {
        let up = V3::splat(Vec3::Z);
        let h = if self.is_smooth { up } else { self.ggx.visible(self.viewer, (pair.x, pair.y)) };
        world(self.axes, reflect(-self.viewer, h).map(|c| c.flush(SMALL)))
    }

    /// What a mirror reflects of light to the viewer.
    #[inline(always)]
    pub fn mirrored(&self) -> R {
        (self.weight * fresnel(self.viewer.z)).flush(FAINT)
    }
}

#[inline(always)]
fn fresnel<R: Scalar>(cosine: R) -> R {
    let cosine = cosine.max(R::splat(0.0)).min(R::splat(1.0));
    R::splat(NORMAL) + R::splat(1.0 - NORMAL) * schlick(cosine)
}
