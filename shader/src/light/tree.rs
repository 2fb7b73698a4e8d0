//! One light of many, by how much of its light may arrive (Conty Estevez and Kulla, Importance Sampling of Many Lights with
//! Adaptive Tree Splitting, 2018; PBRT-v4 12.6.3): a way from the root of a hierarchy to a leaf, at each node by a draw.

use super::Viewpoint;
use crate::buffer::read;
use crate::data::{LightNode, numbers};
use crate::real::{FAINT, Real, SMALL, Scalar, V3};

/// Of a probability.
pub(super) const STEPS: u32 = LightNode::STEPS;

/// Digits of a draw beyond those of the steps.
const BEYOND: u32 = 9;

/// What the cosines' rounding is less than: nothing that emits towards a place counts as turned away.
const SLACK: f32 = 1.0 / 1024.0;

/// What is behind an opaque surface counts by this much at least: shading normals are others.
const BEHIND: f32 = 1.0 / 64.0;

/// The least square of a distance that counts.
const NEAREST: f32 = 1.0 / (1u64 << 60) as f32;

/// Nearer to a box than this share of the square of its half diagonal, it is all around.
const OUTSIDE: f32 = 1.0 - 1.0 / 4096.0;

/// What decides where to go on from a node.
#[derive(Clone, Copy)]
pub struct Guide {
    /// A draw, or a trail: from its lowest bit on, 1 for each second child.
    word: u32,
    /// Digits for those that a draw has not any more.
    fresh: u32,
    is_trail: bool,
}

/// An angle between 0 and pi.
#[derive(Clone, Copy)]
struct Angle<R: Real> {
    cosine: R,
    sine: R,
}

/// What was chosen.
#[derive(Clone, Copy)]
pub struct Chosen<R: Real> {
    /// The emitter's number.
    pub emitter: u32,
    /// Zero if there is nothing to choose.
    pub probability: R,
}

impl Guide {
    /// By a draw; other draws give the digits that it has not.
    #[inline(always)]
    pub fn draw(word: u32, others: (u32, u32)) -> Self {
        let fresh = word ^ ((others.0 << 16) | (others.0 >> 16)) ^ others.1;
        Guide { word, fresh, is_trail: false }
    }

    /// Along an emitter's trail.
    #[inline(always)]
    pub fn trail(word: u32) -> Self {
        Guide { word, fresh: 0, is_trail: true }
    }

    /// What is left of a draw.
    #[inline(always)]
    pub fn word(&self) -> u32 {
        self.word
    }

    /// Is it the second of two, of which the first has so many of all `STEPS`?
    #[inline(always)]
    pub fn is_second(&mut self, steps: u32) -> bool {
        if self.is_trail {
            let is_second = self.word & 1 != 0;
            self.word >>= 1;
            return is_second;
        }
        let is_second = steps <= (self.word >> BEYOND);
        let (over, all) = if is_second { (self.word - (steps << BEYOND), STEPS - steps) } else { (self.word, steps) };
        self.fresh = self.fresh.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        self.word = rescaled(over, all, self.fresh >> BEYOND);
        is_second
    }
}

/// A draw of `all << BEYOND` as one of 2^32, by long division in integers: `fresh` has the 23 digits behind the point.
#[inline(always)]
fn rescaled(over: u32, all: u32, fresh: u32) -> u32 {
    let (first, rest) = (over / all, over % all);
    let next = (rest << 9) | (fresh >> 14);
    let (second, rest) = (next / all, next % all);
    let next = (rest << 9) | ((fresh >> 5) & 0x1ff);
    let (third, rest) = (next / all, next % all);
    let last = ((rest << 5) | (fresh & 0x1f)) / all;
    (first << 23) | (second << 14) | (third << 5) | last
}

impl<R: Scalar> Angle<R> {
    #[inline(always)]
    fn of_cosine(cosine: R) -> Self {
        let one = R::splat(1.0);
        let cosine = cosine.max(-one).min(one);
        Angle { cosine, sine: (one - cosine * cosine).max(R::splat(0.0)).sqrt() }
    }

    /// What is left of it beyond another, at least 0.
    #[inline(always)]
    fn less(self, other: Self) -> Self {
        let is_within = other.cosine.le(self.cosine);
        let cosine = (self.cosine * other.cosine + self.sine * other.sine).flush(SMALL);
        let sine = (self.sine * other.cosine - self.cosine * other.sine).flush(SMALL);
        Angle {
            cosine: R::select(is_within, R::splat(1.0), cosine),
            sine: R::select(is_within, R::splat(0.0), sine.max(R::splat(0.0))),
        }
    }
}

/// How much light a node sends, in proportion to others, wherever it arrives.
#[inline(always)]
pub(super) fn intensity<R: Scalar>(node: &LightNode) -> R {
    R::splat(f32::from_bits(node.middle.w))
}

/// How much of a node's light may arrive at a place, in proportion to that of others: zero only if nothing does.
#[inline(always)]
pub(super) fn importance<R: Scalar>(node: &LightNode, view: &Viewpoint<R>) -> R {
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    let away = (V3::<R>::splat(numbers(node.middle)) - view.origin).map(|c| c.flush(SMALL));
    let half = V3::<R>::splat(numbers(node.half));
    let (square, reach) = (away.dot(away), half.dot(half).flush(FAINT));
    let arrives = intensity::<R>(node).over(square.max(reach).max(R::splat(NEAREST))).flush(FAINT);
    if !reach.lt(square * R::splat(OUTSIDE)) {
        return arrives;
    }
    let direction = away.direction_and_length().0;
    // The cone that the box is seen in, of its sphere.
    let sine = reach.over(square).flush(FAINT);
    let around = Angle { cosine: (one - sine).sqrt(), sine: sine.sqrt() };
    let facing = -V3::<R>::splat(numbers(node.axis)).dot(direction).flush(SMALL);
    let facing = if node.has(LightNode::TWO_SIDED) { facing.abs() } else { facing };
    let normals = Angle::of_cosine(R::splat(f32::from_bits(node.half.w)));
    let turned = Angle::of_cosine(facing).less(normals).less(around).cosine + R::splat(SLACK);
    let emitted = if node.has(LightNode::SPREAD) { turned.max(zero) } else { R::select(turned.lt(one), zero, one) };
    let received = if view.side == 0 {
        one
    } else {
        let cosine = view.normal().dot(direction).flush(SMALL);
        Angle::of_cosine(cosine).less(around).cosine.max(R::splat(BEHIND))
    };
    (arrives * (emitted * received).flush(SMALL)).flush(FAINT)
}

/// Of two importances, the steps of the first.
#[inline(always)]
fn steps_of_first<R: Scalar>(first: R, second: R) -> u32 {
    let zero = R::splat(0.0);
    if second.eq(zero) {
        return STEPS;
    }
    if first.eq(zero) {
        return 0;
    }
    // What may arrive may be chosen.
    let steps = (first.over(first + second) * R::splat(STEPS as f32)).floor_index();
    steps.max(1).min(STEPS as i32 - 1) as u32
}

/// The probability of so many steps.
#[inline(always)]
pub(super) fn probability<R: Scalar>(steps: u32) -> R {
    const STEP: f32 = 1.0 / STEPS as f32;
    R::splat(steps as f32) * R::splat(STEP)
}

/// The way to a leaf, as seen from a place: by a draw or, for the same bits of its probability, by its trail. `start` is the probability of the root.
#[inline(always)]
pub fn descend<R: Scalar>(nodes: &[LightNode], view: &Viewpoint<R>, start: R, guide: Guide) -> Chosen<R> {
    descend_by(nodes, |node: &LightNode| importance(node, view), start, guide)
}

/// The same by what nodes have of something.
#[inline(always)]
pub(super) fn descend_by<R: Scalar>(
    nodes: &[LightNode],
    importance: impl Fn(&LightNode) -> R,
    start: R,
    guide: Guide,
) -> Chosen<R> {
    let zero = R::splat(0.0);
    let (mut guide, mut at, mut likely) = (guide, 0, start);
    let mut node = read(nodes, 0);
    while !node.has(LightNode::LEAF) {
        let (first, second) = (read(nodes, at + 1), read(nodes, node.number()));
        let (left, right) = (importance(&first), importance(&second));
        if left.eq(zero) && right.eq(zero) {
            return Chosen { emitter: 0, probability: zero };
        }
        let steps = steps_of_first(left, right);
        let is_second = guide.is_second(steps);
        let own = if is_second { STEPS - steps } else { steps };
        likely = (likely * probability(own)).flush(FAINT);
        at = if is_second { node.number() } else { at + 1 };
        node = if is_second { second } else { first };
    }
    Chosen { emitter: node.number(), probability: likely }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Digit by digit as by one division of 64 bits.
        #[test]
        fn draws_are_rescaled_exactly(over: u32, all in 1..=STEPS, fresh in 0..STEPS) {
            let over = (u64::from(over) % (u64::from(all) << BEYOND)) as u32;
            let whole = ((u64::from(over) << 23) | u64::from(fresh)) / u64::from(all);
            prop_assert_eq!(u64::from(rescaled(over, all, fresh)), whole);
        }

        /// A draw goes on as itself where there is no choice.
        #[test]
        fn what_is_certain_takes_no_digits(word: u32, other: u32) {
            for (steps, is_second) in [(0, true), (STEPS, false)] {
                let mut guide = Guide::draw(word, (other, other));
                prop_assert_eq!(guide.is_second(steps), is_second);
                prop_assert_eq!(guide.word, word);
            }
        }

        #[test]
        fn angles_are_subtracted(a in 0f64..3.1, b in 0f64..3.1) {
            let angle = |x: f64| Angle::<f64> { cosine: x.cos(), sine: x.sin() };
            let left = angle(a).less(angle(b));
            let wanted = (a - b).max(0.0);
            prop_assert!((left.cosine - wanted.cos()).abs() < 1e-9 && (left.sine - wanted.sin()).abs() < 1e-9);
        }
    }

    #[test]
    fn draws_are_shared_as_the_steps_say() {
        let steps = STEPS / 8 * 3;
        let firsts = (0..1u32 << 16).filter(|i| !Guide::draw(i << 16, (0, 0)).is_second(steps)).count();
        assert_eq!(firsts, (1 << 16) / 8 * 3);
    }
}
