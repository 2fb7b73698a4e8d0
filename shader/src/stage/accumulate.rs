//! The sums of slots, folded into pixels without the loss of rounding, with what tells their noise.

use super::{ShadowRay, counted};
use crate::buffer::{read, write};
use crate::camera;
use crate::data::{Frame, Order};
use crate::real::{FAINT, Scalar, V3};

/// Records that a pixel takes of the film: the sum of its samples with counts, as [`super::gather`] keeps them; and what rounding
/// took off the sum, with the sum of the squares of the samples' [`brightness`].
pub const FILM_RECORDS: u32 = 2;

/// The mean of the channels: what noise is told of.
#[inline(always)]
pub fn brightness<R: Scalar>(colour: V3<R>) -> R {
    const THIRD: f32 = 1.0 / 3.0;
    (colour.x + colour.y + colour.z) * R::splat(THIRD)
}

/// Adds a pixel's samples in this launch, each with the light that its last vertex waited for, to the film in the order of the
/// samples. `slot` is that of the pixel's first sample.
#[inline(always)]
pub fn accumulate<R: Scalar>(
    frame: &Frame,
    order: Order,
    slot: u32,
    (sums, shadows, segments): (&[R::Record], &[u32], &[R::Record]),
    film: &mut [R::Record],
) {
    let pixel = camera::pixel(frame, order, slot);
    if !pixel.inside || slot >= frame.pixel_slots {
        return;
    }
    let further = frame.columns * frame.rows + pixel.index;
    let (mut colour, mut word, mut rest, mut squares) = (V3::zero(), 0, V3::zero(), 0f32);
    if frame.sample > 0 {
        (colour, word) = R::load(read(film, pixel.index));
        let bits;
        (rest, bits) = R::load(read(film, further));
        squares = f32::from_bits(bits);
    }
    let mut at = slot;
    while at < frame.slots {
        let (sum, own) = R::load(read(sums, at));
        let sample = sum + ShadowRay::<R>::arrived(frame.slots, at, shadows, segments);
        // Kahan's sum: the rest goes into the next addition, so that it never grows. Flushed here and not where it is stored, where
        // n samples and n more would otherwise not be 2n.
        (colour, rest) = colour.difference_and_rest(-(sample + rest));
        rest = rest.map(|c| c.flush(FAINT));
        let bright = brightness(sample).flush(FAINT);
        squares += (bright * bright).flush(FAINT).to_f32();
        word = counted(word, own);
        at += frame.pixel_slots;
    }
    write(film, pixel.index, R::store(colour, word));
    write(film, further, R::store(rest, squares.to_bits()));
}
