//! Surfaces in light that comes from everywhere alike: what is lost between facets is given back, and no more.

use eyerays_shader::material::Layers;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::integral::Rectangle;
use super::surface::{Seen, V, direction, facets, glass, plastic};

/// Facets' roughness by the perceived one, from a twentieth to 1.
pub const ROUGHNESSES: [f64; 8] = [0.05, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 1.0];
/// Angles from the normal, up to 3 degrees above the plane.
pub const ANGLES: [f64; 6] = [0.0, 0.4, 0.8, 1.2, 1.4, 1.518];

/// The index of what lets nothing pass.
pub const OPAQUE: f64 = 0.0;

/// What a surface sends to a viewer of white light from everywhere, of the second channel and as energy: radiance on the far side of glass is as much more as
/// the square of its index is.
fn sent(layers: Layers<f64>, angle: f64, azimuth: f64, eta: f64) -> f64 {
    sent_by(&Seen::from(layers, direction(angle, azimuth)), angle, azimuth, eta)
}

/// The same of a surface that is seen from there.
pub fn sent_by(seen: &Seen, angle: f64, azimuth: f64, eta: f64) -> f64 {
    let value = |polar: f64, azimuth: f64| seen.scattering(direction(polar, azimuth)).value.y * polar.sin();
    // Around the mirrored direction facets' highlights are narrow.
    let mirrored = azimuth + PI;
    let parts = [mirrored - 0.02, mirrored + 0.02, mirrored + TAU - 0.02];
    let polar = [0.0, (angle - 0.02).max(0.0), (angle + 0.02).min(FRAC_PI_2), FRAC_PI_2];
    let near: f64 = polar
        .windows(2)
        .flat_map(|p| parts.windows(2).map(move |a| Rectangle([p[0], p[1]], [a[0], a[1]])))
        .map(|part| part.integral(&value, 2e-5))
        .sum();
    if eta == OPAQUE {
        near
    } else {
        near + Rectangle([FRAC_PI_2, PI], [0.0, TAU]).integral(&value, 1e-4) / (eta * eta)
    }
}

#[test]
fn white_metal_sends_back_all_light() {
    for roughness in ROUGHNESSES {
        for angle in ANGLES {
            let alpha = roughness * roughness;
            let got = sent(facets(alpha, alpha), angle, 0.3, OPAQUE);
            assert!((got - 1.0).abs() < 2e-3, "roughness {roughness} at {angle}: {got}");
        }
    }
}

#[test]
fn brushed_white_metal_sends_back_all_light() {
    for (x, y) in [(0.5, 0.2), (0.2, 0.5), (1.0, 0.2), (0.4, 0.1), (0.8, 0.7)] {
        for angle in ANGLES {
            for azimuth in [0.0, 0.5, 1.2, FRAC_PI_2] {
                let got = sent(facets(x, y), angle, azimuth, OPAQUE);
                assert!((got - 1.0).abs() < 2e-2, "roughness {x} and {y} at {angle}, {azimuth}: {got}");
            }
        }
    }
}

/// Rough gold is deeper in colour than its facets, since light that bounces between them is reflected by gold more than once.
#[test]
fn coloured_metal_gets_deeper_where_light_bounces_between_facets() {
    for (colour, want) in [(1.0, 1.0), (0.766, 0.733), (0.336, 0.301)] {
        let mut gold = facets(0.36, 0.36);
        gold.reflectance.normal = V { x: colour, y: colour, z: colour };
        let got = sent(gold, 0.0, 0.0, OPAQUE);
        assert!((got - want).abs() < 1e-2, "{colour}: {got}, not {want}");
    }
}

#[test]
fn rough_glass_passes_or_sends_back_all_light() {
    for ior in [1.1, 1.5, 2.4] {
        for eta in [1.0 / ior, ior] {
            for roughness in [0.3, 0.6, 1.0] {
                for angle in [0.0, 0.8, 1.3, 1.518] {
                    let alpha = roughness * roughness;
                    let got = sent(glass(alpha, alpha, eta), angle, 0.3, eta);
                    assert!((0.98..1.02).contains(&got), "index {eta}, roughness {roughness} at {angle}: {got}");
                }
            }
        }
    }
}

#[test]
fn a_white_base_below_facets_sends_back_no_more_than_it_gets() {
    for normal in [0.002_27, 0.17] {
        for roughness in ROUGHNESSES {
            for angle in ANGLES {
                let alpha = roughness * roughness;
                let mut layers = plastic(alpha, alpha);
                layers.reflectance.normal = V { x: normal, y: normal, z: normal };
                let got = sent(layers, angle, 0.3, OPAQUE);
                assert!(got < 1.001, "reflectance {normal}, roughness {roughness} at {angle}: {got}");
                assert!(got > 0.99, "reflectance {normal}, roughness {roughness} at {angle}: {got}");
            }
        }
    }
}

/// As Cycles 5.0 shows a rough plane of base 0.8 in a white sky.
#[test]
fn a_rough_floor_stays_bright_where_it_is_grazed() {
    for (degrees, want) in [(8.0f64, 0.810), (20.0, 0.807), (45.0, 0.804)] {
        let mut layers = plastic(1.0, 1.0);
        layers.diffuse = V { x: 0.8, y: 0.8, z: 0.8 };
        let got = sent(layers, FRAC_PI_2 - degrees.to_radians(), 0.0, OPAQUE);
        assert!((got / want - 1.0).abs() < 0.02, "{degrees} degrees above it: {got}, not {want}");
    }
}
