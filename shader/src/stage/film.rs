//! The film: what the samples of every pixel come to, in sums that have no order. So a picture has the same bits whatever its samples
//! were parted into: launches, tiles, devices, machines.

use super::{AOV_WORDS, CLEARED, CatcherSums, Caught, NON_FINITE};
use crate::buffer::{read, write};
use crate::camera::Pixel;
use crate::data::{Frame, Launch, Quanta, Specialisation};
use crate::real::{Real, Scalar, V3};

/// A channel of a sample is a whole number of quanta of 2^-40, rounded to single precision before.
pub const LIGHT_FRACTION: u32 = 40;
/// A channel of a sample is less than 2^31 in magnitude; light beyond counts as that. 2^24 samples fit 96 bits.
pub const LIGHT_MOST: u32 = 31;
/// A square of a sample's [`brightness`] is a whole number of quanta of 2^-42.
pub const SQUARE_FRACTION: u32 = 42;
/// And less than 2^62: that of the most light.
pub const SQUARE_MOST: u32 = 62;

/// Words of a pixel that tells no noise: three a channel, and counts.
pub const FILM_WORDS: u32 = 10;
/// Words of a pixel with the squares of its samples' brightness, or of that of its blocks.
pub const NOISY_FILM_WORDS: u32 = 14;

/// Words of a pixel of a film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FilmWords {
    /// Of its light, see [`film_words`].
    pub light: u32,
    /// Arbitrary output variables behind them, of [`AOV_WORDS`] words each.
    pub aovs: u32,
}

impl FilmWords {
    /// Of a film of light alone.
    #[inline(always)]
    pub fn of_light(light: u32) -> Self {
        FilmWords { light, aovs: 0 }
    }

    /// Of the film of a launch of sampled light.
    #[inline(always)]
    pub fn sampled(frame: &Frame, spec: Specialisation) -> Self {
        // Known where there are none.
        let aovs = if spec.aovs.any() { frame.aovs } else { 0 };
        FilmWords { light: film_words(spec.launch, true), aovs }
    }

    /// All of them.
    #[inline(always)]
    pub fn all(self) -> u32 {
        self.light + self.aovs * AOV_WORDS
    }
}

/// More words of a pixel that knows shadow catchers: three a sum, and a count.
const CATCHER_WORDS: u32 = 7;

/// Words of the light of a pixel, with noise or without; one more where clear samples are counted, and more of one that tells noise where shadow
/// catchers are known.
#[inline(always)]
pub fn film_words(launch: Launch, is_noisy: bool) -> u32 {
    let words = if is_noisy { NOISY_FILM_WORDS } else { FILM_WORDS };
    let words = if launch.has(Launch::CATCHER) && is_noisy { words + CATCHER_WORDS } else { words };
    if launch.has(Launch::CLEAR) { words + 1 } else { words }
}

/// What a slot has of its pixel.
#[derive(Clone, Copy)]
pub struct Sample<R: Real> {
    /// Linear RGB.
    pub light: V3<R>,
    /// Counts shadow rays and holds [`NON_FINITE`] and [`CLEARED`].
    pub word: u32,
    /// What it has of a shadow catcher.
    pub caught: Caught<R>,
}

impl<R: Real> Sample<R> {
    /// Of a scene without shadow catchers.
    #[inline(always)]
    pub fn of((light, word): (V3<R>, u32)) -> Self {
        Sample { light, word, caught: Caught::nothing() }
    }
}

/// Samples of a block, the first of which has a multiple of so many for its number. Sobol's are placed evenly within it, so that the
/// means of blocks tell the noise of a picture, which single samples overstate.
pub const BLOCK: u32 = 16;

/// The mean of the channels: what noise is told of.
#[inline(always)]
pub fn brightness<R: Scalar>(colour: V3<R>) -> R {
    const THIRD: f32 = 1.0 / 3.0;
    (colour.x + colour.y + colour.z) * R::splat(THIRD)
}

/// What some samples of a pixel come to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PixelSums {
    /// Red light; of this and the next two the last word is not kept.
    pub red: Quanta,
    /// Green light.
    pub green: Quanta,
    /// Blue light.
    pub blue: Quanta,
    /// Shadow rays, and [`NON_FINITE`] if any sample has left something out.
    pub word: u32,
    /// Squares of brightness.
    pub squares: Quanta,
    /// Samples whose camera's ray found nothing.
    pub clear: u32,
    /// Of shadow catchers.
    pub catcher: CatcherSums,
}

impl PixelSums {
    /// One sample's, in a scene without shadow catchers.
    #[inline(always)]
    pub fn of<R: Scalar>(light: V3<R>, word: u32) -> Self {
        Self::of_sample(Sample::of((light, word)))
    }

    /// One sample's.
    #[inline(always)]
    pub fn of_sample<R: Scalar>(Sample { light, word, caught }: Sample<R>) -> Self {
        let channel = |c: R| Quanta::of(c.to_f32(), LIGHT_FRACTION, LIGHT_MOST);
        let squares = squared(brightness(light));
        PixelSums {
            red: channel(light.x),
            green: channel(light.y),
            blue: channel(light.z),
            word: word & !CLEARED,
            squares,
            clear: if word & CLEARED == 0 { 0 } else { 1 },
            catcher: CatcherSums::of(caught),
        }
    }

    /// These samples and others.
    #[inline(always)]
    pub fn plus(self, other: Self) -> Self {
        PixelSums {
            red: self.red.plus(other.red),
            green: self.green.plus(other.green),
            blue: self.blue.plus(other.blue),
            word: counted(self.word, other.word),
            squares: self.squares.plus(other.squares),
            clear: self.clear + other.clear,
            catcher: self.catcher.plus(other.catcher),
        }
    }

    /// Those of the pixel in column `x` of a row of a film, which holds one word of all its pixels after another.
    #[inline(always)]
    pub fn load(film: &[u32], row: Row, x: u32) -> Self {
        let at = |word: u32| read(film, row.first + word * row.columns + x);
        let channel = |word| Quanta(at(word), at(word + 1), at(word + 2), 0);
        let squares = if row.is_noisy() { Quanta(at(10), at(11), at(12), at(13)) } else { Quanta::default() };
        let clear = if row.counts_clear() { at(row.words - 1) } else { 0 };
        let catcher = if row.knows_catchers() {
            CatcherSums { full: channel(14), lit: channel(17), count: at(20) }
        } else {
            CatcherSums::default()
        };
        PixelSums { red: channel(0), green: channel(3), blue: channel(6), word: at(9), squares, clear, catcher }
    }

    /// Keeps them there.
    #[inline(always)]
    pub fn store(self, film: &mut [u32], row: Row, x: u32) {
        let mut keep = |word: u32, value| write(film, row.first + word * row.columns + x, value);
        keep(0, self.red.0);
        keep(1, self.red.1);
        keep(2, self.red.2);
        keep(3, self.green.0);
        keep(4, self.green.1);
        keep(5, self.green.2);
        keep(6, self.blue.0);
        keep(7, self.blue.1);
        keep(8, self.blue.2);
        keep(9, self.word);
        if row.is_noisy() {
            keep(10, self.squares.0);
            keep(11, self.squares.1);
            keep(12, self.squares.2);
            keep(13, self.squares.3);
        }
        if row.knows_catchers() {
            keep(14, self.catcher.full.0);
            keep(15, self.catcher.full.1);
            keep(16, self.catcher.full.2);
            keep(17, self.catcher.lit.0);
            keep(18, self.catcher.lit.1);
            keep(19, self.catcher.lit.2);
            keep(20, self.catcher.count);
        }
        if row.counts_clear() {
            keep(row.words - 1, self.clear);
        }
    }
}

/// The square of a brightness.
#[inline(always)]
fn squared<R: Scalar>(bright: R) -> Quanta {
    Quanta::of((bright * bright).to_f32(), SQUARE_FRACTION, SQUARE_MOST)
}

/// Where a row of a film is.
#[derive(Clone, Copy)]
pub struct Row {
    /// Its first word.
    pub first: u32,
    /// Its pixels.
    pub columns: u32,
    /// Words of the light of a pixel, see [`film_words`].
    pub words: u32,
}

impl Row {
    /// A row of a film of so many columns.
    #[inline(always)]
    pub fn new(y: u32, columns: u32, words: FilmWords) -> Self {
        Row { first: y * words.all() * columns, columns, words: words.light }
    }

    /// Where a word of an arbitrary output variable is.
    #[inline(always)]
    pub fn aov(self, number: u32, word: u32) -> u32 {
        self.first + (self.words + number * AOV_WORDS + word) * self.columns
    }

    /// Does a pixel have squares?
    #[inline(always)]
    pub fn is_noisy(self) -> bool {
        self.words >= NOISY_FILM_WORDS
    }

    /// Does it count clear samples?
    #[inline(always)]
    pub fn counts_clear(self) -> bool {
        self.words == FILM_WORDS + 1 || self.words == NOISY_FILM_WORDS + 1 || self.knows_catchers()
    }

    /// Does it know shadow catchers? Then it counts clear samples, too.
    #[inline(always)]
    pub fn knows_catchers(self) -> bool {
        self.words == NOISY_FILM_WORDS + CATCHER_WORDS + 1
    }
}

/// Adds the samples that a launch has of a pixel to the film of its region. `slot` is that of the first, `sample` tells light and
/// counts of a slot.
#[inline(always)]
pub fn expose<R: Scalar>(
    frame: &Frame,
    (pixel, slot): (Pixel, u32),
    words: FilmWords,
    sample: impl Fn(u32) -> Sample<R>,
    film: &mut [u32],
) {
    if !pixel.inside || slot >= frame.pixel_slots {
        return;
    }
    let row = Row::new(pixel.y, frame.columns, words);
    let mut sums = PixelSums::default();
    if frame.anew == 0 {
        sums = PixelSums::load(film, row, pixel.x);
    }
    let mut at = slot;
    while at < frame.slots {
        sums = sums.plus(PixelSums::of_sample(sample(at)));
        at += frame.pixel_slots;
    }
    sums.store(film, row, pixel.x);
}

/// The same for a launch of whole blocks, of which the film keeps the squares of what each is in the mean.
#[inline(always)]
pub fn expose_blocks<R: Scalar>(
    frame: &Frame,
    (pixel, slot): (Pixel, u32),
    words: FilmWords,
    sample: impl Fn(u32) -> Sample<R>,
    film: &mut [u32],
) {
    if !pixel.inside || slot >= frame.pixel_slots {
        return;
    }
    const SHARE: f32 = 1.0 / BLOCK as f32;
    let row = Row::new(pixel.y, frame.columns, words);
    let mut sums = PixelSums::default();
    if frame.anew == 0 {
        sums = PixelSums::load(film, row, pixel.x);
    }
    let (mut at, mut number, mut bright) = (slot, 0, R::splat(0.0));
    while at < frame.slots {
        let sample = sample(at);
        bright = bright + brightness(sample.light);
        number += 1;
        let ends = number % BLOCK == 0;
        let squares = if ends { squared(bright * R::splat(SHARE)) } else { Quanta::default() };
        bright = if ends { R::splat(0.0) } else { bright };
        sums = sums.plus(PixelSums { squares, ..PixelSums::of_sample(sample) });
        at += frame.pixel_slots;
    }
    sums.store(film, row, pixel.x);
}

/// The integers of two sums together: shadow rays are counted, what was left out is remembered.
#[inline(always)]
fn counted(word: u32, own: u32) -> u32 {
    ((word | own) & NON_FINITE) | ((word & !NON_FINITE) + (own & !NON_FINITE)) & !NON_FINITE
}

#[cfg(test)]
mod tests;
