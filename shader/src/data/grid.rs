//! Grids of numbers, as words.

/// The words of a table of what glows: the bits of its steps over a kelvin, and for each step's temperature from 0 on three numbers, linear RGB
/// of the light of a black body, over the luminance of that of the last.
pub struct GlowTable;

impl GlowTable {
    /// How many temperatures there are, of which the last goes on.
    pub const TEMPERATURES: u32 = 256;
    /// All its words.
    pub const WORDS: u32 = 1 + 3 * Self::TEMPERATURES;
}

/// Cells along an edge of a block.
pub const CELLS: u32 = 8;

/// The words of a grid: where it is, how large, and its blocks. Each block has a record of two words, its greatest number and the place of
/// its numbers from the grid's first word on: those at the corners of its cells, of which neighbours share a face, x first.
pub struct Grid;

impl Grid {
    /// Twelve numbers: rows that take places of the normalised scene to those where cells have edges of 1.
    pub const TRANSFORM: u32 = 0;
    /// Three whole numbers: cells along each axis.
    pub const CELLS: u32 = 12;
    /// Three whole numbers: blocks.
    pub const BLOCKS: u32 = 15;
    /// How far from the outermost corners the grid ends.
    pub const INSET: u32 = 18;
    /// The records of blocks, x first.
    pub const RECORDS: u32 = 20;
    /// In the place of a block's numbers: all are as the greatest.
    pub const EVEN: u32 = 0;
}
