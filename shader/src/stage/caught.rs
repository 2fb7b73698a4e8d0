//! Shadow catchers: what the camera sees of one is how much of its light others keep away, which the film keeps as two sums.

use super::REACHED;
use crate::buffer::{read, write};
use crate::data::{Frame, Launch};
use crate::real::{Real, Scalar, V3};

/// What a sample has of the catcher that its camera's ray meets.
#[derive(Clone, Copy)]
pub struct Caught<R: Real> {
    /// The brightness that a sampled light brings to the pixel if nothing else is there.
    pub full: R,
    /// See the constants of this type.
    pub state: u32,
}

impl<R: Real> Caught<R> {
    /// The camera's ray meets no catcher.
    pub const NOTHING: u32 = 0;
    /// The shadow ray of its light is under way.
    pub const WAITS: u32 = 1;
    /// Its light has arrived.
    pub const LIT: u32 = 2;
    /// Others have kept it away.
    pub const DARK: u32 = 3;

    /// Of a sample that meets none.
    #[inline(always)]
    pub fn nothing() -> Self {
        Caught { full: R::splat(0.0), state: Self::NOTHING }
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

    /// With the answer of the slot's shadow ray, if it waits for that.
    #[inline(always)]
    pub fn answered(self, answer: u32) -> Self {
        let state = if answer == REACHED { Self::LIT } else { Self::DARK };
        Caught { state: if self.waits() { state } else { self.state }, ..self }
    }
}

impl<R: Scalar> Caught<R> {
    /// A slot's, which lies behind the sums of all.
    #[inline(always)]
    pub fn load(launch: Launch, frame: &Frame, slot: u32, sums: &[R::Record]) -> Self {
        if !launch.has(Launch::CATCHER) {
            return Self::nothing();
        }
        let (full, state) = R::load(read(sums, frame.slots + slot));
        Caught { full: full.x, state }
    }

    /// Keeps it there.
    #[inline(always)]
    pub fn store(self, launch: Launch, frame: &Frame, slot: u32, sums: &mut [R::Record]) {
        if launch.has(Launch::CATCHER) {
            let zero = R::splat(0.0);
            write(sums, frame.slots + slot, R::store(V3::new(self.full, zero, zero), self.state));
        }
    }
}
