//! Samples fall where their density says (Pearson's test, as Mitsuba and pbrt have it).

use eyerays_shader::material::Layers;
use glam::DVec3;
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::f64::consts::{PI, TAU};

use super::hair::hair;
use super::integral::Rectangle;
use super::surface::{BLACK, Over, Seen, V, direction, facets, glass, gold, leaf, pane, plastic};

/// Bins over the polar angle and the azimuth.
const BINS: (usize, usize) = (80, 160);
/// Bins that expect fewer are put together.
const LEAST: f64 = 5.0;
/// How likely any of all tests fails by chance.
const SIGNIFICANCE: f64 = 0.01;
/// Polar angles from which surfaces are seen.
const ANGLES: [f64; 3] = [0.0, 0.8, 1.5];

/// A million samples and five runs by `EYERAYS_CHI_SQUARE=full`.
fn effort() -> (u32, u32) {
    if std::env::var("EYERAYS_CHI_SQUARE").is_ok_and(|v| v == "full") { (1_000_000, 5) } else { (100_000, 1) }
}

/// How many of `count` samples each bin expects, and at last how many scatter nowhere.
fn expected(seen: &Seen, count: u32) -> Vec<f64> {
    let (rows, columns) = BINS;
    let density = |polar: f64, azimuth: f64| seen.scattering(direction(polar, azimuth)).density * polar.sin();
    let edge = |i: usize, bins: usize, whole: f64| i as f64 / bins as f64 * whole;
    let mut bins = Vec::with_capacity(rows * columns + 1);
    for row in 0..rows {
        for column in 0..columns {
            let polar = [edge(row, rows, PI), edge(row + 1, rows, PI)];
            let azimuth = [edge(column, columns, TAU), edge(column + 1, columns, TAU)];
            bins.push(f64::from(count) * Rectangle(polar, azimuth).integral(&density, 1e-8));
        }
    }
    let rest = f64::from(count) - bins.iter().sum::<f64>();
    assert!(rest > -0.001 * f64::from(count), "the density's integral is over 1: {rest}");
    bins.push(rest.max(0.0));
    bins
}

fn counted(seen: &Seen, run: u32, count: u32) -> Vec<f64> {
    let (rows, columns) = BINS;
    let mut bins = vec![0.0; rows * columns + 1];
    for number in 0..count {
        let sample = seen.sample(run, number);
        if sample.factor == BLACK {
            bins[rows * columns] += 1.0;
            continue;
        }
        let d = sample.direction;
        let (polar, azimuth) = (d.z.clamp(-1.0, 1.0).acos(), d.y.atan2(d.x).rem_euclid(TAU));
        let bin = |angle: f64, whole: f64, bins: usize| ((angle / whole * bins as f64) as usize).min(bins - 1);
        bins[bin(polar, PI, rows) * columns + bin(azimuth, TAU, columns)] += 1.0;
    }
    bins
}

/// How likely chance alone gives counts as far from what is expected.
fn likelihood(expected: &[f64], counted: &[f64]) -> f64 {
    let mut bins: Vec<(f64, f64)> = expected.iter().copied().zip(counted.iter().copied()).collect();
    bins.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut sum, mut degrees, mut pooled) = (0.0, 0, (0.0, 0.0));
    for (want, got) in bins {
        pooled = (pooled.0 + want, pooled.1 + got);
        if pooled.0 >= LEAST {
            sum += (pooled.1 - pooled.0).powi(2) / pooled.0;
            degrees += 1;
            pooled = (0.0, 0.0);
        }
    }
    assert!(pooled.1 <= pooled.0 + 30.0, "{} samples where {} are expected", pooled.1, pooled.0);
    if degrees < 2 { 1.0 } else { ChiSquared::new(f64::from(degrees - 1)).unwrap().sf(sum) }
}

/// Tests surfaces by their roughness along both axes, from every angle.
fn test(name: &str, of: impl Fn(f64, f64) -> Layers<f64>) {
    test_below(name, Over::default(), of);
}

/// The same below what lies on them.
fn test_below(name: &str, over: Over, of: impl Fn(f64, f64) -> Layers<f64>) {
    let roughnesses = [(0.1, 0.1), (0.4, 0.4), (1.0, 1.0), (0.4, 0.1), (0.1, 0.4), (1.0, 0.2)];
    test_seen(name, &roughnesses, |(x, y), viewer| Seen::below(over, of(x, y), viewer));
}

/// Tests what is seen of some roughness, from every angle.
fn test_seen(name: &str, roughnesses: &[(f64, f64)], of: impl Fn((f64, f64), DVec3) -> Seen) {
    let (count, runs) = effort();
    // Sidak: of so many tests one fails by chance no more often than of one.
    let tests = f64::from(runs) * (roughnesses.len() * ANGLES.len()) as f64;
    let least = 1.0 - (1.0 - SIGNIFICANCE).powf(1.0 / tests);
    for &(x, y) in roughnesses {
        for angle in ANGLES {
            let seen = of((x, y), direction(angle, 0.7));
            let expected = expected(&seen, count);
            for run in 0..runs {
                let likely = likelihood(&expected, &counted(&seen, run, count));
                assert!(likely >= least, "{name}, roughness {x} and {y}, at {angle}, run {run}: {likely:e}");
            }
        }
    }
}

#[test]
fn facets_that_reflect_are_sampled_by_their_density() {
    test("facets", facets);
}

#[test]
fn conductors_are_sampled_by_their_density() {
    test("gold", gold);
}

#[test]
fn a_base_below_facets_is_sampled_by_its_density() {
    test("plastic", plastic);
}

#[test]
fn panes_are_sampled_by_their_density() {
    test("pane", pane);
}

#[test]
fn glass_is_sampled_by_its_density_from_outside() {
    test("glass", |x, y| glass(x, y, 1.0 / 1.5));
}

#[test]
fn glass_is_sampled_by_its_density_from_inside() {
    test("glass from inside", |x, y| glass(x, y, 1.5));
}

#[test]
fn coats_are_sampled_by_their_density() {
    test_below("coat", Over { coat: Some((0.7, 0.09)), sheen: None }, gold);
}

#[test]
fn fibres_below_a_coat_are_sampled_by_their_density() {
    test_below("fibres", Over { coat: Some((1.0, 0.25)), sheen: Some(0.3) }, plastic);
    test_below("long fibres", Over { coat: None, sheen: Some(1.0) }, pane);
}

#[test]
fn leaves_are_sampled_by_their_density() {
    test("leaf", leaf);
}

#[test]
fn hair_is_sampled_by_its_density() {
    let of = |(x, y), viewer| Seen::hair(&hair(x, y, 2.0), viewer, V::new(0.2, 0.5, 0.9), 1.55);
    test_seen("hair", &[(0.2, 0.3), (0.5, 0.2), (1.0, 1.0)], of);
}

/// The test notices a density that is off by a fifth at half of the azimuths.
#[test]
fn a_wrong_density_is_noticed() {
    let seen = Seen::from(plastic(0.4, 0.4), direction(0.8, 0.7));
    let (count, _) = effort();
    let mut expected = expected(&seen, count);
    let factor = |bin: usize| if bin % BINS.1 < BINS.1 / 2 { 1.2 } else { 0.8 };
    expected.iter_mut().enumerate().for_each(|(bin, of)| *of *= factor(bin));
    assert!(likelihood(&expected, &counted(&seen, 0, count)) < 1e-6);
}
