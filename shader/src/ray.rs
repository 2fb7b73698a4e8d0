//! A ray, prepared for the tests of boxes and primitives, and its hit.

#[cfg(not(target_arch = "spirv"))]
use crate::real::{Lanes, Scalar};
use crate::real::{Real, SMALL, TINY, V3};
use glam::Vec3;

/// A ray (or one a lane) with the values that its tests of boxes and primitives share.
#[derive(Clone, Copy)]
pub struct Ray<R: Real> {
    /// Where it starts, in the normalised scene.
    pub origin: V3<R>,
    /// Where it goes, without components below 2^-60.
    pub direction: V3<R>,
    /// One over the direction; a component that is zero counts as 2^-40 of the greatest, so that no infinity arises: over the whole scene
    /// that is less than any rounding.
    pub inverse: V3<R>,
    /// The origin times the inverse.
    pub offset: V3<R>,
    /// The shear that turns the direction into the third axis.
    pub shear: Shear<R>,
    /// The primitive that it starts on, which it can't hit again; [`Hit::NOTHING`] for none. With [`Ray::INSIDE`] it can, on
    /// the far side.
    pub source_primitive: R::Index,
    /// When it is, of all lanes: from 0, where the shutter opens, to 1, where it closes.
    pub time: f32,
    /// Crossings nearer than this, and there those of triangles up to the one that it starts on, are behind it: only
    /// [`Crossings`](crate::traverse::Crossings) ask.
    pub behind: R,
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
    /// The bit of [`Ray::source_primitive`] for a ray that starts on a sphere and goes through its inside, which it leaves
    /// on the far side.
    pub const INSIDE: u32 = 1 << 31;
    /// In place of a primitive, for a shadow ray that starts on a shadow catcher: it meets none of them.
    pub const OF_CATCHER: u32 = Self::INSIDE - 1;
    /// In place of a primitive, for a ray that starts above a surface, and may meet it.
    pub const OF_SURFACE: u32 = Self::INSIDE - 2;

    /// A ray that starts on no primitive; `direction` needs no unit length (t counts in its lengths), but must not be
    /// zero.
    #[inline(always)]
    pub fn new(origin: V3<R>, direction: V3<R>) -> Self {
        Self::leaving(R::index(Hit::<R>::NOTHING), origin, direction)
    }

    /// A ray that starts on a primitive.
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
        // What goes nowhere goes somewhere, slowly: all tests of it must agree.
        let d = V3::new(R::select(d.abs().greatest().eq(R::splat(0.0)), R::splat(TINY), d.x), d.y, d.z);
        let size = d.abs();
        let x_major = size.y.le(size.x) & size.z.le(size.x);
        let y_major = !x_major & size.z.le(size.y);
        let least = size.greatest() * R::splat(SMALL);
        let inverse = d.map(|c| R::select(c.eq(R::splat(0.0)), least, c).reciprocal());
        let mut shear = Shear { x: d.x, y: d.y, x_major, y_major };
        let (cycled, along) = (shear.cycle(d), shear.cycle(inverse).z);
        shear.x = (cycled.x * along).flush(TINY);
        shear.y = (cycled.y * along).flush(TINY);
        let origin = if from_afar {
            origin + approach(inverse, origin.times(inverse), d)
        } else {
            V3::new(started(origin.x, d.x), started(origin.y, d.y), started(origin.z, d.z))
        };
        Ray {
            origin,
            direction: d,
            inverse,
            offset: origin.times(inverse),
            shear,
            source_primitive,
            time: 0.0,
            behind: R::splat(-1.0),
        }
    }

    /// The same ray at another time.
    #[inline(always)]
    pub fn at(self, time: f32) -> Self {
        Ray { time, ..self }
    }

    /// The same ray past a crossing of a triangle at a distance.
    #[inline(always)]
    pub fn past(self, distance: R, triangle: u32) -> Self {
        Ray { behind: distance, source_primitive: R::index(triangle), ..self }
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

/// Far outside of a scene within [-1, 1], without overflow when multiplied with an inverse, which is at most 2^100.
const BEYOND: f32 = (1 << 24) as f32;

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
    /// The first coordinate of the place on the primitive, to be multiplied by `scale`. Both coordinates and the scale are
    /// kept on a CPU only, see [`coordinates`](crate::traverse::leaf::coordinates).
    pub u: R,
    /// The second, likewise.
    pub v: R,
    /// Their factor, see [`Hit::coordinates`].
    pub scale: R,
    /// The primitive's index in leaf order; [`Hit::NOTHING`] if there is no hit.
    pub primitive_index: R::Index,
    /// The primitive's number in the scene, which decides ties.
    pub primitive: R::Index,
    /// The copy of a mesh that it is in; [`Hit::NOTHING`] for none.
    pub instance: R::Index,
}

impl<R: Real> Hit<R> {
    /// The primitive index of a miss.
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
            primitive_index: nothing,
            primitive: nothing,
            instance: nothing,
        }
    }

    /// Where on the primitive it is: the weights of a triangle's second and third vertex, or as
    /// [`coordinates`](crate::traverse::leaf::coordinates) says.
    #[inline(always)]
    pub fn coordinates(&self) -> (R, R) {
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

#[cfg(not(target_arch = "spirv"))]
impl<R: Real> Shear<R> {
    /// One lane's shear.
    #[inline(always)]
    pub(crate) fn lane<S: Scalar>(&self, i: usize) -> Shear<S>
    where
        R: Lanes<S>,
    {
        let holds = |mask| (R::bits(mask) >> i) & 1 == 1;
        Shear { x: self.x.lane(i), y: self.y.lane(i), x_major: holds(self.x_major), y_major: holds(self.y_major) }
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
