//! Pixels to rays.

use crate::data::{Frame, numbers};
use crate::real::{Scalar, V3};

/// Pixels side by side in a block of 32 neighbouring rays.
const BLOCK_WIDTH: u32 = 8;
/// Rows of such a block.
const BLOCK_HEIGHT: u32 = 4;

/// Slots for a region of `width` x `height` pixels: whole blocks, so that some may lie outside.
pub fn slots(width: u32, height: u32) -> u32 {
    width.div_ceil(BLOCK_WIDTH) * BLOCK_WIDTH * height.div_ceil(BLOCK_HEIGHT) * BLOCK_HEIGHT
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

/// The pixel of a slot: 8x4 blocks in rows, so that the lanes of a subgroup are neighbours.
#[inline(always)]
pub fn pixel(frame: &Frame, slot: u32) -> Pixel {
    let (width, height) = (frame.region.z, frame.region.w);
    let blocks = width.div_ceil(BLOCK_WIDTH);
    let (block, lane) = (slot / (BLOCK_WIDTH * BLOCK_HEIGHT), slot % (BLOCK_WIDTH * BLOCK_HEIGHT));
    // A host never launches an empty region; the greater keeps a division by zero out of the kernel.
    let blocks = if blocks == 0 { 1 } else { blocks };
    let x = block % blocks * BLOCK_WIDTH + lane % BLOCK_WIDTH;
    let y = block / blocks * BLOCK_HEIGHT + lane / BLOCK_WIDTH;
    Pixel { x, y, inside: x < width && y < height, index: y * width + x }
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
        for (width, height) in [(1, 1), (8, 4), (9, 5), (37, 23), (64, 3)] {
            let frame = frame(width, height, 1, 0);
            let mut seen: Vec<u32> =
                (0..slots(width, height)).map(|s| pixel(&frame, s)).filter(|p| p.inside).map(|p| p.index).collect();
            seen.sort_unstable();
            assert_eq!(seen, (0..width * height).collect::<Vec<_>>(), "{width}x{height}");
        }
    }

    #[test]
    fn the_first_pixel_is_top_left_and_samples_surround_its_centre() {
        let (origin, d) = ray::<f64>(&frame(2, 2, 1, 0), pixel(&frame(2, 2, 1, 0), 0));
        assert_eq!((origin.x, origin.y, origin.z), (0.5, 0.0, 0.0));
        assert!((d.x / d.z - 0.5).abs() < 1e-12 && (d.y / d.z + 0.5).abs() < 1e-12, "left and up: {d:?}");
        let grid: Vec<_> = (0..4)
            .map(|s| frame(2, 2, 2, s))
            .map(|f| ray::<f64>(&f, pixel(&f, 0)).1)
            .map(|d| ((d.x / -d.z * 4.0).round() as i32, (d.y / -d.z * 4.0).round() as i32))
            .collect();
        assert_eq!(grid, [(-3, 3), (-1, 3), (-3, 1), (-1, 1)]);
    }
}
