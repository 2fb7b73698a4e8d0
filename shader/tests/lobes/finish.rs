//! What lies on surfaces, in light from everywhere and beside other ways to compute it.

use eyerays_shader::data::Waves;
use eyerays_shader::material::{Sheen, film};
use std::f64::consts::{FRAC_PI_2, TAU};

use super::furnace::{ANGLES, OPAQUE, ROUGHNESSES, sent_by};
use super::integral::Rectangle;
use super::surface::{Over, Seen, V, WHITE, direction, facets, leaf, plastic};

#[test]
fn a_coat_takes_from_white_metal_what_it_reflects() {
    for roughness in ROUGHNESSES {
        for angle in ANGLES {
            let over = Over { coat: Some((1.0, roughness * roughness)), sheen: None };
            let got = sent_by(&Seen::below(over, facets(0.2, 0.2), direction(angle, 0.3)), angle, 0.3, OPAQUE);
            assert!((got - 1.0).abs() < 2e-3, "coat of roughness {roughness} at {angle}: {got}");
        }
    }
}

#[test]
fn fibres_on_white_metal_make_and_lose_no_light_with_a_coat_and_without() {
    for coat in [None, Some((0.5, 0.04))] {
        for roughness in [0.05, 0.2, 0.4, 0.7, 1.0] {
            for angle in ANGLES {
                let over = Over { coat, sheen: Some(roughness) };
                let got = sent_by(&Seen::below(over, facets(0.2, 0.2), direction(angle, 0.3)), angle, 0.3, OPAQUE);
                assert!((got - 1.0).abs() < 2e-3, "{coat:?}, fibres of roughness {roughness} at {angle}: {got}");
            }
        }
    }
}

/// The lost share is that of plastic that sends nothing through.
#[test]
fn a_white_leaf_sends_on_all_light_to_one_side_or_the_other() {
    for roughness in ROUGHNESSES {
        for angle in ANGLES {
            let alpha = roughness * roughness;
            let own = sent_by(&Seen::from(plastic(alpha, alpha), direction(angle, 0.3)), angle, 0.3, OPAQUE);
            let got = sent_by(&Seen::from(leaf(alpha, alpha), direction(angle, 0.3)), angle, 0.3, 1.0);
            assert!((got - own).abs() < 2e-3, "roughness {roughness} at {angle}: {got}, not {own}");
        }
    }
}

/// A mirror for a coat has no density: samples tell.
#[test]
fn samples_of_a_smooth_coat_are_worth_what_it_reflects() {
    let count = 1 << 18;
    for (weight, angle) in [(1.0, 0.2), (0.6, 1.2), (1.0, 1.5)] {
        let over = Over { coat: Some((weight, 0.0)), sheen: None };
        let seen = Seen::below(over, facets(0.3, 0.3), direction(angle, 0.3));
        let sum: f64 = (0..count).map(|number| seen.sample(0, number).factor.y).sum();
        let got = sum / f64::from(count);
        assert!((got - 1.0).abs() < 6e-3, "{weight} at {angle}: {got}");
    }
}

#[test]
fn fibres_have_a_density_whose_integral_is_one() {
    for roughness in [0.05, 0.3, 1.0] {
        for angle in [0.0, 0.8, 1.4] {
            let d = direction(angle, 0.3);
            let sheen = Sheen::new(V::new(d.x, d.y, d.z), WHITE, roughness);
            let density = |polar: f64, azimuth: f64| {
                let to = direction(polar, azimuth);
                sheen.density(V::new(to.x, to.y, to.z)) * polar.sin()
            };
            let got = Rectangle([0.0, FRAC_PI_2], [0.0, TAU]).integral(&density, 1e-6);
            assert!((got - 1.0).abs() < 1e-3, "roughness {roughness} at {angle}: {got}");
        }
    }
}

/// As the paper's figures show: hardly any light from above, much where the surface is grazed, more the rougher they are.
#[test]
fn fibres_shine_where_they_are_grazed() {
    let albedo = |angle: f64, roughness: f64| {
        let d = direction(angle, 0.0);
        Sheen::new(V::new(d.x, d.y, d.z), WHITE, roughness).albedo.y
    };
    assert!(albedo(0.0, 0.3) < 0.02 && albedo(1.5, 0.3) > 0.4, "{} {}", albedo(0.0, 0.3), albedo(1.5, 0.3));
    assert!(albedo(0.0, 1.0) > 0.1 && albedo(0.0, 1.0) < 0.5, "{}", albedo(0.0, 1.0));
}

/// Complex numbers enough for Airy's sum.
fn airy(upper: f64, lower: f64, phase: f64) -> f64 {
    let (re, im) = (lower * phase.cos(), lower * phase.sin());
    ((upper + re).powi(2) + im * im) / ((1.0 + upper * re).powi(2) + (upper * im).powi(2))
}

/// What a film reflects at a wavelength in nanometres.
fn reflected(cosine: f64, (ior, thickness): (f64, f64), base: f64, wavelength: f64) -> f64 {
    let sine = 1.0 - cosine * cosine;
    let bent = |n: f64| (1.0 - sine / (n * n)).sqrt();
    let (inside, below) = (bent(ior), bent(base));
    let phase = TAU * 2.0 * ior * thickness * inside / wavelength;
    let ratio = |a: f64, b: f64| (a - b) / (a + b);
    let across = airy(ratio(cosine, ior * inside), ratio(ior * inside, base * below), phase);
    let along = airy(ratio(ior * cosine, inside), ratio(base * inside, ior * below), phase);
    (across + along) / 2.0
}

/// CIE 1931 by Wyman, Sloan and Shirley (Simple Analytic Approximations to the CIE XYZ Color Matching Functions, 2013).
fn matching(wavelength: f64) -> [f64; 3] {
    let lobe = |height: f64, middle: f64, below: f64, above: f64| {
        let t = (wavelength - middle) * if wavelength < middle { below } else { above };
        height * (-0.5 * t * t).exp()
    };
    [
        lobe(0.362, 442.0, 0.0624, 0.0374) + lobe(1.056, 599.8, 0.0264, 0.0323) + lobe(-0.065, 501.1, 0.0490, 0.0382),
        lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322),
        lobe(1.217, 437.0, 0.0845, 0.0278) + lobe(0.681, 459.0, 0.0385, 0.0725),
    ]
}

/// The same of white light, linear RGB: by a sum over wavelengths, each of XYZ relative to what white reflects.
fn summed(cosine: f64, of: (f64, f64), base: f64) -> [f64; 3] {
    let (mut seen, mut white) = ([0.0; 3], [0.0; 3]);
    for step in 0..4000 {
        let wavelength = 360.0 + 0.12 * f64::from(step);
        let light = reflected(cosine, of, base, wavelength);
        for (channel, matching) in matching(wavelength).into_iter().enumerate() {
            seen[channel] += light * matching;
            white[channel] += matching;
        }
    }
    let [x, y, z] = [0.950_47 * seen[0] / white[0], seen[1] / white[1], 1.088_83 * seen[2] / white[2]];
    [
        3.240_454_2 * x - 1.537_138_5 * y - 0.498_531_4 * z,
        -0.969_266 * x + 1.876_010_8 * y + 0.041_556 * z,
        0.055_643_4 * x - 0.204_025_9 * y + 1.057_225_2 * z,
    ]
}

/// Within what the eye's matching functions, as Gaussians, and the series' first terms leave.
#[test]
fn a_thin_film_has_the_colours_of_airys_sum() {
    let mut worst = 0f64;
    for base in [1.5, 2.5, 4.0f64] {
        let normal = ((base - 1.0) / (base + 1.0)).powi(2);
        for ior in [1.2, 1.33, 1.8] {
            for thickness in [0.0, 100.0, 200.0, 300.0, 400.0, 550.0, 800.0, 1200.0] {
                for angle in [0.0, 0.5, 1.0, 1.3f64] {
                    let got = film((Waves(0), V::zero()), angle.cos(), (ior, thickness), WHITE * normal);
                    let want = summed(angle.cos(), (ior, thickness), base);
                    for (got, want) in [got.x, got.y, got.z].into_iter().zip(want) {
                        worst = worst.max((got - want.clamp(0.0, 1.0)).abs());
                    }
                }
            }
        }
    }
    assert!(worst < 0.03, "{worst}");
}

#[test]
fn a_film_without_thickness_leaves_what_is_below_it() {
    for base in [0.0, 0.04, 0.3, 0.9] {
        for (ior, angle) in [(1.3, 0.0), (1.3, 1.2), (2.0, 0.7)] {
            let got = film((Waves(0), V::zero()), f64::cos(angle), (ior, 0.0), WHITE * base).y;
            let index = (1.0 + base.sqrt()) / (1.0 - base.sqrt());
            let want = reflected(f64::cos(angle), (1.0, 0.0), index, 550.0);
            assert!((got - want).abs() < 2e-2, "{base} below {ior} at {angle}: {got}, not {want}");
        }
    }
}
