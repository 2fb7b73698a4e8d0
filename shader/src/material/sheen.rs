//! Fibres like those of velvet (Zeltner, Burley and Chiang, Practical Multiple-Scattering Sheen Using Linearly Transformed Cosines,
//! 2022): a cosine's lobe, stretched and sheared in the plane of normal and viewer, by the rational fits to the paper's tables that
//! MaterialX publishes.

use super::{INVERSE_PI, cosine_direction};
use crate::real::{FAINT, Real, SMALL, Scalar, V3};
use glam::{UVec4, Vec3};

/// Fibres, seen from a viewer. Directions are in the frame of the surface.
#[derive(Clone, Copy)]
pub struct Sheen<R: Real> {
    /// What they scatter of light to the viewer, linear RGB.
    pub albedo: V3<R>,
    /// By how much the inverse transform stretches the plane, and shears it along the viewer.
    inverse: (R, R),
    /// The unit direction of the viewer in the plane.
    along: (R, R),
}

impl<R: Scalar> Sheen<R> {
    /// The least roughness: lobes are not narrower.
    const LEAST: f32 = 1.0 / 64.0;

    /// No fibres.
    #[inline(always)]
    pub fn none() -> Self {
        let (zero, one) = (R::splat(0.0), R::splat(1.0));
        Sheen { albedo: V3::zero(), inverse: (one, zero), along: (one, zero) }
    }

    /// Those of a colour and a roughness in [0, 1], seen from a unit direction on the surface's side.
    #[inline(always)]
    pub fn new(viewer: V3<R>, colour: V3<R>, roughness: R) -> Self {
        let (zero, one) = (R::splat(0.0), R::splat(1.0));
        let (x, y) = (viewer.z.max(zero).min(one), roughness.max(R::splat(Self::LEAST)).min(one));
        let (plane, length) = V3::new(viewer.x, viewer.y, zero).map(|c| c.flush(SMALL)).direction_and_length();
        let is_above = length.eq(zero);
        let along = (R::select(is_above, one, plane.x), R::select(is_above, zero, plane.y));
        Sheen { albedo: colour * albedo(x, y).flush(FAINT), inverse: inverse(x, y), along }
    }

    /// A vector of the frame, turned until the viewer is above the first axis.
    #[inline(always)]
    fn turned(&self, v: V3<R>) -> V3<R> {
        let (c, s) = self.along;
        V3::new(v.x * c + v.y * s, v.y * c - v.x * s, v.z).map(|c| c.flush(SMALL))
    }

    /// The density over solid angle of light to the viewer from a unit direction above the surface.
    #[inline(always)]
    pub fn density(&self, to: V3<R>) -> R {
        let ((stretch, shear), own) = (self.inverse, self.turned(to));
        let (x, y) = ((own.x * stretch).flush(SMALL) + (own.z * shear).flush(SMALL), (own.y * stretch).flush(SMALL));
        let square = (x.flush(SMALL) * x.flush(SMALL) + y * y + own.z * own.z).max(R::splat(SMALL));
        let ratio = stretch.over(square);
        (own.z * R::splat(INVERSE_PI)).flush(SMALL) * (ratio * ratio)
    }

    /// A unit direction by that density.
    #[inline(always)]
    pub fn sample(&self, pair: UVec4) -> V3<R> {
        let (stretch, shear) = self.inverse;
        let lobe = cosine_direction(V3::<R>::splat(Vec3::Z), (pair.x, pair.y)).0.map(|c| c.flush(SMALL));
        let over = stretch.reciprocal();
        let (x, y) = ((lobe.x - (lobe.z * shear).flush(SMALL)) * over, lobe.y * over);
        let own = V3::new(x, y, lobe.z).map(|c| c.flush(SMALL)).direction_and_length().0;
        let (c, s) = self.along;
        V3::new(own.x * c - own.y * s, own.x * s + own.y * c, own.z).map(|c| c.flush(SMALL))
    }
}

/// The share of light to the viewer that white fibres scatter, by the viewer's cosine and the roughness: a Gaussian's fit.
// A function of its own, since few surfaces have fibres.
#[inline(never)]
fn albedo<R: Scalar>(x: R, y: R) -> R {
    /// `1 / (2 ln 2)`, and `1 / sqrt(2 pi)`.
    const OVER: (f32, f32) = (0.721_347_5, 0.398_942_3);
    let of = |c: f32| R::splat(c);
    let width = (y * (of(0.020_660_7) + of(1.584_91) * y)).over(of(0.037_942_4) + y * (of(1.322_27) + y));
    let cubic = of(-1.148_85) + y * (of(1.793_2) - of(0.959_43) * y * y);
    let middle = (y * (of(-0.193_854) + y * cubic)).over(of(0.046_391) + y);
    let rest = (y * (of(0.000_654_023) + (of(-0.020_781_8) + of(0.119_681) * y) * y))
        .over(of(1.262_64) + y * (of(-1.920_21) + y));
    let off = (x - middle).over(width).flush(SMALL);
    let bell = of(0.5).pow((off * off * of(OVER.0)).min(of(127.0)));
    ((bell * of(OVER.1)).flush(SMALL).over(width) + rest).max(of(0.0)).min(of(1.0))
}

/// The inverse transform's stretch and shear, likewise.
// A function of its own, since few surfaces have fibres.
#[inline(never)]
fn inverse<R: Scalar>(x: R, y: R) -> (R, R) {
    let (of, one) = (|c: f32| R::splat(c), R::splat(1.0));
    let stretch = ((of(2.581_26) * x + of(0.813_703) * y) * y).over(one + of(0.310_327) * x * x + of(2.609_94) * x * y);
    let below = of(0.000_025_405_3) + of(1.712_28) * x - of(1.715_06) * x * y + of(1.341_74) * y * y;
    let shear = ((one - x).sqrt() * (y - one) * y * y * y).over(below);
    (stretch, shear)
}
