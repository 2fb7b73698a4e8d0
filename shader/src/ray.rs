//! A ray, prepared for box and triangle tests, and its hit.

#[cfg(not(target_arch = "spirv"))]
use crate::real::Scalar;
use crate::real::{Real, SMALL, TINY, V3};
use glam::Vec3;

/// A ray (or one a lane) with the values that its box and triangle tests share.
#[derive(Clone, Copy)]
pub struct Ray<R: Real> {
    /// Where it starts, in the normalised scene.
    pub origin: V3<R>,
    /// One over the direction; a component below 2^-60, or that is NaN, counts as 2^-60, so that no infinity arises.
    pub inverse: V3<R>,
    /// The origin times the inverse.
    pub offset: V3<R>,
    /// The shear that turns the direction into the third axis.
    pub shear: Shear<R>,
    /// The primitive that it starts on, which it can't hit again; [`Hit::NOTHING`] for none.
    pub source_primitive: R::Index,
}

/// Woop, Benthin and Wald 2013: the ray's space, in which a triangle is tested in two dimensions.
#[derive(Clone, Copy)]
pub struct Shear<R: Real> {
    /// How far the first axis moves along the ray.
    pub x: R,
    /// How far the second axis moves along the ray.
    pub y: R,
    /// Is the direction's greatest component its first?
    x_major: R::Mask,
    /// Is it its second?
    y_major: R::Mask,
}

impl<R: Real> Ray<R> {
    /// A ray that starts on no triangle; `direction` needs no unit length (t counts in its lengths), but must not be
    /// zero.
    #[inline(always)]
    pub fn new(origin: V3<R>, direction: V3<R>) -> Self {
        Self::leaving(R::index(Hit::<R>::NOTHING), origin, direction)
    }

    /// A ray that starts on a triangle.
    #[inline(always)]
    pub fn leaving(source_primitive: R::Index, origin: V3<R>, direction: V3<R>) -> Self {
        Self::prepared(source_primitive, origin, direction, false)
    }

    /// A ray from a finite place that may lie outside the cube [-1, 1]. The scene lies in that cube, and the errors of the tests of
    /// boxes and triangles are bounded for coordinates of its size (docs/numerics.md): if it starts outside, the ray starts
    /// from where it comes close to the cube instead, and t counts from there. It stops short of the cube by more than the
    /// step errs, so that nothing on its faces is passed.
    #[inline(always)]
    pub fn from_afar(origin: V3<R>, direction: V3<R>) -> Self {
        Self::prepared(R::index(Hit::<R>::NOTHING), origin, direction, true)
    }

    #[inline(always)]
    pub(crate) fn prepared(source_primitive: R::Index, origin: V3<R>, direction: V3<R>, from_afar: bool) -> Self {
        // NaN counts as zero too, since its reciprocal differs between devices.
        let d = direction.map(|c| R::select(R::splat(TINY).le(c.abs()), c, R::splat(0.0)));
        let size = d.abs();
        let x_major = size.y.le(size.x) & size.z.le(size.x);
        let y_major = !x_major & size.z.le(size.y);
        let inverse = V3::new(inverted(d.x), inverted(d.y), inverted(d.z));
        let mut shear = Shear { x: d.x, y: d.y, x_major, y_major };
        let (cycled, along) = (shear.cycle(d), shear.cycle(inverse).z);
        shear.x = (cycled.x * along).flush(TINY);
        shear.y = (cycled.y * along).flush(TINY);
        let origin = if from_afar {
            origin + approach(inverse, origin.times(inverse), d)
        } else {
            V3::new(started(origin.x, d.x), started(origin.y, d.y), started(origin.z, d.z))
        };
        Ray { origin, inverse, offset: origin.times(inverse), shear, source_primitive }
    }

    /// A vertex relative to the origin, its axes cycled.
    #[inline(always)]
    pub fn seen(&self, vertex: Vec3) -> V3<R> {
        self.shear.cycle(V3::splat(vertex) - self.origin)
    }

    /// How far the first two axes move along the third, with the axes cycled.
    #[inline(always)]
    pub fn slopes(&self) -> (R, R) {
        (self.shear.x, self.shear.y)
    }

    /// One over the direction's major component.
    #[inline(always)]
    pub fn along(&self) -> R {
        self.shear.cycle(self.inverse).z
    }
}

/// One over a direction's component, which is zero or at least 2^-60.
#[inline(always)]
fn inverted<R: Real>(component: R) -> R {
    let least = R::select(component.lt(R::splat(0.0)), R::splat(-TINY), R::splat(TINY));
    R::select(component.eq(R::splat(0.0)), least, component).reciprocal()
}

/// The step that takes a ray along its direction close to the cube [-1, 1]: none if it starts inside.
#[inline(always)]
fn approach<R: Real>(inverse: V3<R>, offset: V3<R>, direction: V3<R>) -> V3<R> {
    // Minus the distances at which the ray enters the slabs between the cube's faces; the last counts.
    let entry = inverse.abs() + offset;
    let distance = entry.x.min(entry.y).min(entry.z) * R::splat(SHORT_SHARE - 1.0) - R::splat(SHORT);
    // What is added is no tinier than what the host gives, so that no coordinate is subnormal.
    (direction * distance.max(R::splat(0.0))).map(|c| c.flush(TINY))
}

/// How far before the cube a ray that comes from outside stops, in lengths of its direction, and by which share of its
/// way: a step of length D errs by some D * 2^-24.
const SHORT: f32 = 1.0 / 64.0;
const SHORT_SHARE: f32 = 1.0 / (1 << 20) as f32;

/// Far outside of a scene within [-1, 1], without overflow when squared.
const BEYOND: f32 = 1.0 / SMALL;

/// A coordinate of a ray's origin; where it is NaN or infinite, one beyond the scene, from where the ray leads away, so
/// that it hits no box on any device.
#[inline(always)]
fn started<R: Real>(origin: R, direction: R) -> R {
    let beyond = R::select(direction.lt(R::splat(0.0)), R::splat(-BEYOND), R::splat(BEYOND));
    R::select(origin.abs().le(R::splat(f32::MAX)), origin, beyond)
}

impl<R: Real> Shear<R> {
    /// Cycles the axes so that the ray's major one is the third; keeps handedness.
    #[inline(always)]
    pub fn cycle(&self, v: V3<R>) -> V3<R> {
        let pick = |x, y, z| R::select(self.x_major, x, R::select(self.y_major, y, z));
        V3::new(pick(v.y, v.z, v.x), pick(v.z, v.x, v.y), pick(v.x, v.y, v.z))
    }
}

/// The closest hit so far (or one a lane).
#[derive(Clone, Copy)]
pub struct Hit<R: Real> {
    /// Distance in lengths of the ray's direction. Nothing beyond counts.
    pub t: R,
    /// Weight of the triangle's second vertex, to be multiplied by `scale`. Both weights and the scale are kept on a
    /// CPU only, see [`step::weights`](crate::traverse::step::weights).
    pub u: R,
    /// Weight of the third, likewise.
    pub v: R,
    /// The factor of the weights, see [`Hit::weights`].
    pub scale: R,
    /// The triangle's index in leaf order; [`Hit::NOTHING`] if there is no hit.
    pub triangle_index: R::Index,
    /// The triangle's number in the scene, which decides ties.
    pub primitive: R::Index,
}

impl<R: Real> Hit<R> {
    /// The triangle index of a miss.
    pub const NOTHING: u32 = u32::MAX;

    /// No hit up to `limit`.
    #[inline(always)]
    pub fn none(limit: R) -> Self {
        let nothing = R::index(Self::NOTHING);
        Hit {
            t: limit,
            u: R::splat(0.0),
            v: R::splat(0.0),
            scale: R::splat(1.0),
            triangle_index: nothing,
            primitive: nothing,
        }
    }

    /// Weights of the triangle's second and third vertex.
    #[inline(always)]
    pub fn weights(&self) -> (R, R) {
        (self.u * self.scale, self.v * self.scale)
    }
}

#[cfg(not(target_arch = "spirv"))]
impl<R: Scalar> Shear<R> {
    /// The axis of the direction's greatest component; that of [`Shear::cycle`]'s third.
    #[inline(always)]
    pub(crate) fn major(&self) -> usize {
        if self.x_major { 0 } else { 2 - self.y_major as usize }
    }
}

#[cfg(target_arch = "x86_64")]
impl<R: Real> Shear<R> {
    /// The same shear of other numbers.
    #[inline(always)]
    pub(crate) fn each<T: Real>(&self, f: fn(R) -> T, mask: fn(R::Mask) -> T::Mask) -> Shear<T> {
        Shear { x: f(self.x), y: f(self.y), x_major: mask(self.x_major), y_major: mask(self.y_major) }
    }
}

#[cfg(not(target_arch = "spirv"))]
impl<const N: usize> Shear<crate::real::F32xN<N>> {
    /// One lane's shear.
    #[inline(always)]
    pub(crate) fn lane(&self, i: usize) -> Shear<f32> {
        let (x_major, y_major) = (self.x_major.0[i] != 0, self.y_major.0[i] != 0);
        Shear { x: self.x.0[i], y: self.y.0[i], x_major, y_major }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_from_afar_come_close_to_the_scene_and_others_stay() {
        let vector = |v: Vec3| V3::<f32>::new(v.x, v.y, v.z);
        let approached = |origin: Vec3, direction: Vec3| {
            let near = Ray::from_afar(vector(origin), vector(direction)).origin;
            Vec3::new(near.x, near.y, near.z)
        };
        for inside in [Vec3::ZERO, Vec3::ONE, Vec3::new(-1.0, 0.5, 0.25)] {
            assert_eq!(approached(inside, Vec3::X), inside);
        }
        for distance in [1.5f32, 3.0, 100.0, 1e4, 1e6] {
            for target in [Vec3::ZERO, Vec3::new(0.9, -0.9, 0.3), Vec3::new(-1.0, 1.0, 0.0)] {
                let direction = Vec3::new(0.3, -0.5, -0.8).normalize();
                let origin = target - direction * (2.0 * distance);
                let near = approached(origin, direction);
                let size = near.abs().max_element();
                // Outside, so that nothing is passed, and at a distance that the errors are bounded for.
                assert!(size > 1.0 && size < 1.0 + 2.0 * SHORT + 2e-6 * distance, "{distance}, {target}: {near}");
                let beside = (near - target) - direction * (near - target).dot(direction);
                assert!(beside.length() < 1e-6 * distance.max(1.0), "{distance}, {target}: {near} is beside the ray");
            }
        }
        for side in [-3.0, 3.0] {
            let aside = Vec3::new(side, 0.0, 0.0);
            assert_eq!(approached(aside, Vec3::X * side.signum()), aside, "what goes away stays");
            let passing = approached(aside, Vec3::Y);
            assert!(passing.abs().max_element() >= 3.0 && passing.is_finite(), "what passes by stays outside");
        }
    }
}
