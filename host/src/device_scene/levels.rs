//! Coarser and coarser levels of a texture: each texel is the mean of the light of those that it covers.

use rayon::prelude::*;

use crate::image::{byte_to_linear, quantise_to_byte};
use crate::scene::{Texels, Texture};

/// Adds the words of all levels, the finest first, and returns how many levels there are. Colours of 8 bits are sRGB.
pub(super) fn append(texture: &Texture, is_colour: bool, words: &mut Vec<u32>) -> u32 {
    let mut level = Level::of(texture, is_colour);
    let is_float = matches!(texture.texels, Texels::Floats(_));
    let mut count = 1;
    finest(texture, words);
    while level.width > 1 || level.height > 1 {
        level = level.halved();
        for texel in &level.texels {
            if is_float {
                words.extend(texel[..3].iter().map(|x| x.to_bits()));
            } else {
                words.push(u32::from_le_bytes(encoded(*texel, is_colour)));
            }
        }
        count += 1;
    }
    count
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
    width: usize,
    height: usize,
    texels: Vec<[f32; 4]>,
}

impl Level {
    fn of(texture: &Texture, is_colour: bool) -> Level {
        let share = |byte: u8| f32::from(byte) / 255.0;
        let colour = |byte: u8| if is_colour { byte_to_linear(byte) } else { share(byte) };
        let texels = match &texture.texels {
            Texels::Bytes(bytes) => {
                let texel = |&[r, g, b, a]: &[u8; 4]| [colour(r), colour(g), colour(b), share(a)];
                bytes.par_iter().map(texel).collect()
            }
            Texels::Floats(floats) => floats.par_iter().map(|&[r, g, b]| [r, g, b, 1.0]).collect(),
        };
        Level { width: texture.width as usize, height: texture.height as usize, texels }
    }

    /// Half as wide and high, rounded down; each texel is the mean of what it covers, parts of texels included.
    fn halved(&self) -> Level {
        let (width, height) = ((self.width / 2).max(1), (self.height / 2).max(1));
        let columns: Vec<Span> = (0..width).map(|i| Span::of(i, width, self.width)).collect();
        let row = |y: usize| {
            let rows = Span::of(y, height, self.height);
            let texel = |columns: &Span| self.mean(columns, &rows);
            columns.iter().map(texel).collect::<Vec<_>>()
        };
        let texels = (0..height).into_par_iter().flat_map_iter(row).collect();
        Level { width, height, texels }
    }

    fn mean(&self, columns: &Span, rows: &Span) -> [f32; 4] {
        let mut sum = [0.0f64; 4];
        for (y, down) in rows.weights() {
            for (x, across) in columns.weights() {
                for (sum, value) in sum.iter_mut().zip(self.texels[y * self.width + x]) {
                    *sum += f64::from(value) * down * across;
                }
            }
        }
        sum.map(|x| x as f32)
    }
}

/// The texels that one of a coarser level covers along an axis.
struct Span {
    first: usize,
    weights: [f64; 3],
}

impl Span {
    /// Of texel `i` of `count`, where the finer level has `finer`, at most three times as many and one more.
    fn of(i: usize, count: usize, finer: usize) -> Span {
        let size = finer as f64 / count as f64;
        let (start, end) = (i as f64 * size, (i + 1) as f64 * size);
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
        let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| texel(x, y)).collect();
        Texture { name: "test".into(), width, height, texels: Texels::Floats(texels) }
    }

    /// The mean of all light is that of the last level, whatever the sides.
    #[test]
    fn light_is_kept_from_level_to_level() {
        for (width, height) in [(1, 1), (2, 2), (8, 4), (3, 3), (7, 5), (1, 9), (100, 3)] {
            let picture = texture(width, height, |x, y| [x as f32, (y * y) as f32, 1.0]);
            let mut words = Vec::new();
            let levels = append(&picture, true, &mut words);
            assert_eq!(levels, 1 + width.max(height).ilog2());
            let last: Vec<f32> = words[words.len() - 3..].iter().map(|&word| f32::from_bits(word)).collect();
            let mean = |of: &dyn Fn(u32) -> f64, count: u32| (0..count).map(of).sum::<f64>() / f64::from(count);
            let want = [mean(&|x| f64::from(x), width), mean(&|y| f64::from(y * y), height), 1.0];
            for (got, want) in last.into_iter().zip(want) {
                assert!((f64::from(got) - want).abs() <= 1e-5 * want.max(1.0), "{width}x{height}: {got}, not {want}");
            }
        }
    }

    /// Half black and half white is half of the light, which in sRGB is 188.
    #[test]
    fn colours_are_mixed_as_light() {
        let texels = Texels::Bytes(vec![[0, 0, 0, 255], [255, 255, 255, 0]]);
        let picture = Texture { name: "test".into(), width: 2, height: 1, texels };
        for (is_colour, want) in [(true, 188), (false, 128)] {
            let mut words = Vec::new();
            assert_eq!(append(&picture, is_colour, &mut words), 2);
            assert_eq!(words[2].to_le_bytes(), [want, want, want, 128]);
        }
    }
}
