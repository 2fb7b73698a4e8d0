//! Image files: pictures encoded for a screen or kept as they are, and read again.
//!
//! | Format | Values | Loses |
//! |---|---|---|
//! | PNG | sRGB, 8 or 16 bit, by a [`ToneMap`] or without | what is outside \[0, 1\], and rounds |
//! | OpenEXR | linear, 32-bit floats | nothing at an exposure of 0 |
//! | OpenEXR, half | linear, 16-bit floats | what is beyond ±65504, and about 0.05 % |
//! | Radiance HDR | linear, 8 bit and a shared exponent | negative values, and about 1 % |

mod agx;
mod bounded;
mod encode;
mod exr;
mod hdr;
mod jpeg;
mod layer;
mod parts;
mod png;
mod read;
mod relief;
mod texels;
mod tone;
mod transfer;
mod white;

use std::fmt;
use std::path::Path;

use crate::error::{Error, Result};
use crate::math;

pub use encode::{encode, encode_layers, screen};
pub use layer::{decode_layer, read_layer};
pub use read::{decode, read};
pub use relief::{Relief, read_relief};
pub use texels::{TextureBudget, decode_texture, read_heights, read_texture};
pub use tone::ToneMap;
pub(crate) use transfer::{byte_to_linear, least_of_byte};
pub use transfer::{linear_to_srgb, quantise_to_byte, srgb_to_linear};
pub use white::WhiteBalance;
pub(crate) use white::from_xyz;

/// What wrote a file.
const SOFTWARE: &str = concat!("eyerays ", env!("CARGO_PKG_VERSION"));

/// The image formats that are written and read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Portable Network Graphics, `.png`.
    Png,
    /// OpenEXR, `.exr`.
    Exr,
    /// Radiance RGBE, `.hdr`.
    Hdr,
}

impl Format {
    /// The format that a file's extension names, in upper or lower case.
    ///
    /// # Errors
    /// No extension or another one.
    pub fn from_path(path: &Path) -> Result<Self> {
        let extension = path.extension().unwrap_or_default().to_string_lossy();
        match extension.to_ascii_lowercase().as_str() {
            "png" => Ok(Format::Png),
            "exr" => Ok(Format::Exr),
            "hdr" => Ok(Format::Hdr),
            "" => Err(Error::file(path, "no extension says which image format; end the name in .png, .exr or .hdr")),
            other => Err(Error::file(path, format!("unknown image format \"{other}\"; use .png, .exr or .hdr"))),
        }
    }

    /// How it is called.
    pub fn name(self) -> &'static str {
        match self {
            Format::Png => "PNG",
            Format::Exr => "EXR",
            Format::Hdr => "HDR",
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.name())
    }
}

/// Bits of a PNG's channel; the other formats have their own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BitDepth {
    /// 256 steps.
    #[default]
    Eight,
    /// 65,536 steps.
    Sixteen,
}

impl BitDepth {
    /// The depth of 8 or 16 bits.
    ///
    /// # Errors
    /// Any other number.
    pub fn from_bits(bits: u32) -> Result<Self> {
        match bits {
            8 => Ok(BitDepth::Eight),
            16 => Ok(BitDepth::Sixteen),
            _ => Err(Error::new(format!("a PNG of {bits} bits a channel cannot be written; choose 8 or 16"))),
        }
    }
}

/// How a picture becomes a file.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Encoding {
    /// Exposure in stops, at most [`Encoding::MAX_EXPOSURE`] either way: every value is
    /// multiplied by 2 to this power, in every format. 0 changes no bit.
    pub exposure_ev: f32,
    /// Of a PNG.
    pub bits: BitDepth,
    /// Floats of 16 bits instead of 32; only in an EXR.
    pub half: bool,
    /// After the exposure; only in a PNG, as the other formats keep light as it is.
    pub tone: ToneMap,
    /// Which light looks white, in every format; without one Rec. 709's, which changes no bit.
    pub white: Option<WhiteBalance>,
}

impl Encoding {
    /// More stops than lie between the least and the greatest normal `f32`.
    pub const MAX_EXPOSURE: f32 = 256.0;

    /// Whether a file of the format can be written so.
    ///
    /// # Errors
    /// Those of [`Encoding::scale`], floats of 16 bits in another format than EXR, and a tone map in another than PNG.
    pub fn check(&self, format: Format) -> Result<()> {
        if self.half && format != Format::Exr {
            return Err(Error::NoHalf { format: format.name() });
        }
        if self.tone != ToneMap::None && format != Format::Png {
            return Err(Error::NoTone { format: format.name() });
        }
        self.scale().map(drop)
    }

    /// The factor of the exposure.
    ///
    /// # Errors
    /// An exposure that is out of range or not a number.
    pub fn scale(&self) -> Result<f64> {
        if self.exposure_ev.abs() <= Self::MAX_EXPOSURE {
            Ok(math::exp2(self.exposure_ev.into()))
        } else {
            Err(Error::new(format!(
                "an exposure of {} stops is out of range; choose one from -{max} to {max}",
                self.exposure_ev,
                max = Self::MAX_EXPOSURE
            )))
        }
    }
}

#[cfg(test)]
mod hostile;
#[cfg(test)]
mod layers;
#[cfg(test)]
mod tests;
