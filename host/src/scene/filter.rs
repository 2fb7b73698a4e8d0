//! How textures are filtered.

use eyerays_shader::data::Launch;

use crate::choice::choices;

choices! {
    /// What a ray sees of a texture. The same on every device.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum Filter {
        /// The nearest texel
        Nearest = "nearest",
        /// The four texels around, of the texture as it is
        Bilinear = "bilinear",
        /// The four around, of that of its levels whose texels are as large as the ray is wide
        #[default]
        Mipmap = "mipmap",
    }
}

impl Filter {
    /// Bits of the constant of kernels, see [`Launch`].
    pub fn bits(self) -> u32 {
        match self {
            Filter::Nearest => Launch::NEAREST,
            Filter::Bilinear => 0,
            Filter::Mipmap => Launch::MIPMAPPED,
        }
    }
}
