//! How a picture is written.

use clap::Args;

use super::choice::choice;
use super::exposure::{Brightness, Exposure};
use crate::error::Result;
use crate::output::{self, Destination};
use eyerays::image::{BitDepth, Encoding, Format, ToneMap, WhiteBalance};
use eyerays::picture::Picture;

/// The options of what writes pictures.
#[derive(Args, Clone, Copy)]
pub(super) struct Look {
    /// Brighten the picture by this many stops; auto makes white what all but 1 % of the pixels with light are darker than
    #[arg(long, value_name = "EV|auto", default_value = "0", value_parser = Exposure::parse, allow_hyphen_values = true)]
    exposure: Exposure,
    /// The light that looks white, in kelvins: 2900 of light bulbs, 5000 of the sun [default: 6504, a screen's white]
    #[arg(long, value_name = "K", value_parser = white_balance)]
    white_balance: Option<WhiteBalance>,
    /// Bits a channel of a PNG: 8 or 16
    #[arg(long, value_name = "BITS", default_value_t = 8)]
    bits: u32,
    /// How a PNG shows light brighter than a screen's white
    #[arg(long, value_name = "MAP", value_parser = choice::<ToneMap>(), default_value_t = ToneMap::None)]
    tone: ToneMap,
    /// Floats of 16 bits in an .exr file; finite values beyond ±65504 become that
    #[arg(long)]
    half: bool,
}

/// The options of what shows pictures in a window.
#[cfg(feature = "view")]
#[derive(Args, Clone, Copy)]
pub(super) struct Shown {
    /// Brighten the picture by this many stops
    #[arg(long, value_name = "EV", default_value_t = 0.0, allow_hyphen_values = true)]
    exposure: f32,
    /// The light that looks white, in kelvins: 2900 of light bulbs, 5000 of the sun [default: 6504, a screen's white]
    #[arg(long, value_name = "K", value_parser = white_balance)]
    white_balance: Option<WhiteBalance>,
    /// How light brighter than a screen's white is shown
    #[arg(long, value_name = "MAP", value_parser = choice::<ToneMap>(), default_value_t = ToneMap::None)]
    tone: ToneMap,
}

#[cfg(feature = "view")]
impl Shown {
    /// As pixels show it.
    ///
    /// # Errors
    /// More stops than there are.
    pub fn encoding(&self) -> Result<Encoding> {
        let Shown { exposure: exposure_ev, white_balance: white, tone } = *self;
        let look = Encoding { exposure_ev, tone, white, ..Encoding::default() };
        look.scale()?;
        Ok(look)
    }
}

/// The share of the pixels with light that may be beyond white before it is said.
const MOST_BEYOND_WHITE: f64 = 1.0 / 3.0;

impl Look {
    /// Refuses what the format of the destination has not.
    pub fn check(&self, destination: &Destination) -> Result<()> {
        BitDepth::from_bits(self.bits)?;
        if destination.is_film() { Ok(()) } else { Ok(self.plain()?.check(destination.format()?)?) }
    }

    /// For a picture, whose brightness may decide.
    pub fn encoding(&self, picture: &Picture) -> Result<Encoding> {
        let exposure_ev = match self.exposure {
            Exposure::Stops(stops) => stops,
            Exposure::Auto => self.brightness(picture).exposure(),
        };
        Ok(Encoding { exposure_ev, ..self.plain()? })
    }

    /// For a picture of something else than light: as it is.
    pub fn as_it_is(&self) -> Result<Encoding> {
        Ok(Encoding { exposure_ev: 0.0, tone: ToneMap::None, white: None, ..self.plain()? })
    }

    /// How bright it is shown.
    pub fn exposure(&self) -> Exposure {
        self.exposure
    }

    /// How light brighter than white is shown.
    pub fn tone(&self) -> ToneMap {
        self.tone
    }

    /// Of a picture as its white is balanced.
    fn brightness(&self, picture: &Picture) -> Brightness {
        match self.white_balance {
            Some(white) => Brightness::of(&white.balanced(picture)),
            None => Brightness::of(picture),
        }
    }

    /// The same for a window, which is told how bright a picture is before there is one.
    #[cfg(feature = "view")]
    pub fn arguments(&self) -> Vec<String> {
        let white = self.white_balance.map(|white| format!("--white-balance={}", white.kelvins()));
        let shown = [format!("--exposure={}", self.exposure.stops()), format!("--tone={}", self.tone)];
        shown.into_iter().chain(white).collect()
    }

    fn plain(&self) -> Result<Encoding> {
        let bits = BitDepth::from_bits(self.bits)?;
        let (exposure_ev, white) = (self.exposure.stops(), self.white_balance);
        Ok(Encoding { exposure_ev, bits, half: self.half, tone: self.tone, white })
    }

    /// What to say of a picture that is mostly beyond white. Formats of light hold it all, and tone maps find a place for it.
    pub fn beyond_white(
        &self,
        picture: &Picture,
        encoding: &Encoding,
        destination: &Destination,
    ) -> Result<Option<String>> {
        if destination.is_film() || destination.format()? != Format::Png {
            return Ok(None);
        }
        let brightness = self.brightness(picture);
        let share = brightness.beyond_white(encoding.exposure_ev);
        if share <= MOST_BEYOND_WHITE {
            return Ok(None);
        }
        let (percent, stops) = (100.0 * share, brightness.exposure());
        Ok(Some(format!("{percent:.0} % of the light in the picture is beyond white: --exposure {stops:.1} shows it")))
    }

    /// Writes a picture.
    pub fn write(&self, picture: &Picture, destination: &Destination) -> Result<()> {
        output::write_picture(picture, destination, &self.encoding(picture)?)
    }
}

pub(super) fn white_balance(text: &str) -> std::result::Result<WhiteBalance, String> {
    let kelvins = text
        .strip_suffix(['k', 'K'])
        .unwrap_or(text)
        .parse()
        .map_err(|_| format!("{text:?} is no temperature; give kelvins"))?;
    WhiteBalance::of(kelvins).map_err(|error| error.to_string())
}
