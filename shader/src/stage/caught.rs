//! Shadow catchers: what the camera sees of one is how much of its light others keep away, which the film keeps as two sums.

use super::{LIGHT_FRACTION, LIGHT_MOST, REACHED};
use crate::buffer::{read, write};
use crate::data::{Frame, Launch, Quanta};
use crate::real::{Real, Scalar, V3};

/// What a sample has of the catcher that its camera's ray meets: brightness that light brings to the pixel.
#[derive(Clone, Copy)]
pub struct Caught<R: Real> {
    /// Of the sampled light, if nothing else is there.
    pub light: R,
    /// Of what the path's next ray sees of the surroundings, if nothing else is there.
    pub sky: R,
    /// Of both, what has arrived.
    pub lit: R,
    /// See the constants of this type.
    pub state: u32,
}

impl<R: Real> Caught<R> {
    /// The camera's ray meets no catcher.
    pub const NOTHING: u32 = 0;
    /// The shadow ray of the light is under way.
    pub const WAITS: u32 = 1;
    /// It is known what has arrived.
    pub const TOLD: u32 = 2;

    /// Of a sample that meets none.
    #[inline(always)]
    pub fn nothing() -> Self {
        let zero = R::splat(0.0);
        Caught { light: zero, sky: zero, lit: zero, state: Self::NOTHING }
    }

    /// Does the camera's ray meet a catcher?
    #[inline(always)]
    pub fn is_some(&self) -> bool {
        self.state != Self::NOTHING
    }

    /// Is the light of the slot's shadow ray a catcher's, and none of the picture?
    #[inline(always)]
    pub fn waits(&self) -> bool {
        self.state == Self::WAITS
    }

    /// All that arrives if nothing else is there.
    #[inline(always)]
    pub fn full(&self) -> R {
        self.light + self.sky
    }

    /// With the answer of the slot's shadow ray, if it waits for that.
    #[inline(always)]
    pub fn answered(self, answer: u32) -> Self {
        if !self.waits() {
            return self;
        }
        let lit = if answer == REACHED { self.light } else { R::splat(0.0) };
        Caught { lit, state: Self::TOLD, ..self }
    }

    /// The path's next ray has met nothing but catchers.
    #[inline(always)]
    pub fn open(self) -> Self {
        Caught { lit: self.lit + self.sky, ..self }
    }
}

impl<R: Scalar> Caught<R> {
    /// Of one whose rays are under way. What is not finite is left out.
    #[inline(always)]
    pub fn under_way(light: R, sky: R) -> Self {
        let finite = |of: R| if of.is_finite() { of } else { R::splat(0.0) };
        Caught { light: finite(light), sky: finite(sky), lit: R::splat(0.0), state: Self::WAITS }
    }

    /// A slot's, which lies behind the sums of all.
    #[inline(always)]
    pub fn load(launch: Launch, frame: &Frame, slot: u32, sums: &[R::Record]) -> Self {
        if !launch.has(Launch::CATCHER) {
            return Self::nothing();
        }
        let (of, state) = R::load(read(sums, frame.slots + slot));
        Caught { light: of.x, sky: of.y, lit: of.z, state }
    }

    /// Keeps it there.
    #[inline(always)]
    pub fn store(self, launch: Launch, frame: &Frame, slot: u32, sums: &mut [R::Record]) {
        if launch.has(Launch::CATCHER) {
            write(sums, frame.slots + slot, R::store(V3::new(self.light, self.sky, self.lit), self.state));
        }
    }
}

/// What some samples of a pixel have of catchers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CatcherSums {
    /// Of how many samples the camera's ray met one.
    pub count: u32,
    /// The brightness that light brings to those if nothing else is there; of this and the next the last word is not kept.
    pub full: Quanta,
    /// What of it arrives.
    pub lit: Quanta,
}

impl CatcherSums {
    /// One sample's.
    #[inline(always)]
    pub fn of<R: Scalar>(caught: Caught<R>) -> Self {
        if !caught.is_some() {
            return CatcherSums::default();
        }
        let quanta = |of: R| Quanta::of(of.to_f32(), LIGHT_FRACTION, LIGHT_MOST);
        CatcherSums { count: 1, full: quanta(caught.full()), lit: quanta(caught.lit) }
    }

    /// These samples and others.
    #[inline(always)]
    pub fn plus(self, other: Self) -> Self {
        CatcherSums { count: self.count + other.count, full: self.full.plus(other.full), lit: self.lit.plus(other.lit) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stage::SHADOWED;

    /// What has arrived of all is, bit for bit, all: so a catcher that nothing is near is exactly clear.
    #[test]
    fn all_that_arrives_is_all() {
        for (light, sky) in [(0.1f32, 0.7f32), (1e-20, 3.0), (f32::NAN, 0.3), (0.3, f32::INFINITY), (0.0, 0.0)] {
            let caught = Caught::under_way(light, sky);
            let all = caught.answered(REACHED).open();
            assert_eq!(all.lit.to_bits(), all.full().to_bits());
            assert!(all.lit.is_finite() && !all.waits());
            assert_eq!(caught.answered(SHADOWED).lit, 0.0);
            assert_eq!(caught.answered(SHADOWED).answered(REACHED).lit, 0.0, "it is told once");
        }
        assert!(!Caught::<f32>::nothing().answered(REACHED).is_some());
    }
}
