//! What a screen shows of a film, see [`crate::screen`].

use crate::buffer::write;
use crate::launch::ROW;
use crate::screen::{Screen, shown};
use glam::UVec3;
use spirv_std::spirv;

/// Shows a pixel.
#[spirv(compute(threads(64)))]
pub fn show(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(uniform, descriptor_set = 0, binding = 0)] of: &Screen,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] film: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] least: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] pixels: &mut [u32],
) {
    let number = id.y * ROW + id.x;
    if number < of.columns * of.rows {
        let (x, y) = (number % of.columns, number / of.columns);
        write(pixels, of.first + y * of.stride + x, shown(of, (x, y), film, least));
    }
}
