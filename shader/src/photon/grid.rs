//! Photons by the cells of a grid (Teschner and others, Optimized Spatial Hashing for Collision Detection of Deformable Objects, 2003).

use super::landed::Landed;
use super::{Photons, RECORDS};
use crate::buffer::{read, write};
use crate::data::Frame;
use crate::real::{Real, Scalar, V3, power};
use crate::sampler::hash;
use glam::UVec4;

/// How far a sample looks for photons, in the normalised scene: its square falls as the number of the sample to the power of -1/3 (Knaus and Zwicker
/// 2011, section 5, of alpha 2/3).
// A function of its own on the GPU, so that a module holds it once.
#[cfg_attr(target_arch = "spirv", inline(never))]
pub fn radius(frame: &Frame, sample: u32) -> f32 {
    const SIXTH: f32 = 1.0 / 6.0;
    let number = Real::div(1.0f32, (sample + 1) as f32);
    frame.radius * power::pow(number, SIXTH)
}

/// The cells that the photons of a sample lie in: of twice the radius, so that eight of them hold all within it.
#[derive(Clone, Copy)]
pub struct Grid {
    /// One over a cell's edge.
    over: f32,
    /// The sample, counted from the first of the launch.
    sample: u32,
    /// One less than how many lists there are, which is a power of two.
    mask: u32,
}

/// A cell.
type Cell = (u32, u32, u32);

impl Grid {
    /// That of a sample, counted from the first of the launch, which looks so far.
    #[inline(always)]
    pub fn new(frame: &Frame, sample: u32, radius: f32) -> Self {
        Grid { over: Real::reciprocal(radius + radius), sample, mask: frame.heads.wrapping_sub(1) }
    }

    /// The cell of a place that is moved by so many cells along each axis.
    #[inline(always)]
    fn cell(&self, place: V3<f32>, moved: f32) -> Cell {
        // The scene lies within [-1, 1]. No cell is below zero.
        let along = |c: f32| ((c + 2.0) * self.over + moved).floor_index() as u32;
        (along(place.x), along(place.y), along(place.z))
    }

    /// The list of a cell.
    #[inline(always)]
    fn list(&self, (x, y, z): Cell) -> u32 {
        hash([x, y, z ^ self.sample.wrapping_mul(0x9e37_79b9)])[0] & self.mask
    }

    /// Begins to look around a place.
    #[inline(always)]
    pub fn around(&self, place: V3<f32>, photons: &Photons<'_>) -> Search {
        let first = self.cell(place, -0.5);
        Search { first, corner: 0, next: read(photons.heads, self.list(first)) }
    }
}

/// A search through the lists of the eight cells around a place.
#[derive(Clone, Copy)]
pub struct Search {
    first: Cell,
    /// The cell that is looked through.
    corner: u32,
    /// One more than the number of the photon that is looked at next; 0 at the end of a list.
    next: u32,
}

impl Search {
    /// Is there more to look at?
    #[inline(always)]
    pub fn goes_on(&self) -> bool {
        self.corner < 8
    }

    #[inline(always)]
    fn cell(&self) -> Cell {
        let (x, y, z) = self.first;
        (x + (self.corner & 1), y + ((self.corner >> 1) & 1), z + (self.corner >> 2))
    }

    /// Looks at the next photon. Returns its number and place, where it is one of the sample's in the cell, and the search after that.
    #[inline(always)]
    pub fn step(self, frame: &Frame, grid: &Grid, photons: &Photons<'_>) -> (Self, u32, V3<f32>, bool) {
        let mut search = self;
        if search.next == 0 {
            search.corner += 1;
            if search.corner < 8 {
                search.next = read(photons.heads, grid.list(search.cell()));
            }
            return (search, 0, V3::zero(), false);
        }
        let number = search.next - 1;
        let (place, next) = Landed::place(number, photons.records);
        search.next = next;
        let count = if frame.photons == 0 { 1 } else { frame.photons };
        // Other samples and other cells may share the list.
        let is_own = number / count == grid.sample && grid.cell(place, 0.0) == search.cell();
        (search, number, place, is_own)
    }
}

/// Puts a photon into the list of its cell, if it has landed. `exchange` gives a list another first photon, by one more than its number, and returns the
/// one before.
#[inline(always)]
pub fn file(frame: &Frame, slot: u32, records: &mut [UVec4], exchange: impl FnOnce(u32, u32) -> u32) {
    if !Landed::is_there(slot, records) {
        return;
    }
    let count = if frame.photons == 0 { 1 } else { frame.photons };
    let sample = slot / count;
    let grid = Grid::new(frame, sample, radius(frame, frame.sample + sample));
    let (place, _) = Landed::place(slot, records);
    let next = exchange(grid.list(grid.cell(place, 0.0)), slot + 1);
    write(records, RECORDS * slot, f32::store(place, next));
}
