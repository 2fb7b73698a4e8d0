//! Pixels to rays: a file for what all cameras have, and one each for what some have.

mod clip;
mod filter;
mod lens;
mod ray;
mod round;
mod shutter;
mod stereo;

pub use clip::limit;
pub use filter::FILTER_STEPS;
pub use lens::{MOST_CORNERS, OUTLINE};
pub use ray::{CameraRay, plain_ray, ray};
pub use shutter::{common_time, panned, time};

use crate::buffer::read;
use crate::data::{Frame, Order};
use crate::sampler::Key;

/// Columns and rows of the blocks that pixels are taken in: neighbours for the 32 rays of a subgroup
/// ([`Order::LINEAR`]: beside each other), or a square for [`Order::MORTON`].
#[inline(always)]
pub fn blocks(order: Order) -> (u32, u32) {
    if order.has(Order::LINEAR) {
        (32, 1)
    } else if order.has(Order::MORTON) {
        (64, 64)
    } else {
        (8, 4)
    }
}

/// Slots for a sample of every pixel of a region of `width` x `height`: whole blocks, so that some may lie outside.
pub fn slots(width: u32, height: u32, order: Order) -> u32 {
    let (columns, rows) = blocks(order);
    width.next_multiple_of(columns) * height.next_multiple_of(rows)
}

/// Blocks that lie beside each other in a region of so many columns.
pub fn across(width: u32, order: Order) -> u32 {
    width.div_ceil(blocks(order).0)
}

/// A slot's sample: a pixel within the launch's region, and which of its samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// Columns from the region's left edge.
    pub x: u32,
    /// Rows from its top.
    pub y: u32,
    /// Is it inside the region? A last block may stick out.
    pub inside: bool,
    /// Its place in the region, row by row.
    pub index: u32,
    /// Which sample of the pixel.
    pub sample: u32,
}

/// The pixel and sample of a slot: a sample of every pixel before the next; blocks in rows, so that the lanes of a
/// subgroup are neighbours.
#[inline(always)]
pub fn pixel(frame: &Frame, order: Order, slot: u32) -> Pixel {
    let (width, height) = (frame.columns, frame.rows);
    let (columns, rows) = blocks(order);
    // A host never launches an empty region; these keep divisions by zero out of the kernel.
    let across = if frame.across == 0 { 1 } else { frame.across };
    let pixel_slots = if frame.pixel_slots == 0 { 1 } else { frame.pixel_slots };
    let (sample, slot) = (frame.sample + slot / pixel_slots, slot % pixel_slots);
    let (block, lane) = (slot / (columns * rows), slot % (columns * rows));
    let (right, down) =
        if order.has(Order::MORTON) { (even(lane), even(lane >> 1)) } else { (lane % columns, lane / columns) };
    let (x, y) = (block % across * columns + right, block / across * rows + down);
    Pixel { x, y, inside: x < width && y < height, index: y * width + x, sample }
}

/// Columns and rows of a cell: what decides together how many samples it gets.
pub const CELL: u32 = 16;

/// A pixel of a launch over cells, whose region is cells beside and below each other, as a pixel of the image: `cells` has the
/// column and, in the upper half, the row of each cell's first pixel.
#[inline(always)]
pub fn in_cell(frame: &Frame, cells: &[u32], pixel: Pixel) -> Pixel {
    let corner = read(cells, pixel.y / CELL * (frame.columns / CELL) + pixel.x / CELL);
    let (x, y) = ((corner & 0xffff) + pixel.x % CELL, (corner >> 16) + pixel.y % CELL);
    Pixel { x, y, inside: pixel.inside && x < frame.width && y < frame.height, ..pixel }
}

/// Which sample of its pixel a slot follows.
#[inline(always)]
pub fn sample(frame: &Frame, slot: u32) -> u32 {
    let pixel_slots = if frame.pixel_slots == 0 { 1 } else { frame.pixel_slots };
    // Divisions take long, and most launches have one sample a pixel in flight.
    if slot < pixel_slots { frame.sample } else { frame.sample + slot / pixel_slots }
}

/// The even bits of a 12-bit number, put together: a coordinate of a place on a Morton curve.
#[inline(always)]
fn even(place: u32) -> u32 {
    let x = place & 0x555;
    let x = (x | (x >> 1)) & 0x333;
    let x = (x | (x >> 2)) & 0x70f;
    (x | (x >> 4)) & 0x3f
}

/// What the numbers are drawn from that all pixels have in common where photons tell of light, since these are the same for all.
#[inline(always)]
pub fn common_key(frame: &Frame) -> Key {
    Key::new((0, 0), frame.seed)
}

/// What a pixel's numbers are drawn from, whichever region a launch renders.
#[inline(always)]
pub fn key(frame: &Frame, pixel: Pixel) -> Key {
    Key::new((frame.left + pixel.x, frame.top + pixel.y), frame.seed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Camera;
    use glam::Vec3;

    /// `batch` samples of every pixel in a launch, from `sample` on, of `samples` along an edge.
    pub(super) fn frame(width: u32, height: u32, samples: u32, sample: u32, order: Order, batch: u32) -> Frame {
        let (right, up) = (Vec3::X / (width * samples) as f32, Vec3::Y / (height * samples) as f32);
        let pixel_slots = slots(width, height, order);
        Frame {
            camera: Camera::new(Vec3::new(0.5, 0.0, 0.0), right, up, -Vec3::Z),
            width,
            height,
            samples,
            sample,
            columns: width,
            rows: height,
            across: across(width, order),
            pixel_slots,
            slots: batch * pixel_slots,
            ..Frame::default()
        }
    }

    #[test]
    fn every_sample_of_every_pixel_has_one_slot() {
        for order in [0, Order::LINEAR, Order::MORTON].map(Order) {
            for (width, height) in [(1, 1), (8, 4), (9, 5), (37, 23), (64, 3), (130, 70)] {
                let frame = frame(width, height, 2, 1, order, 3);
                let all = (0..frame.slots).map(|s| pixel(&frame, order, s));
                let mut seen: Vec<_> = all.filter(|p| p.inside).map(|p| (p.sample, p.index)).collect();
                seen.sort_unstable();
                let want = (1..4).flat_map(|sample| (0..width * height).map(move |index| (sample, index)));
                assert_eq!(seen, want.collect::<Vec<_>>(), "{width}x{height}, {order:?}");
            }
        }
    }

    #[test]
    fn a_morton_curve_fills_a_square_before_the_next() {
        let order = Order(Order::MORTON);
        let frame = frame(64, 64, 1, 0, order, 1);
        for edge in [2, 4, 8, 16, 32] {
            let square = (0..edge * edge).map(|s| pixel(&frame, order, s));
            assert!(square.clone().all(|p| p.x < edge && p.y < edge), "{edge}");
        }
    }

    /// Two cells beside and two below each other, of which one sticks out of the image and one is none.
    #[test]
    fn cells_are_where_their_table_has_them() {
        let frame = Frame { width: 70, height: 40, columns: 2 * CELL, rows: 2 * CELL, ..Frame::default() };
        let cells = [48 | 16 << 16, 0, 64 | 32 << 16, u32::MAX];
        let at = |x, y| {
            let found = in_cell(&frame, &cells, Pixel { x, y, inside: true, index: 5, sample: 3 });
            assert_eq!((found.index, found.sample), (5, 3));
            found.inside.then_some((found.x, found.y))
        };
        assert_eq!((at(0, 0), at(15, 2)), (Some((48, 16)), Some((63, 18))));
        assert_eq!(at(16, 15), Some((0, 15)));
        assert_eq!((at(5, 23), at(6, 16), at(0, 24)), (Some((69, 39)), None, None));
        assert_eq!(at(31, 31), None);
    }
}
