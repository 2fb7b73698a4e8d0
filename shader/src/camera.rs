//! Pixels to rays.

use crate::data::{Features, Frame, numbers};
use crate::real::{Scalar, V3};

/// Columns and rows of the blocks that pixels are taken in: neighbours for the 32 rays of a subgroup
/// ([`Features::LINEAR`]: beside each other), or a square for [`Features::MORTON`].
#[inline(always)]
pub fn blocks(features: Features) -> (u32, u32) {
    if features.has(Features::LINEAR) {
        (32, 1)
    } else if features.has(Features::MORTON) {
        (64, 64)
    } else {
        (8, 4)
    }
}

/// Slots for a region of `width` x `height` pixels: whole blocks, so that some may lie outside.
pub fn slots(width: u32, height: u32, features: Features) -> u32 {
    let (columns, rows) = blocks(features);
    width.next_multiple_of(columns) * height.next_multiple_of(rows)
}

/// A slot's pixel within the launch's region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// Columns from the region's left edge.
    pub x: u32,
    /// Rows from its top.
    pub y: u32,
    /// Is it inside the region? A last block may stick out.
    pub inside: bool,
    /// Its place in the region's film.
    pub index: u32,
}

/// The pixel of a slot: blocks in rows, so that the lanes of a subgroup are neighbours.
#[inline(always)]
pub fn pixel(frame: &Frame, features: Features, slot: u32) -> Pixel {
    let (width, height) = (frame.region.z, frame.region.w);
    let (columns, rows) = blocks(features);
    let across = width.div_ceil(columns);
    // A host never launches an empty region; the greater keeps a division by zero out of the kernel.
    let across = if across == 0 { 1 } else { across };
    let (block, lane) = (slot / (columns * rows), slot % (columns * rows));
    let (right, down) =
        if features.has(Features::MORTON) { (even(lane), even(lane >> 1)) } else { (lane % columns, lane / columns) };
    let (x, y) = (block % across * columns + right, block / across * rows + down);
    Pixel { x, y, inside: x < width && y < height, index: y * width + x }
}

/// The even bits of a 12-bit number, put together: a coordinate of a place on a Morton curve.
#[inline(always)]
fn even(place: u32) -> u32 {
    let x = place & 0x555;
    let x = (x | (x >> 1)) & 0x333;
    let x = (x | (x >> 2)) & 0x70f;
    (x | (x >> 4)) & 0x3f
}

/// Origin and unit direction of the ray through this launch's sample of a pixel.
///
/// A pixel has N x N samples on a regular grid (thesis chapter 3.4.5); the offset from the image's centre
/// is a whole number of half samples, so that no division is needed.
#[inline(always)]
pub fn ray<R: Scalar>(frame: &Frame, pixel: Pixel) -> (V3<R>, V3<R>) {
    let (width, height, samples, sample) = (frame.eye.w, frame.right.w, frame.up.w, frame.forward.w);
    let samples = if samples == 0 { 1 } else { samples };
    let half_steps = |at: u32, size: u32, sample: u32| {
        let from_edge = 2 * (at * samples + sample) + 1;
        R::splat((from_edge as i32 - (size * samples) as i32) as f32)
    };
    let right = half_steps(frame.region.x + pixel.x, width, sample % samples);
    let down = half_steps(frame.region.y + pixel.y, height, sample / samples);
    let direction = V3::splat(numbers(frame.forward))
        + V3::splat(numbers(frame.right)) * right
        + V3::splat(numbers(frame.up)) * -down;
    (V3::splat(numbers(frame.eye)), direction.normalised().0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::pack;
    use bytemuck::Zeroable;
    use glam::{UVec4, Vec3};

    fn frame(width: u32, height: u32, samples: u32, sample: u32) -> Frame {
        Frame {
            eye: pack(Vec3::new(0.5, 0.0, 0.0), width),
            right: pack(Vec3::X / (width * samples) as f32, height),
            up: pack(Vec3::Y / (height * samples) as f32, samples),
            forward: pack(-Vec3::Z, sample),
            region: UVec4::new(0, 0, width, height),
            ..Frame::zeroed()
        }
    }

    #[test]
    fn every_pixel_has_one_slot() {
        for features in [0, Features::LINEAR, Features::MORTON].map(Features) {
            for (width, height) in [(1, 1), (8, 4), (9, 5), (37, 23), (64, 3), (130, 70)] {
                let frame = frame(width, height, 1, 0);
                let all = (0..slots(width, height, features)).map(|s| pixel(&frame, features, s));
                let mut seen: Vec<u32> = all.filter(|p| p.inside).map(|p| p.index).collect();
                seen.sort_unstable();
                assert_eq!(seen, (0..width * height).collect::<Vec<_>>(), "{width}x{height}, {features:?}");
            }
        }
    }

    #[test]
    fn a_morton_curve_fills_a_square_before_the_next() {
        let frame = frame(64, 64, 1, 0);
        for edge in [2, 4, 8, 16, 32] {
            let square = (0..edge * edge).map(|s| pixel(&frame, Features(Features::MORTON), s));
            assert!(square.clone().all(|p| p.x < edge && p.y < edge), "{edge}");
        }
    }

    #[test]
    fn the_first_pixel_is_top_left_and_samples_surround_its_centre() {
        let (origin, d) = ray::<f64>(&frame(2, 2, 1, 0), pixel(&frame(2, 2, 1, 0), Features(0), 0));
        assert_eq!((origin.x, origin.y, origin.z), (0.5, 0.0, 0.0));
        assert!((d.x / d.z - 0.5).abs() < 1e-12 && (d.y / d.z + 0.5).abs() < 1e-12, "left and up: {d:?}");
        let grid: Vec<_> = (0..4)
            .map(|s| frame(2, 2, 2, s))
            .map(|f| ray::<f64>(&f, pixel(&f, Features(0), 0)).1)
            .map(|d| ((d.x / -d.z * 4.0).round() as i32, (d.y / -d.z * 4.0).round() as i32))
            .collect();
        assert_eq!(grid, [(-3, 3), (-1, 3), (-3, 1), (-1, 1)]);
    }
}
