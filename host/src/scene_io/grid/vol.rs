//! Grid volumes as Mitsuba 3 reads them (its documentation, "Grid-based volume data source").

use glam::DVec3;

use super::bytes::Bytes;
use crate::scene::{Grid, Unplaced};
use crate::scene_io::budget::Budget;

/// Is it one?
pub fn is(bytes: &[u8]) -> bool {
    bytes.starts_with(b"VOL\x03")
}

/// Before the numbers.
const HEADER: u64 = 48;

/// The grid of such a file.
///
/// # Errors
/// Numbers of another kind, more than one a cell, or fewer than it says.
pub fn grid(bytes: &[u8], title: &str, budget: &Budget) -> Unplaced<Grid> {
    let bytes = Bytes(bytes);
    let kind = bytes.i32(4)?;
    if kind != 1 {
        return Err(format!("its numbers are of kind {kind}; only single precision (1) is read"));
    }
    let size = [bytes.i32(8)?, bytes.i32(12)?, bytes.i32(16)?];
    if size.iter().any(|&along| along <= 0) {
        return Err(format!("it has {} x {} x {} cells; it must have some", size[0], size[1], size[2]));
    }
    let channels = bytes.i32(20)?;
    if channels != 1 {
        return Err(format!("it has {channels} numbers a cell; it must have one"));
    }
    let size = size.map(|along| along as u32);
    let count = size.iter().try_fold(1u64, |all, &along| all.checked_mul(along.into())).unwrap_or(u64::MAX);
    let numbers = bytes.part(HEADER, count.saturating_mul(4))?;
    budget.check_bytes(count.saturating_mul(8)).map_err(|why| format!("{count} cells {why}; make it coarser"))?;
    let corner =
        |at| Ok::<_, String>(DVec3::new(bytes.f32(at)?.into(), bytes.f32(at + 4)?.into(), bytes.f32(at + 8)?.into()));
    let bounds = [corner(24)?, corner(36)?];
    let numbers: Vec<f32> =
        numbers.0.chunks_exact(4).map(|word| f32::from_le_bytes([word[0], word[1], word[2], word[3]])).collect();
    Ok(Grid::dense(title, size, &numbers, bounds))
}
