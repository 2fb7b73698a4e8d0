//! The sums of slots, folded into pixels.

use super::NON_FINITE;
use crate::buffer::{read, write};
use crate::camera;
use crate::data::{Frame, Order};
use crate::real::{Scalar, V3};

/// Adds the sums of a pixel's samples in this launch to the film, in the order of the samples, whatever launch they came
/// in: so a picture has the same bits however many samples are in flight. `slot` is that of the pixel's first sample.
#[inline(always)]
pub fn gather<R: Scalar>(frame: &Frame, order: Order, slot: u32, sums: &[R::Record], film: &mut [R::Record]) {
    let pixel = camera::pixel(frame, order, slot);
    if !pixel.inside || slot >= frame.pixel_slots {
        return;
    }
    let (mut colour, mut word) = (V3::zero(), 0);
    if frame.restart == 0 {
        (colour, word) = R::load(read(film, pixel.index));
    }
    let mut at = slot;
    while at < frame.slots {
        let (sum, own) = R::load(read(sums, at));
        colour = colour + sum;
        word = ((word | own) & NON_FINITE) | ((word & !NON_FINITE) + (own & !NON_FINITE)) & !NON_FINITE;
        at += frame.pixel_slots;
    }
    write(film, pixel.index, R::store(colour, word));
}
