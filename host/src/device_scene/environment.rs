//! An environment as kernels read it, see [`eyerays_shader::light::Environment`].

use std::f64::consts::{PI, TAU};

use eyerays_shader::light::HEADER;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::normalisation::flushed_number;
use crate::error::{Error, Result};
use crate::image::byte_to_linear;
use crate::math;
use crate::memory::Room;
use crate::scene::{Environment, Texels};

/// Bytes that a texel takes while the words are made: its words, its light and its weight.
const BYTES_PER_TEXEL: u64 = 16 + 12 + 8;

/// Its words, and its light over all directions: the mean of the channels.
///
/// # Errors
/// There is no memory for them.
pub(super) fn words(environment: &Environment, room: Room) -> Result<(Vec<u32>, f64)> {
    let (width, height) = (environment.texture.width, environment.texture.height);
    let count = width as usize * height as usize;
    let fits = room.check(count as u64 * BYTES_PER_TEXEL);
    fits.map_err(|why| Error::new(format!("the environment's {width}x{height} texels {why}; use a smaller picture")))?;
    let light = light(environment);
    let weights = weights(&light, width as usize, height as usize);
    let turned = f64::from(environment.rotation).to_radians();
    let edges = 0..=height.div_ceil(2) + 1;
    let mut words = Vec::with_capacity(HEADER as usize + 4 * count + height as usize + edges.clone().count());
    words.resize(HEADER as usize, 0);
    let bits = |x: f64| flushed_number(x as f32).to_bits();
    words[..5].copy_from_slice(&[
        width,
        height,
        bits(math::cos(turned)),
        bits(math::sin(turned)),
        u32::from(environment.visible),
    ]);
    words.extend(light.iter().flat_map(|texel| texel.to_array().map(f32::to_bits)));
    let rows: Vec<f64> = weights.par_chunks(width as usize).map(|row| row.iter().sum()).collect();
    words.extend(draws(&rows));
    words.extend(weights.chunks(width as usize).flat_map(draws));
    words.extend(edges.map(|edge| bits(below_pole(f64::from(edge.min(height)) / f64::from(height)))));
    Ok((words, rows.iter().sum()))
}

/// One less the cosine of a share of half a turn.
fn below_pole(share: f64) -> f64 {
    let sine = math::sin(share * PI / 2.0);
    2.0 * sine * sine
}

/// Light of every texel, linear RGB.
fn light(environment: &Environment) -> Vec<Vec3> {
    // Whatever is brighter than this is no picture of light, and its square would be infinite.
    let scaled = |v: [f32; 3]| {
        Vec3::from_array(v.map(|x| flushed_number((f64::from(x) * f64::from(environment.scale)).min(1e18) as f32)))
    };
    match &environment.texture.texels {
        Texels::Floats(floats) => floats.par_iter().map(|&[r, g, b, _]| scaled([r, g, b])).collect(),
        Texels::Bytes(bytes) => bytes.par_iter().map(|&[r, g, b, _]| scaled([r, g, b].map(byte_to_linear))).collect(),
    }
}

/// What each texel is chosen by: its light and that of its neighbours, as directions within it see them, times its solid angle.
fn weights(light: &[Vec3], width: usize, height: usize) -> Vec<f64> {
    let mean = |v: &Vec3| v.as_dvec3().dot(DVec3::ONE) / 3.0;
    // Of the four texels around, averaged over a texel, each neighbour along an axis has an eighth.
    let spread = |before: f64, own: f64, after: f64| (before + 6.0 * own + after) / 8.0;
    let across: Vec<f64> = (0..width * height)
        .into_par_iter()
        .map(|i| {
            let (x, row) = (i % width, i - i % width);
            let at = |x: usize| mean(&light[row + x % width]);
            spread(at(x + width - 1), at(x), at(x + 1))
        })
        .collect();
    (0..width * height)
        .into_par_iter()
        .map(|i| {
            let (x, y) = (i % width, i / width);
            let at = |y: usize| across[y.min(height - 1) * width + x];
            let solid_angle = (below_pole((y + 1) as f64 / height as f64) - below_pole(y as f64 / height as f64)) * TAU
                / width as f64;
            spread(at(y.saturating_sub(1)), at(y), at(y + 1)) * solid_angle
        })
        .collect()
}

/// The last draw of 2^32 that means each of some entries, as many as its weight says, at least one.
fn draws(weights: &[f64]) -> Vec<u32> {
    let total: f64 = weights.iter().sum();
    let count = weights.len() as u64;
    let (mut sum, mut last) = (0.0, None::<u64>);
    let entry = |(i, weight): (usize, &f64)| {
        sum += weight;
        let share = if total > 0.0 { sum / total } else { (i + 1) as f64 / count as f64 };
        let least = last.map_or(0, |last| last + 1);
        // Every entry after it has a draw, too.
        let most = u64::from(u32::MAX) - (count - 1 - i as u64);
        let draw = ((share * 4_294_967_296.0) as u64).saturating_sub(1).clamp(least, most);
        let draw = if i as u64 + 1 == count { u64::from(u32::MAX) } else { draw };
        last = Some(draw);
        draw as u32
    };
    weights.iter().enumerate().map(entry).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::scene::Texture;

    #[test]
    fn an_environment_that_there_is_no_memory_for_is_refused_before_its_words_are_made() {
        let texels = Texels::Floats(vec![[1.0; 4]; 64 * 32]);
        let texture = Arc::new(Texture { name: "grey".into(), width: 64, height: 32, texels });
        let environment = Environment { texture, rotation: 0.0, scale: 1.0, visible: true };
        let words = |bytes| words(&environment, Room { bytes, limit: "this test" });
        let all = words(1 << 20).unwrap().0;
        assert_eq!(all.len(), all.capacity());
        assert!(words(1 << 10).unwrap_err().message().starts_with("the environment's 64x32 texels take about"));
    }

    #[test]
    fn draws_are_as_many_as_weights_say_and_none_is_without() {
        for weights in [vec![1.0, 3.0], vec![0.0, 0.0, 1.0], vec![0.0; 5], vec![1.0], vec![1e-30, 1.0, 1e-30]] {
            let draws = draws(&weights);
            assert_eq!(draws.last(), Some(&u32::MAX));
            let total: f64 = weights.iter().sum();
            let mut before = -1i64;
            for (draw, weight) in draws.iter().zip(&weights) {
                let own = i64::from(*draw) - before;
                assert!(own >= 1, "{weights:?}: {draws:?}");
                let share = if total > 0.0 { weight / total } else { 1.0 / weights.len() as f64 };
                assert!((own as f64 / 4_294_967_296.0 - share).abs() < 1e-8, "{weights:?}: {draws:?}");
                before = i64::from(*draw);
            }
        }
    }
}
