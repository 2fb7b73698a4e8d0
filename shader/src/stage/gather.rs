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
    if frame.sample > 0 {
        (colour, word) = R::load(read(film, pixel.index));
    }
    let mut at = slot;
    while at < frame.slots {
        let (sum, own) = R::load(read(sums, at));
        colour = colour + sum;
        word = counted(word, own);
        at += frame.pixel_slots;
    }
    write(film, pixel.index, R::store(colour, word));
}

/// The integers of two sums together: shadow rays are counted, what was left out is remembered.
#[inline(always)]
pub fn counted(word: u32, own: u32) -> u32 {
    ((word | own) & NON_FINITE) | ((word & !NON_FINITE) + (own & !NON_FINITE)) & !NON_FINITE
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera;
    use crate::stage::NON_FINITE;
    use glam::{UVec4, Vec3};

    type Record = UVec4;

    fn record(value: f32, word: u32) -> Record {
        f32::store(V3::splat(Vec3::splat(value)), word)
    }

    /// `batch` samples in flight of a region of 9x5 pixels.
    fn frame(batch: u32, sample: u32) -> Frame {
        let pixel_slots = camera::slots(9, 5, Order(0));
        Frame {
            columns: 9,
            rows: 5,
            across: camera::across(9, Order(0)),
            pixel_slots,
            slots: batch * pixel_slots,
            sample,
            ..Frame::default()
        }
    }

    fn gathered(frame: &Frame, sums: &[Record], film: &mut [Record]) {
        (0..frame.pixel_slots).for_each(|slot| gather::<f32>(frame, Order(0), slot, sums, film));
    }

    /// Numbers whose sum depends on their order tell it.
    #[test]
    fn samples_are_added_in_their_order_whatever_launch_they_come_in() {
        let values = [1e8, 1.0, -1e8, 0.5];
        let in_order = ((values[0] + values[1]) + values[2]) + values[3];
        assert_ne!(in_order, values.iter().rev().sum::<f32>(), "the order must matter");
        for batches in [&[4][..], &[1, 1, 1, 1], &[2, 2], &[3, 1]] {
            let mut film = vec![record(9.0, 9); 45];
            let mut first = 0;
            for &batch in batches {
                let frame = frame(batch, first as u32);
                let of = |slot: u32| record(values[first + (slot / frame.pixel_slots) as usize], 2);
                let sums: Vec<Record> = (0..frame.slots).map(of).collect();
                gathered(&frame, &sums, &mut film);
                first += batch as usize;
            }
            assert!(film.iter().all(|&pixel| pixel == record(in_order, 8)), "{batches:?}: {:?}", film[0]);
        }
    }

    #[test]
    fn every_pixel_has_its_own_slots_and_those_outside_have_none() {
        let frame = frame(2, 0);
        let sums: Vec<Record> = (0..frame.slots).map(|slot| record(slot as f32, 1)).collect();
        let mut film = vec![record(0.0, 0); 45];
        gathered(&frame, &sums, &mut film);
        for slot in 0..frame.pixel_slots {
            let pixel = camera::pixel(&frame, Order(0), slot);
            if pixel.inside {
                assert_eq!(film[pixel.index as usize], record((2 * slot + frame.pixel_slots) as f32, 2));
            }
        }
    }

    #[test]
    fn what_was_left_out_is_remembered_and_counts_still_add_up() {
        let frame = frame(3, 0);
        let words = [3 | NON_FINITE, 4 | NON_FINITE, 5];
        let sums: Vec<Record> =
            (0..frame.slots).map(|slot| record(1.0, words[(slot / frame.pixel_slots) as usize])).collect();
        let mut film = vec![record(0.0, 0); 45];
        gathered(&frame, &sums, &mut film);
        assert!(film.iter().all(|&pixel| pixel == record(3.0, 12 | NON_FINITE)));
    }
}
