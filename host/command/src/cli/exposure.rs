//! How bright a picture is shown.

use eyerays::math;
use eyerays::picture::Picture;

/// What `--exposure` asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Exposure {
    /// So many stops brighter.
    Stops(f32),
    /// As bright as [`Brightness::exposure`] says.
    Auto,
}

impl Exposure {
    /// Of a word of the command line.
    pub fn parse(text: &str) -> Result<Self, String> {
        if text == "auto" {
            return Ok(Exposure::Auto);
        }
        text.parse().map(Exposure::Stops).map_err(|_| "write stops, for example -1.5, or auto".to_owned())
    }

    /// The stops that are asked for; 0 until a picture is there to say.
    pub fn stops(self) -> f32 {
        match self {
            Exposure::Stops(stops) => stops,
            Exposure::Auto => 0.0,
        }
    }
}

/// The brightest channel of each pixel that has light.
pub(super) struct Brightness(Vec<f32>);

/// The share of the pixels with light that are no brighter than white at [`Brightness::exposure`].
const SHOWN: f64 = 0.99;

impl Brightness {
    /// That of a picture.
    pub fn of(picture: &Picture) -> Self {
        let greatest = picture.pixels.iter().map(|pixel| pixel.iter().copied().fold(0.0, f32::max));
        Brightness(greatest.filter(|light| light.is_finite() && *light > 0.0).collect())
    }

    /// The share of it that is beyond white where a picture is brightened by so many stops; 0 of a black picture.
    pub fn beyond_white(&self, stops: f32) -> f64 {
        let white = math::exp2(-f64::from(stops));
        let within = self.0.iter().filter(|&&light| f64::from(light) <= white).count();
        if self.0.is_empty() { 0.0 } else { 1.0 - within as f64 / self.0.len() as f64 }
    }

    /// The stops that make white what 99 % of the pixels with light are no brighter than, rounded down to tenths; 0 for a black
    /// picture.
    pub fn exposure(&self) -> f32 {
        let place = (self.0.len() as f64 * SHOWN).ceil() as usize;
        if self.0.is_empty() {
            return 0.0;
        }
        let mut light = self.0.clone();
        let (_, &mut light, _) = light.select_nth_unstable_by(place.saturating_sub(1), f32::total_cmp);
        ((-math::log2(f64::from(light)) * 10.0).floor() / 10.0) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(light: impl Iterator<Item = f32>) -> Picture {
        let pixels: Vec<_> = light.map(|light| [light / 2.0, light, 0.0]).collect();
        Picture::from_pixels(pixels.len() as u32, 1, pixels).unwrap()
    }

    #[test]
    fn the_exposure_makes_white_what_all_but_a_hundredth_of_the_light_is_darker_than() {
        let brightness = Brightness::of(&picture((0..=200).map(|step| step as f32 * 4.0)));
        // Of 200 pixels with light, 198 are at most 792, which is 2^9.63.
        assert_eq!(brightness.exposure(), -9.7);
        assert!(brightness.beyond_white(-9.7) <= 0.01);
        assert_eq!(brightness.beyond_white(0.0), 1.0);
        assert_eq!(brightness.beyond_white(-8.0), 1.0 - 64.0 / 200.0);
        let dim = Brightness::of(&picture([0.0, 0.125, 0.125].into_iter()));
        assert_eq!((dim.exposure(), dim.beyond_white(3.0), dim.beyond_white(3.1)), (3.0, 0.0, 1.0));
    }

    #[test]
    fn a_black_picture_stays_as_it_is() {
        let black = Brightness::of(&picture([0.0, 0.0].into_iter()));
        assert_eq!((black.exposure(), black.beyond_white(5.0)), (0.0, 0.0));
    }

    #[test]
    fn stops_and_auto_are_read_and_all_else_is_refused() {
        assert_eq!(Exposure::parse("-9.4"), Ok(Exposure::Stops(-9.4)));
        assert_eq!(Exposure::parse("auto"), Ok(Exposure::Auto));
        assert!(Exposure::parse("bright").is_err());
    }
}
