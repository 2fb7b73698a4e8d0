//! Where photons are sent: balls around what mirrors or refracts light.

use crate::buffer::read;
use crate::data::numbers;
use crate::geometry::tangents;
use crate::light::on_circle;
use crate::real::{FAINT, Real, SMALL, Scalar, TINY, V3};
use crate::sampler::unit;
use glam::UVec4;

/// Balls around what casts caustics.
#[derive(Clone, Copy)]
pub struct Casters<'a> {
    /// The middle of them all with how many balls there are, at least one; and two of each: its centre with the last draw that means it,
    /// and its radius and the probability of that.
    pub records: &'a [UVec4],
}

/// A ball.
#[derive(Clone, Copy)]
struct Ball<R: Real> {
    centre: V3<R>,
    radius: R,
    probability: R,
}

/// A ball is seen as a cone where the square of that cone's sine is less: nearer, its rounding counts, and light goes everywhere.
const OUTSIDE: f32 = 1.0 - 1.0 / 4096.0;

impl Casters<'_> {
    #[inline(always)]
    fn ball<R: Scalar>(&self, number: u32) -> Ball<R> {
        let (place, rest) = (read(self.records, 1 + 2 * number), read(self.records, 2 + 2 * number));
        let V3 { x: radius, y: probability, .. } = V3::splat(numbers(rest));
        Ball { centre: V3::splat(numbers(place)), radius, probability }
    }

    #[inline(always)]
    fn count(&self) -> u32 {
        read(self.records, 0).w
    }

    /// The ball of so many that a draw means. Who counts them in a loop and asks for that number behind it gets another one for those
    /// lanes of lavapipe (Mesa 22.3) that left the loop before others.
    #[inline(always)]
    fn drawn(&self, count: u32, draw: u32) -> u32 {
        let mut number = 0;
        while number + 1 < count && read(self.records, 1 + 2 * number).w < draw {
            number += 1;
        }
        number
    }

    /// The middle of them all.
    #[inline(always)]
    pub fn middle<R: Scalar>(&self) -> V3<R> {
        V3::splat(numbers(read(self.records, 0)))
    }

    /// A unit direction from a place to some ball, and the density over solid angle with which it is drawn for any of them.
    #[inline(always)]
    pub fn direction<R: Scalar>(&self, from: V3<R>, choice: u32, pair: (u32, u32)) -> (V3<R>, R) {
        let (zero, one) = (R::splat(0.0), R::splat(1.0));
        let count = self.count();
        let chosen = self.drawn(count, choice);
        let (axis, height) = self.ball(chosen).cone(from);
        let drawn = (R::splat(unit(pair.0)) * height).flush(FAINT);
        let sine = (drawn * (one + one - drawn)).max(zero).sqrt();
        let (x, y) = on_circle::<R>(pair.1);
        let [right, up] = tangents(axis);
        let across = (right * x + up * y).map(|c| c.flush(TINY));
        let direction = (across * sine + axis * (one - drawn)).map(|c| c.flush(TINY));
        let (mut density, mut number) = (zero, 0);
        while number < count {
            let ball = self.ball::<R>(number);
            let (axis, height) = ball.cone(from);
            let is_in = number == chosen || (one - axis.dot(direction)).le(height);
            const PER_TURN: f32 = 0.5 * crate::material::INVERSE_PI;
            let own = (ball.probability * R::splat(PER_TURN)).over(height.max(R::splat(SMALL)));
            density = density + R::select(is_in, own, zero);
            number += 1;
        }
        (direction, density)
    }

    /// A place in the scene where light along a unit direction comes to some ball, and the density over area across it with which it is
    /// drawn for any of them.
    #[inline(always)]
    pub fn place<R: Scalar>(&self, along: V3<R>, choice: u32, pair: (u32, u32)) -> (V3<R>, R) {
        let zero = R::splat(0.0);
        let count = self.count();
        let chosen = self.drawn(count, choice);
        let Ball { centre, radius, .. } = self.ball::<R>(chosen);
        let (x, y) = on_circle::<R>(pair.1);
        let reach = R::splat(unit(pair.0)).sqrt() * radius;
        let [right, up] = tangents(along);
        let across = (right * x + up * y).map(|c| c.flush(SMALL)) * reach;
        let place = (centre + across).map(|c| c.flush(TINY));
        let (mut density, mut number) = (zero, 0);
        while number < count {
            let Ball { centre, radius, probability } = self.ball::<R>(number);
            let from = (place - centre).map(|c| c.flush(SMALL));
            let aside = (from - along * from.dot(along)).map(|c| c.flush(SMALL));
            let square = radius * radius;
            let is_in = number == chosen || aside.dot(aside).le(square);
            let own = (probability * R::splat(crate::material::INVERSE_PI)).over(square.max(R::splat(FAINT)));
            density = density + R::select(is_in, own, zero);
            number += 1;
        }
        (place, density)
    }
}

impl<R: Scalar> Ball<R> {
    /// The axis of the cone in which it is seen, and one less the cosine of half its angle; 2 from inside.
    #[inline(always)]
    fn cone(&self, from: V3<R>) -> (V3<R>, R) {
        let one = R::splat(1.0);
        let away = (self.centre - from).map(|c| c.flush(SMALL));
        let (square, own) = (away.dot(away), (self.radius * self.radius).flush(FAINT));
        let is_outside = own.lt(square * R::splat(OUTSIDE));
        let sine = own.div(R::select(is_outside, square, R::splat(1.0))).flush(FAINT);
        let height = sine.over(one + (one - sine).max(R::splat(0.0)).sqrt());
        let up = V3::splat(glam::Vec3::Z);
        let axis = V3::select(square.eq(R::splat(0.0)), up, away.direction_and_length().0);
        (axis, R::select(is_outside, height, one + one))
    }
}
