//! Fibres of hair (Chiang, Bitterli, Tappan and Burley, A Practical and Controllable Hair and Fur Model for Production Path Tracing,
//! 2016): light that a rough dielectric cylinder reflects, lets through, reflects once inside, and more often. The azimuthal part is
//! exact (d'Eon and others, An Energy-Conserving Hair Reflectance Model, 2011; pbrt, The Implementation of a Hair Scattering Model, 2016).

use super::bsdf::STEPS;
use super::closure::Scattering;
use super::optics::{fresnel, refract};
use crate::data::{Finish, numbers};
use crate::real::{FAINT, Real, SMALL, Scalar, TINY, V3, turns};
use glam::{UVec4, Vec3};

/// The base-2 logarithm of e.
const LOG2_E: f32 = core::f32::consts::LOG2_E;
/// One over a whole turn in radians.
const PER_TURN: f32 = 0.5 * super::INVERSE_PI;
/// How often light is inside, where lobes are told apart; the last holds whatever is inside more often.
const LOBES: u32 = 4;

/// A fibre, seen from a viewer. Directions are in the frame of the surface, whose first axis is along the fibre.
#[derive(Clone, Copy)]
pub struct Hair<R: Real> {
    /// Is it one? Else all of this means nothing.
    pub is_some: bool,
    /// The unit direction of the viewer across the fibre, in the plane of the second and the third axis.
    across: (R, R),
    /// The sine and the cosine of the viewer's elevation above the plane across the fibre.
    elevation: (R, R),
    /// The angle between the viewer and the normal in that plane, outside and inside of the fibre, in turns.
    offsets: (R, R),
    /// What the lobes send to the viewer of light from everywhere, linear RGB.
    sent: [V3<R>; LOBES as usize],
    /// Draws below so many steps of [`STEPS`] mean this lobe or one before it.
    steps: [i32; LOBES as usize],
    /// The variance of the first lobe along the fibre.
    variance: R,
    /// The scale of logistic distributions around it, in turns.
    scale: R,
    /// The sine and the cosine of the angle by which scales lean.
    tilt: (R, R),
}

/// Where a lobe is.
struct Lobe<R> {
    /// The sine and the cosine of the viewer's elevation, turned as the scales lean.
    elevation: (R, R),
    /// The variance along the fibre.
    variance: R,
    /// Its middle around the fibre, in turns from the viewer.
    turn: R,
}

impl<R: Scalar> Hair<R> {
    /// No fibre.
    #[inline(always)]
    pub fn none() -> Self {
        let (zero, one) = (R::splat(0.0), R::splat(1.0));
        Hair {
            is_some: false,
            across: (zero, one),
            elevation: (zero, one),
            offsets: (zero, zero),
            sent: [V3::zero(); LOBES as usize],
            steps: [STEPS; LOBES as usize],
            variance: one,
            scale: one,
            tilt: (zero, one),
        }
    }

    /// That of a [`Finish`], of a colour in [0, 1] and an index of refraction of more than 1, seen from a unit direction above the
    /// surface.
    // A function of its own, since few surfaces are hair.
    #[inline(never)]
    pub fn new(finish: &Finish, viewer: V3<R>, colour: V3<R>, ior: R) -> Self {
        let (zero, one) = (R::splat(0.0), R::splat(1.0));
        let V3 { x: over, y: variance, z: scale } = V3::<R>::splat(numbers(finish.hair));
        let lean = R::splat(f32::from_bits(finish.hair.w));
        let sine = viewer.x.max(-one).min(one);
        let cosine = beside(sine).max(R::splat(SMALL));
        let (plane, length) = V3::new(zero, viewer.y, viewer.z).map(|c| c.flush(SMALL)).direction_and_length();
        let is_along = length.eq(zero);
        let across = (R::select(is_along, zero, plane.y), R::select(is_along, one, plane.z));
        let offset = (-across.0, across.1.max(zero));
        // Seen along the fibre, the plane across it bends more (Marschner and others 2003, section 3).
        let bend = (ior * ior - sine * sine).max(zero).sqrt().over(cosine).max(R::splat(SMALL));
        let inner = offset.0.over(bend).max(-one).min(one);
        let inner = (inner, beside(inner));
        let along = beside(sine.over(ior)).max(R::splat(SMALL));
        let way = (inner.1 + inner.1).over(along);
        let left = colour.map(|c| absorbed(c, over, way));
        let entering = cosine * offset.1;
        let etas = one.over(ior);
        let at = refract(V3::new(beside(entering), zero, -entering), V3::splat(Vec3::Z), etas);
        let reflected = fresnel(&at, etas).max(zero).min(one);
        let sent = shares(reflected, left);
        Hair {
            is_some: true,
            across,
            elevation: (sine, cosine),
            offsets: (turned(offset), turned(inner)),
            sent,
            steps: steps(&sent),
            variance,
            scale,
            tilt: (lean, beside(lean)),
        }
    }

    /// The lobe of light that was so often inside.
    #[inline(always)]
    fn lobe(&self, number: u32) -> Lobe<R> {
        let (two, v) = (R::splat(2.0), self.variance);
        let once = self.tilt;
        let twice = sum_of(once, once);
        let four = sum_of(twice, twice);
        let (elevation, variance) = match number {
            0 => (sum_of(self.elevation, (-twice.0, twice.1)), v),
            1 => (sum_of(self.elevation, once), v * R::splat(0.25)),
            2 => (sum_of(self.elevation, four), v * R::splat(4.0)),
            _ => (self.elevation, v * R::splat(4.0)),
        };
        let inside = R::splat(number as f32);
        let turn = inside * two * self.offsets.1 - two * self.offsets.0 + inside * R::splat(0.5);
        Lobe { elevation: (elevation.0, elevation.1.abs().max(R::splat(SMALL))), variance, turn }
    }

    /// What a lobe sends, and how likely it is drawn.
    #[inline(always)]
    fn share(&self, number: u32) -> (V3<R>, R) {
        const STEP: f32 = 1.0 / STEPS as f32;
        let [a, b, c, _] = self.steps;
        let (sent, steps) = match number {
            0 => (self.sent[0], a),
            1 => (self.sent[1], b - a),
            2 => (self.sent[2], c - b),
            _ => (self.sent[3], STEPS - c),
        };
        (sent, R::splat(steps as f32) * R::splat(STEP))
    }

    /// How light from a unit direction of the frame is scattered. The value has no cosine: a fibre is as wide from everywhere.
    // A function of its own, since few surfaces are hair.
    #[inline(never)]
    pub fn scattering(&self, to: V3<R>) -> Scattering<R> {
        let (one, (y, z)) = (R::splat(1.0), self.across);
        let sine = to.x.max(-one).min(one);
        let elevation = (sine, beside(sine));
        let turn = turned((to.z * y - to.y * z, to.y * y + to.z * z));
        let (mut value, mut density) = (V3::zero(), R::splat(0.0));
        let mut number = 0;
        while number < LOBES {
            let lobe = self.lobe(number);
            let around = if number < LOBES - 1 { logistic(turn - lobe.turn, self.scale) } else { one };
            let likely = along(&lobe, elevation) * around * R::splat(PER_TURN);
            let (sent, share) = self.share(number);
            value = value + (sent * likely).map(|c| c.flush(FAINT));
            density = density + (share * likely).flush(FAINT);
            number += 1;
        }
        Scattering { value, density, diffuse: V3::zero() }
    }

    /// A unit direction of the frame by that density: a step of 2^23 chooses the lobe, a number the angle around the fibre, and a
    /// pair the one along it.
    // A function of its own, since few surfaces are hair.
    #[inline(never)]
    pub fn sample(&self, step: i32, around: u32, pair: UVec4) -> V3<R> {
        let [a, b, c, _] = self.steps;
        let number = if step < a {
            0
        } else if step < b {
            1
        } else if step < c {
            2
        } else {
            3
        };
        let lobe = self.lobe(number);
        let (sine, cosine) = lobe.elevation;
        let (height, wide) = drawn_along(lobe.variance, pair.x);
        let (aside, _) = turns::cos_sin(pair.y);
        let one = R::splat(1.0);
        let sine = (wide * R::splat(aside) * cosine - height * sine).max(-one).min(one);
        let turn = if number < LOBES - 1 { lobe.turn + drawn_around(self.scale, around) } else { middle(around) };
        let ((c, s), cosine) = (cos_sin(turn), beside(sine));
        let (y, z) = self.across;
        V3::new(sine, cosine * (c * y - s * z), cosine * (c * z + s * y)).map(|c| c.flush(SMALL))
    }
}

/// The cosine of a sine, or the sine of a cosine.
#[inline(always)]
fn beside<R: Scalar>(x: R) -> R {
    (R::splat(1.0) - x * x).max(R::splat(0.0)).sqrt()
}

/// The sine and the cosine of a sum of angles that are given so.
#[inline(always)]
fn sum_of<R: Scalar>(a: (R, R), b: (R, R)) -> (R, R) {
    (a.0 * b.1 + a.1 * b.0, a.1 * b.1 - a.0 * b.0)
}

/// The angle of a sine and a cosine, in turns.
#[inline(always)]
fn turned<R: Scalar>((sine, cosine): (R, R)) -> R {
    R::splat(turns::atan2(sine.flush(SMALL).to_f32(), cosine.flush(SMALL).to_f32()))
}

/// e to the power of minus a number of at least 0.
#[inline(always)]
fn fading<R: Scalar>(x: R) -> R {
    R::splat(0.5).pow(x * R::splat(LOG2_E))
}

/// What of light is left behind a way in radii, given the colour that hair of it has (Chiang and others, section 4.2), and one over the number of that
/// fit at the hair's roughness, for the logarithm to the base 2.
#[inline(always)]
fn absorbed<R: Scalar>(colour: R, over: R, way: R) -> R {
    let log = colour.max(R::splat(TINY)).min(R::splat(1.0)).log2() * over;
    fading((log * log).flush(SMALL) * way.flush(SMALL))
}

/// What lobes send, given what is reflected where light meets the fibre and what is left of it on the other side.
#[inline(always)]
fn shares<R: Scalar>(reflected: R, left: V3<R>) -> [V3<R>; LOBES as usize] {
    let one = R::splat(1.0);
    let (passed, inside) = (one - reflected, (left * reflected).map(|c| c.flush(SMALL)));
    let first = left * (passed * passed).flush(SMALL);
    let second = first.times(inside).map(|c| c.flush(FAINT));
    let rest = V3::new(more(second.x, inside.x), more(second.y, inside.y), more(second.z, inside.z));
    [V3::new(reflected, reflected, reflected), first.map(|c| c.flush(FAINT)), second, rest]
}

/// The sum of what is more often inside: each time the same share is left.
#[inline(always)]
fn more<R: Scalar>(second: R, share: R) -> R {
    // Of light that grazes, all is reflected and nothing is inside.
    (second * share).flush(FAINT).over((R::splat(1.0) - share).max(R::splat(SMALL)))
}

/// As many steps for a lobe and those before it as they send.
#[inline(always)]
fn steps<R: Scalar>(sent: &[V3<R>; LOBES as usize]) -> [i32; LOBES as usize] {
    let of = |v: V3<R>| v.x + v.y + v.z;
    let (a, b, c, d) = (of(sent[0]), of(sent[1]), of(sent[2]), of(sent[3]));
    let (first, second, third) = (a, a + b, a + b + c);
    let each = R::splat(STEPS as f32).over((third + d).max(R::splat(FAINT)));
    let steps = |sum: R| (sum * each).floor_index().min(STEPS);
    [steps(first), steps(second), steps(third), STEPS]
}

/// The density over the sine's measure of the elevation of light from there (d'Eon and others 2011): a cosine's lobe on the sphere.
#[inline(always)]
fn along<R: Scalar>(lobe: &Lobe<R>, (sine, cosine): (R, R)) -> R {
    let (zero, one, variance) = (R::splat(0.0), R::splat(1.0), lobe.variance);
    let over = variance.reciprocal();
    let both = cosine * lobe.elevation.1;
    let below = ((one - both + sine * lobe.elevation.0).max(zero) * over).min(R::splat(LEAST_LOG));
    let all = variance * (one - fading(over + over));
    (bessel((both * over).flush(SMALL)) * fading(below)).over(all)
}

/// Logarithms of less than minus that are of nothing.
const LEAST_LOG: f32 = 120.0;

/// The modified Bessel function of the first kind and order 0, over the exponential, of a number of at least 0: Abramowitz and Stegun
/// 9.8.1 and 9.8.2, within 2e-7.
#[inline(always)]
fn bessel<R: Scalar>(x: R) -> R {
    const NEAR: [f32; 7] = [1.0, 3.515_622_9, 3.089_942_4, 1.206_749_2, 0.265_973_2, 0.036_076_8, 0.004_581_3];
    const FAR: [f32; 9] = [
        0.398_942_3,
        0.013_285_92,
        0.002_253_19,
        -0.001_575_65,
        0.009_162_81,
        -0.020_577_06,
        0.026_355_37,
        -0.016_476_33,
        0.003_923_77,
    ];
    const BOUND: f32 = 3.75;
    let bound = R::splat(BOUND);
    if x.lt(bound) {
        const OVER: f32 = 1.0 / BOUND;
        let t = x * R::splat(OVER);
        let square = (t * t).flush(FAINT);
        let mut sum = R::splat(NEAR[6]);
        let mut i = 6;
        while i > 0 {
            i -= 1;
            sum = sum * square + R::splat(NEAR[i]);
        }
        return sum * fading(x);
    }
    let t = bound.over(x);
    let mut sum = R::splat(FAR[8]);
    let mut i = 8;
    while i > 0 {
        i -= 1;
        sum = sum * t + R::splat(FAR[i]);
    }
    sum.over(x.sqrt())
}

/// The density over turns of a logistic distribution within half a turn of its middle, at so many turns from there.
#[inline(always)]
fn logistic<R: Scalar>(from: R, scale: R) -> R {
    let (half, one) = (R::splat(0.5), R::splat(1.0));
    let from = from - R::splat((from + half).floor_index() as f32);
    let over = scale.reciprocal();
    let e = fading((from.abs() * over).min(R::splat(LEAST_LOG)));
    let end = fading(half * over);
    let all = (one - end) * scale * (one + e) * (one + e);
    (e * (one + end)).over(all)
}

/// A number in (0, 1), the middle of those that a draw stands for.
#[inline(always)]
fn middle<R: Scalar>(draw: u32) -> R {
    const STEP: f32 = 1.0 / (1 << 24) as f32;
    R::splat((((draw >> 9) << 1) + 1) as i32 as f32) * R::splat(STEP)
}

/// Turns from its middle by [`logistic`]'s density.
#[inline(always)]
fn drawn_around<R: Scalar>(scale: R, draw: u32) -> R {
    const LN_2: f32 = core::f32::consts::LN_2;
    let (half, one, number) = (R::splat(0.5), R::splat(1.0), middle::<R>(draw));
    let end = fading(half.over(scale));
    // What is below it over what is above.
    let odds = (number + (one - number) * end).over(one - number + number * end);
    (odds.log2() * R::splat(LN_2) * scale).max(-half).min(half)
}

/// The cosine and the sine of the angle from the middle of a lobe of some variance.
#[inline(always)]
fn drawn_along<R: Scalar>(variance: R, draw: u32) -> (R, R) {
    const LN_2: f32 = core::f32::consts::LN_2;
    let (one, two, number) = (R::splat(1.0), R::splat(2.0), middle::<R>(draw));
    let end = fading((two.over(variance)).min(R::splat(LEAST_LOG)));
    let below = -((number + (one - number) * end).log2() * R::splat(LN_2)) * variance;
    let below = below.max(R::splat(0.0)).min(two);
    (one - below, (below * (two - below)).flush(FAINT).sqrt())
}

/// The cosine and the sine of an angle in turns.
#[inline(always)]
fn cos_sin<R: Scalar>(angle: R) -> (R, R) {
    const STEPS: f32 = (1 << 21) as f32;
    let whole = R::splat(angle.floor_index() as f32);
    let steps = ((angle - whole) * R::splat(STEPS)).floor_index() as u32;
    let (cosine, sine) = turns::cos_sin((steps << 11) | (1 << 10));
    (R::splat(cosine), R::splat(sine))
}
