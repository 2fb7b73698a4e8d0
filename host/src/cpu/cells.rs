//! Samples of cells, of a picture that ends by its noise.

use std::ops::Range;

use eyerays_kernels_cpu::Number;
use eyerays_shader::stage::BLOCK;
use rayon::prelude::*;

use super::render::Renderer;
use crate::film::Layout;
use crate::noise::CellSums;
use crate::view::{Region, View};

/// Edge of a piece of a cell in pixels: with all samples of a block in flight it has as many slots as a tile of a picture.
const PIECE: u32 = 8;
/// Samples of a piece that a thread takes at once, whole blocks, so that all threads have something to do where few cells are left.
const CHUNK: u32 = 64;

/// Samples of a piece of a cell.
struct Chunk {
    /// The cell's place among those that are rendered.
    cell: usize,
    piece: Region,
    samples: Range<u32>,
}

impl Renderer {
    /// The sums of whole blocks of samples of some cells.
    pub(crate) fn cells<R: Number>(&self, view: &View, cells: &[Region], samples: Range<u32>) -> CellSums {
        let words = self.planned.film_words();
        let mut all = CellSums { sums: cells.iter().map(|&cell| self.planned.film(cell)).collect(), secondary: 0 };
        // Photons are those of a block, for all cells.
        let step = if self.planned.photons.is_some() { BLOCK as usize } else { samples.len().max(1) };
        for first in samples.clone().step_by(step) {
            let samples = first..samples.end.min(first + step as u32);
            let done: Vec<(Chunk, Vec<u32>, u64)> = self.install(|| {
                let map = self.planned.map::<R>(view, first, BLOCK);
                let run = |chunk: Chunk| {
                    let (sums, secondary) = self.planned.blocks::<R>(view, chunk.piece, (chunk.samples.clone(), &map));
                    (chunk, sums, secondary)
                };
                chunks(cells, samples).into_par_iter().with_max_len(1).map(run).collect()
            });
            for (chunk, sums, secondary) in done {
                Layout { region: cells[chunk.cell], words }.add(&mut all.sums[chunk.cell], chunk.piece, &sums);
                all.secondary += secondary;
            }
        }
        all
    }
}

fn chunks(cells: &[Region], samples: Range<u32>) -> Vec<Chunk> {
    let mut chunks = Vec::new();
    for (cell, region) in cells.iter().enumerate() {
        for piece in region.pieces(PIECE, PIECE) {
            let starts = samples.clone().step_by(CHUNK as usize);
            let ranges = starts.map(|start| start..samples.end.min(start + CHUNK));
            chunks.extend(ranges.map(|samples| Chunk { cell, piece, samples }));
        }
    }
    chunks
}
