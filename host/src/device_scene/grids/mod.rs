//! Grids of densities and temperatures as kernels read them, see [`eyerays_shader::data::Grid`].

mod blocks;
mod glow;
#[cfg(test)]
mod tests;

use std::iter::repeat_n;

use eyerays_shader::data::Grid as Words;
use glam::{DAffine3, DVec3};

use self::blocks::{Block, Blocks};
pub use self::glow::append as append_glow;
use super::normalisation::Normalisation;
use crate::error::{Error, Result};
use crate::memory::Room;
use crate::scene::Grid;

/// Blocks that are made at a time: the numbers of no more lie in memory twice.
const AT_ONCE: usize = 1 << 12;

/// Appends the words of a grid to those of others.
///
/// # Errors
/// It is larger than `room`, before anything of it is made, or than devices hold; or it has no place in the scene.
pub fn append(grid: &Grid, normalisation: &Normalisation, room: Room, words: &mut Vec<u32>) -> Result<()> {
    let transform = transform(grid, normalisation)?;
    let blocks = Blocks::of(grid)?;
    let most = size(&blocks, room, words.len())?;
    let start = words.len();
    words.try_reserve_exact(most as usize).map_err(|_| blocks.fault("take more memory than there is"))?;
    words.extend(transform.map(f32::to_bits));
    words.extend(blocks.cells.map(|cells| cells as u32));
    words.extend(blocks.along.map(|blocks| blocks as u32));
    words.extend([if grid.has_edges { 0.5f32.to_bits() } else { 0 }, 0]);
    words.extend(repeat_n([blocks.background().to_bits(), Words::EVEN], blocks.count() as usize).flatten());
    for numbers in blocks.near().chunks(AT_ONCE) {
        for (number, Block { greatest, corners }) in blocks.made(numbers) {
            let record = start + Words::RECORDS as usize + 2 * number as usize;
            let place = if corners.is_empty() { Words::EVEN } else { (words.len() - start) as u32 };
            words[record..][..2].copy_from_slice(&[greatest.to_bits(), place]);
            words.extend(corners.iter().map(|corner| corner.to_bits()));
        }
    }
    Ok(())
}

/// The greatest number of a grid whose words begin there.
pub fn greatest(words: &[u32], at: u32) -> f32 {
    let words = &words[at as usize..];
    let along = &words[Words::BLOCKS as usize..][..3];
    let count = along.iter().map(|&blocks| blocks as usize).product();
    let records = words[Words::RECORDS as usize..].chunks_exact(2).take(count);
    records.map(|record| f32::from_bits(record[0])).fold(0.0, f32::max)
}

/// The words of a grid at most, which follow `before` others. Kernels look up the record of any block by its place, so that there is one
/// of each block between leaves, too, however far apart these lie.
fn size(blocks: &Blocks<'_>, room: Room, before: usize) -> Result<u64> {
    let fits = |words: u64| {
        room.check(4 * words).map_err(|why| blocks.fault(&why))?;
        // Kernels count words in 32 bits.
        u32::try_from(before as u64 + words).map_err(|_| blocks.fault("are more than devices hold"))?;
        Ok(words)
    };
    let records = fits(u64::from(Words::RECORDS) + 2 * blocks.count())?;
    fits(records + blocks.most_corners())
}

/// Rows that take places of the normalised scene to cells: the first voxel is at 1.
fn transform(grid: &Grid, normalisation: &Normalisation) -> Result<[f32; 12]> {
    let fault = || Error::new(format!("{} has no size in the scene: give it bounds that have a volume", grid.name));
    if grid.placement.matrix3.determinant() == 0.0 {
        return Err(fault());
    }
    let first = DVec3::from(grid.extent[0].map(f64::from));
    let to_cells = DAffine3::from_translation(DVec3::ONE - first) * grid.placement.inverse();
    let all = to_cells * normalisation.inverse();
    let [x, y, z] = all.matrix3.transpose().to_cols_array_2d();
    let rows = [x, y, z].into_iter().zip(all.translation.to_array());
    let numbers: Vec<f32> = rows.flat_map(|([a, b, c], d)| [a, b, c, d].map(|number| number as f32)).collect();
    // Beyond, products with coordinates of the scene are not exact to a cell any more, nor finite in the end.
    let is_fine = numbers.iter().all(|number| number.abs() < (1u64 << 40) as f32);
    if is_fine { Ok(numbers.try_into().expect("twelve numbers")) } else { Err(fault()) }
}
