//! Where in a pixel its samples lie.

use eyerays_shader::data::Launch;

use crate::choice::choices;

choices! {
    /// Where in a pixel its samples lie (thesis 3.4.5). The same places on every device, other ones in every pixel.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum Sampler {
        /// In the centres of a grid's cells
        #[default]
        Regular = "regular",
        /// Anywhere in the cells of a grid, one in each
        Jittered = "jittered",
        /// Anywhere, each by itself
        Random = "random",
        /// Evenly in both directions and over the pixel, without a grid: Sobol's sequence, scrambled
        Sobol = "sobol",
    }
}

impl Sampler {
    /// Does it place samples in the cells of a grid, so that there must be a square number of them?
    pub fn has_cells(self) -> bool {
        matches!(self, Sampler::Regular | Sampler::Jittered)
    }

    /// Bits of the constant of kernels, see [`Launch`].
    pub fn bits(self) -> u32 {
        match self {
            Sampler::Regular => 0,
            Sampler::Jittered => Launch::JITTERED,
            Sampler::Random => Launch::RANDOM,
            Sampler::Sobol => Launch::SOBOL,
        }
    }
}
