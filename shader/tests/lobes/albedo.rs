//! How much of the light leaves a surface.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::integral::Rectangle;
use super::surface::{Seen, direction, facets, glass, gold, pane, plastic};

/// What a surface sends to a viewer under light from everywhere, of the second channel.
pub fn albedo(seen: &Seen) -> f64 {
    let value = |polar: f64, azimuth: f64| seen.scattering(direction(polar, azimuth)).value.y * polar.sin();
    // Facets let light pass between zenith and horizon, each an edge of what they scatter.
    let halves = [[0.0, FRAC_PI_2], [FRAC_PI_2, PI]];
    halves.into_iter().map(|polar| Rectangle(polar, [0.0, TAU]).integral(&value, 1e-6)).sum()
}

/// Of facets that reflect everything, once: known numbers (1 - ln 2 where they are as rough as a sphere).
#[test]
fn single_scattering_loses_what_is_known() {
    for (alpha, want) in [(1.0, 0.30685), (0.5, 0.68785), (0.25, 0.91581)] {
        let got = albedo(&Seen::once(facets(alpha, alpha), direction(0.0, 0.0)));
        assert!((got - want).abs() < 1e-4, "{alpha}: {got}");
    }
}

#[test]
fn samples_scatter_as_much_as_the_integral_says() {
    let count = 1 << 21;
    let surfaces = [
        ("facets", facets(0.4, 0.1)),
        ("gold", gold(0.3, 0.3)),
        ("plastic", plastic(0.2, 0.2)),
        ("pane", pane(0.3, 0.3)),
        ("glass", glass(0.3, 0.3, 1.0 / 1.5)),
        ("glass from inside", glass(0.3, 0.3, 1.5)),
    ];
    for (name, layers) in surfaces {
        for angle in [0.1, 1.0, 1.4] {
            let seen = Seen::from(layers, direction(angle, 0.3));
            let sum: f64 = (0..count).map(|number| seen.sample(0, number).factor.y).sum();
            let (got, want) = (sum / f64::from(count), albedo(&seen));
            assert!((got - want).abs() < 1e-3, "{name} at {angle}: {got}, not {want}");
        }
    }
}

/// White parts send back no more light than they get; a lens compresses it by the square of the index.
#[test]
fn no_surface_makes_light() {
    for angle in [0.0, 0.5, 1.0, 1.3, 1.5] {
        for (x, y) in [(0.1, 0.1), (0.5, 0.2), (1.0, 1.0)] {
            let of = |layers| albedo(&Seen::from(layers, direction(angle, 0.5)));
            for (name, layers) in
                [("facets", facets(x, y)), ("gold", gold(x, y)), ("plastic", plastic(x, y)), ("pane", pane(x, y))]
            {
                assert!(of(layers) < 1.0 + 2e-2, "{name} at {angle}, {x}, {y}: {}", of(layers));
            }
            assert!(of(glass(x, y, 1.0 / 1.5)) < 1.0 + 2e-2);
            assert!(of(glass(x, y, 1.5)) < 1.5 * 1.5 * (1.0 + 2e-2));
        }
    }
}
