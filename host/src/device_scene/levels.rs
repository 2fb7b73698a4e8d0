//! Coarser and coarser levels of a texture: each texel is the mean of the light of those that it covers.

use rayon::prelude::*;

use crate::image::{byte_to_linear, quantise_to_byte};
use crate::scene::{Texels, Texture};

/// Bytes that [`append`] takes for a while, by texel of the finest level: four floats for each of the next two levels' texels.
pub(super) const BYTES_PER_TEXEL: u64 = 5;

/// The levels of a texture, and the words of them all.
pub(super) fn size(texture: &Texture) -> (u32, u64) {
    let (mut width, mut height) = (texture.width, texture.height);
    let (mut levels, mut texels) = (1, u64::from(width) * u64::from(height));
    while width > 1 || height > 1 {
        (width, height) = (half(width), half(height));
        levels += 1;
        texels += u64::from(width) * u64::from(height);
    }
    (levels, texels * if is_float(texture) { 4 } else { 1 })
}

/// Adds the words of all levels, the finest first, and returns the mean of all light, linear RGB, before it is rounded to words.
/// Colours of 8 bits are sRGB.
pub(super) fn append(texture: &Texture, is_colour: bool, words: &mut Vec<u32>) -> [f32; 3] {
    finest(texture, words);
    let mut level = first_half(texture, is_colour);
    if texture.width == 1 && texture.height == 1 {
        return level.only();
    }
    loop {
        if is_float(texture) {
            words.par_extend(level.texels.par_iter().flat_map_iter(|texel| texel.iter().map(|x| x.to_bits())));
        } else {
            words.par_extend(level.texels.par_iter().map(|texel| u32::from_le_bytes(encoded(*texel, is_colour))));
        }
        if level.width == 1 && level.height == 1 {
            return level.only();
        }
        level = Level::halved(level.width, level.height, |i| level.texels[i]);
    }
}

fn is_float(texture: &Texture) -> bool {
    matches!(texture.texels, Texels::Floats(_))
}

/// A side of the next level.
fn half(side: u32) -> u32 {
    (side / 2).max(1)
}

/// The level after the finest, of which no copy is made.
fn first_half(texture: &Texture, is_colour: bool) -> Level {
    let share = |byte: u8| f32::from(byte) / 255.0;
    let colour = |byte: u8| if is_colour { byte_to_linear(byte) } else { share(byte) };
    let (width, height) = (texture.width, texture.height);
    match &texture.texels {
        Texels::Bytes(bytes) => Level::halved(width, height, |i| {
            let [r, g, b, a] = bytes[i];
            [colour(r), colour(g), colour(b), share(a)]
        }),
        Texels::Floats(floats) => Level::halved(width, height, |i| floats[i]),
    }
}

/// The finest level as it is.
fn finest(texture: &Texture, words: &mut Vec<u32>) {
    match &texture.texels {
        Texels::Bytes(bytes) => words.par_extend(bytes.par_iter().map(|&bytes| u32::from_le_bytes(bytes))),
        Texels::Floats(floats) => words.par_extend(floats.as_flattened().par_iter().map(|x| x.to_bits())),
    }
}

fn encoded([r, g, b, a]: [f32; 4], is_colour: bool) -> [u8; 4] {
    let share = |x: f32| (x * 255.0).round() as u8;
    let colour = |x: f32| if is_colour { quantise_to_byte(x.into()) } else { share(x) };
    [colour(r), colour(g), colour(b), share(a)]
}

/// Linear RGB and opacity of each texel.
struct Level {
    width: u32,
    height: u32,
    texels: Vec<[f32; 4]>,
}

impl Level {
    /// Half as wide and high as a level of this size, rounded down; each texel is the mean of what it covers, parts of texels
    /// included.
    fn halved(finer_width: u32, finer_height: u32, finer: impl Fn(usize) -> [f32; 4] + Sync) -> Level {
        let (width, height) = (half(finer_width), half(finer_height));
        let columns: Vec<Span> = (0..width).map(|i| Span::of(i, width, finer_width)).collect();
        let mut texels = vec![[0.0; 4]; width as usize * height as usize];
        texels.par_chunks_mut(width as usize).zip(0..height).for_each(|(row, y)| {
            let rows = Span::of(y, height, finer_height);
            for (texel, columns) in row.iter_mut().zip(&columns) {
                *texel = mean(columns, &rows, |x, y| finer(y * finer_width as usize + x));
            }
        });
        Level { width, height, texels }
    }

    /// The light of its only texel.
    fn only(&self) -> [f32; 3] {
        let [r, g, b, _] = self.texels[0];
        [r, g, b]
    }
}

fn mean(columns: &Span, rows: &Span, texel: impl Fn(usize, usize) -> [f32; 4]) -> [f32; 4] {
    let mut sum = [0.0f64; 4];
    for (y, down) in rows.weights() {
        for (x, across) in columns.weights() {
            for (sum, value) in sum.iter_mut().zip(texel(x, y)) {
                *sum += f64::from(value) * down * across;
            }
        }
    }
    sum.map(|x| x as f32)
}

/// The texels that one of a coarser level covers along an axis.
struct Span {
    first: usize,
    weights: [f64; 3],
}

impl Span {
    /// Of texel `i` of `count`, where the finer level has `finer`, at most three times as many and one more.
    fn of(i: u32, count: u32, finer: u32) -> Span {
        let size = f64::from(finer) / f64::from(count);
        let (start, end) = (f64::from(i) * size, f64::from(i + 1) * size);
        let first = start as usize;
        let weight = |k: usize| {
            let texel = (first + k) as f64;
            (end.min(texel + 1.0) - start.max(texel)).max(0.0) / size
        };
        Span { first, weights: [weight(0), weight(1), weight(2)] }
    }

    fn weights(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.weights
            .iter()
            .enumerate()
            .filter(|(_, weight)| **weight > 0.0)
            .map(|(k, &weight)| (self.first + k, weight))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texture(width: u32, height: u32, texel: impl Fn(u32, u32) -> [f32; 3]) -> Texture {
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let texels = places.map(|(x, y)| texel(x, y)).map(|[r, g, b]| [r, g, b, 0.25]).collect();
        Texture { name: "test".into(), width, height, texels: Texels::Floats(texels) }
    }

    /// The mean of all light is that of the last level, whatever the sides.
    #[test]
    fn light_is_kept_from_level_to_level() {
        for (width, height) in [(1, 1), (2, 2), (8, 4), (3, 3), (7, 5), (1, 9), (100, 3)] {
            let picture = texture(width, height, |x, y| [x as f32, (y * y) as f32, 1.0]);
            let mut words = Vec::new();
            let mean_of_all = append(&picture, true, &mut words);
            assert_eq!(size(&picture), (1 + width.max(height).ilog2(), words.len() as u64));
            let last: Vec<f32> = words[words.len() - 4..].iter().map(|&word| f32::from_bits(word)).collect();
            assert_eq!((&last[..3], last[3]), (&mean_of_all[..], 0.25));
            let mean = |of: &dyn Fn(u32) -> f64, count: u32| (0..count).map(of).sum::<f64>() / f64::from(count);
            let want = [mean(&|x| f64::from(x), width), mean(&|y| f64::from(y * y), height), 1.0];
            for (got, want) in last.into_iter().zip(want) {
                assert!((f64::from(got) - want).abs() <= 1e-5 * want.max(1.0), "{width}x{height}: {got}, not {want}");
            }
        }
    }

    /// Words are rounded, the mean is not.
    #[test]
    fn a_single_faint_texel_is_light_and_a_black_picture_is_none() {
        let mut bytes = vec![[0, 0, 0, 255]; 256 * 256];
        let mean = |bytes: &[[u8; 4]]| {
            let picture =
                Texture { name: "test".into(), width: 256, height: 256, texels: Texels::Bytes(bytes.to_vec()) };
            append(&picture, true, &mut Vec::new())
        };
        assert_eq!(mean(&bytes), [0.0; 3]);
        bytes[77] = [1, 0, 0, 255];
        let [red, green, blue] = mean(&bytes);
        assert!(red > 0.0 && (green, blue) == (0.0, 0.0), "{red}");
    }

    /// Half black and half white is half of the light, which in sRGB is 188.
    #[test]
    fn colours_are_mixed_as_light() {
        let texels = Texels::Bytes(vec![[0, 0, 0, 255], [255, 255, 255, 0]]);
        let picture = Texture { name: "test".into(), width: 2, height: 1, texels };
        for (is_colour, want) in [(true, 188), (false, 128)] {
            let mut words = Vec::new();
            append(&picture, is_colour, &mut words);
            assert_eq!(words.len(), 3);
            assert_eq!(words[2].to_le_bytes(), [want, want, want, 128]);
        }
    }
}
