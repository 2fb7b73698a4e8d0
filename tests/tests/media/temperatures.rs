//! Media that glow by temperature, beside colours of black bodies that others computed.

use eyerays::scene::Temperature;

use super::*;

/// Linear RGB of black bodies of 2000 and of 3000 kelvins, of the luminance 1, and the luminance of the former over that of the latter: by
/// CIE's observer of 1931 and Planck's formula (colour-science 0.4.7).
const EMBER: [f64; 3] = [2.520_021, 0.647_117, 0.020_488];
const FLAME: [f64; 3] = [1.770_742, 0.844_438, 0.272_125];
const EMBER_OVER_FLAME: f64 = 1.534_620e-2;

/// The radiance of what is hottest.
const EMISSION: f32 = 0.5;

/// The corners of the grids, a unit inside of those of the box around them.
const CORNERS: [DVec3; 2] = [DVec3::new(-1.0, -1.0, -2.0), DVec3::new(1.0, 1.0, 0.0)];

/// A grid of 20 cells along each axis, whose numbers hang on where they are, from 0 to 1.
fn grid(number: fn(f32, f32) -> f32) -> Arc<Grid> {
    let at = |cell: usize| (cell as f32 + 0.5) / 20.0;
    let numbers: Vec<f32> = (0..20 * 20 * 20).map(|i| number(at(i % 20), at(i / 400))).collect();
    Arc::new(Grid::dense("fire", [20; 3], &numbers, CORNERS))
}

/// In thousands of kelvins.
fn hot(number: fn(f32, f32) -> f32) -> Option<Temperature> {
    Some(Temperature { grid: grid(number), kelvins: 1000.0 })
}

/// A box of what absorbs so much on a unit of its way, around grids.
fn fire(absorption: f32, density: Option<Arc<Grid>>, temperature: Option<Temperature>) -> Scene {
    let mut scene = empty();
    let medium = Medium { emission: Vec3::splat(EMISSION), ..medium(0.0, absorption, 0.0) };
    let volume = Volume { density, temperature, ..Volume::open(medium) };
    add_box(
        &mut scene,
        Material { volume: Some(volume), ..black() },
        Vec3::new(-2.0, -2.0, -3.0),
        Vec3::new(2.0, 2.0, 1.0),
    );
    scene
}

/// What is seen of it along -z, there.
fn seen(scene: &Scene, x: f32, spectral: bool) -> [f64; 3] {
    let settings = Settings { spectral, ..paths(100, 3) };
    let picture = render(scene, &at(Vec3::new(x, 0.1, 4.0), Vec3::new(x, 0.1, 0.0)), settings);
    let sum = |channel: usize| picture.pixels.iter().map(|pixel| f64::from(pixel[channel])).sum::<f64>();
    [0, 1, 2].map(|channel| sum(channel) / picture.pixels.len() as f64)
}

/// Asserts that it is so much of this light.
fn assert_glows(what: &str, got: [f64; 3], light: [f64; 3], share: f64) {
    let factor = f64::from(EMISSION) * share;
    println!("{what}: {:?} of {light:?}", got.map(|channel| channel / factor));
    for (got, want) in got.into_iter().zip(light.map(|channel| channel * factor)) {
        // Blue of embers is a small difference of large numbers.
        let near = 0.01 * want + 0.005 * factor;
        assert!((got - want).abs() < near, "{what}: {got} is not {want}");
    }
}

/// So much of a fire that nothing is seen through it is as bright as its emission, and has the colour of its temperature.
#[test]
fn a_thick_fire_of_one_temperature_is_a_black_body() {
    for spectral in [false, true] {
        for (number, light) in [((|_, _| 2.0) as fn(f32, f32) -> f32, EMBER), (|_, _| 3.0, FLAME)] {
            // As dense as its grid is small: nothing absorbs around it.
            let scene = fire(40.0, Some(grid(|_, _| 1.0)), hot(number));
            assert_glows(&format!("spectral: {spectral}"), seen(&scene, 0.0, spectral), light, 1.0);
        }
    }
}

#[test]
fn what_is_colder_is_darker_and_redder_and_nothing_glows_outside_of_the_grid() {
    let scene = fire(40.0, Some(grid(|_, _| 1.0)), hot(|x, _| if x < 0.5 { 3.0 } else { 2.0 }));
    assert_glows("hot", seen(&scene, -0.5, false), FLAME, 1.0);
    assert_glows("cold", seen(&scene, 0.5, false), EMBER, EMBER_OVER_FLAME);
    let one_half = fire(40.0, Some(grid(|_, _| 1.0)), hot(|x, _| if x < 0.5 { 3.0 } else { 0.0 }));
    assert_glows("hot", seen(&one_half, -0.5, false), FLAME, 1.0);
    assert_eq!(seen(&one_half, 0.5, false), [0.0; 3]);
    // Without densities the box absorbs before the grid, too, and glows only in it.
    let dark = fire(0.5, None, hot(|_, _| 3.0));
    assert_glows("in it", seen(&dark, 0.0, false), FLAME, (-0.5f64).exp() * (1.0 - (-1.0f64).exp()));
    assert_eq!(seen(&dark, 1.5, false), [0.0; 3]);
}

/// How much is seen is what densities say, and its colour what temperatures say.
#[test]
fn densities_and_temperatures_go_together() {
    let density = grid(|_, z| if z < 0.5 { 1.0 } else { 3.0 });
    let scene = fire(0.5, Some(density), hot(|x, _| if x < 0.5 { 3.0 } else { 2.0 }));
    let depth = 0.5 * (1.0 + 3.0);
    assert_glows("hot", seen(&scene, -0.5, false), FLAME, 1.0 - f64::exp(-depth));
    assert_glows("cold", seen(&scene, 0.5, false), EMBER, EMBER_OVER_FLAME * (1.0 - f64::exp(-depth)));
}
