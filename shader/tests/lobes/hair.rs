//! Hair: its lobes are densities, and send what a cylinder of glass does.

use eyerays_shader::data::{Finish, pack};
use eyerays_shader::real::V3;
use glam::{DVec3, Vec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::integral::Rectangle;
use super::surface::{Seen, V, WHITE, direction};

/// The index of refraction of keratin.
const IOR: f64 = 1.55;

/// Hair of a roughness along itself and around, whose scales lean by some degrees (Chiang and others 2016, equations 7 to 9).
pub fn hair(along: f64, around: f64, tilt: f64) -> Finish {
    let root = 0.726 * along + 0.812 * along * along + 3.7 * along.powi(20);
    let scale = (PI / 8.0).sqrt() * (0.265 * around + 1.194 * around * around + 5.372 * around.powi(22)) / TAU;
    let over = std::f64::consts::LN_2 / fit(around);
    let lean = (tilt.to_radians().sin() as f32).to_bits();
    Finish { hair: pack(Vec3::new(over as f32, (root * root) as f32, scale as f32), lean), ..Finish::NONE }
}

fn fit(around: f64) -> f64 {
    let b = around;
    5.969 - 0.215 * b + 2.532 * b * b - 10.73 * b.powi(3) + 5.574 * b.powi(4) + 0.245 * b.powi(5)
}

/// The unit direction of so much elevation above the plane across a fibre, turned so far from the normal there.
fn above(elevation: f64, azimuth: f64) -> DVec3 {
    DVec3::new(elevation.sin(), elevation.cos() * azimuth.sin(), elevation.cos() * azimuth.cos())
}

/// From where hair is seen: elevation, and the angle from the normal.
const VIEWS: [(f64, f64); 6] = [(0.0, 0.0), (0.3, 0.9), (-0.8, -0.4), (1.2, 1.3), (-1.5, 0.2), (0.6, -1.55)];

/// An integral over all directions.
fn over_sphere(f: impl Fn(DVec3) -> f64) -> f64 {
    let of = |elevation: f64, azimuth: f64| f(above(elevation, azimuth)) * elevation.cos();
    let edges = [-FRAC_PI_2, -1.2, -0.6, 0.0, 0.6, 1.2, FRAC_PI_2];
    let turns = [-PI, -FRAC_PI_2, 0.0, FRAC_PI_2, PI];
    let parts = edges.windows(2).flat_map(|e| turns.windows(2).map(move |t| Rectangle([e[0], e[1]], [t[0], t[1]])));
    parts.map(|part| part.integral(&of, 1e-5)).sum()
}

#[test]
fn the_density_of_hair_is_one_over_all_directions() {
    for (along, around) in [(0.1, 0.1), (0.3, 0.3), (0.6, 0.2), (0.2, 0.9), (1.0, 1.0)] {
        for (elevation, azimuth) in VIEWS {
            let seen = Seen::hair(&hair(along, around, 2.0), above(elevation, azimuth), V::new(0.3, 0.6, 0.9), IOR);
            let got = over_sphere(|to| seen.scattering(to).density);
            assert!((got - 1.0).abs() < 2e-3, "roughness {along}, {around} from {elevation}, {azimuth}: {got}");
        }
    }
}

#[test]
fn white_hair_sends_on_all_light() {
    for (along, around) in [(0.1, 0.1), (0.3, 0.3), (1.0, 0.5)] {
        for (elevation, azimuth) in VIEWS {
            let seen = Seen::hair(&hair(along, around, 3.0), above(elevation, azimuth), WHITE, IOR);
            let got = over_sphere(|to| seen.scattering(to).value.y);
            assert!((got - 1.0).abs() < 2e-3, "roughness {along}, {around} from {elevation}, {azimuth}: {got}");
        }
    }
}

/// What a smooth cylinder of glass along the first axis sends of light along a ray that meets it below the third axis: by rays that are refracted
/// and reflected in space until almost nothing is left of them.
fn of_cylinder(towards: DVec3, absorbed: f64) -> f64 {
    let reflectance = |d: DVec3, n: DVec3, eta: f64| {
        let (cosine, squared) = (-d.dot(n), 1.0 - eta * eta * (1.0 - d.dot(n).powi(2)));
        if squared < 0.0 {
            return (1.0, d);
        }
        let out = squared.sqrt();
        let (s, p) = ((eta * cosine - out) / (eta * cosine + out), (cosine - eta * out) / (cosine + eta * out));
        ((s * s + p * p) / 2.0, d * eta + n * (eta * cosine - out))
    };
    let mut at = DVec3::Z;
    let (first, mut inside) = reflectance(-towards, at, 1.0 / IOR);
    let (mut sum, mut left) = (first, 1.0 - first);
    while left > 1e-12 {
        let across = DVec3::new(0.0, inside.y, inside.z);
        let way = -2.0 * at.dot(across) / across.length_squared();
        at += inside * way;
        at.x = 0.0;
        left *= (-absorbed * way).exp();
        let (share, _) = reflectance(inside, -at, IOR);
        sum += left * (1.0 - share);
        left *= share;
        inside -= at * (2.0 * inside.dot(at));
    }
    sum
}

/// The sum of the lobes is that of the cylinder whatever the roughness, since lobes are densities.
#[test]
fn hair_sends_what_a_cylinder_of_glass_does() {
    let around = 0.3;
    for (elevation, azimuth) in VIEWS {
        for absorbed in [0.0, 0.05, 0.5, 3.0] {
            let colour = (-f64::sqrt(absorbed) * fit(around)).exp();
            let viewer = above(elevation, azimuth);
            let seen = Seen::hair(&hair(0.3, around, 0.0), viewer, V3::new(colour, colour, colour), IOR);
            let (got, want) = (over_sphere(|to| seen.scattering(to).value.y), of_cylinder(viewer, absorbed));
            assert!((got - want).abs() < 3e-3, "{absorbed} from {elevation}, {azimuth}: {got}, not {want}");
        }
    }
}

/// Of hair that is hardly rough, light is where a cylinder of glass sends it: mirrored, straight on through the middle, and back from
/// the far side, each lobe leaning as scales do.
#[test]
fn lobes_lean_as_scales_do() {
    let tilt = 4f64.to_radians();
    let seen = Seen::hair(&hair(0.1, 0.2, 4.0), above(0.3, 0.0), V::new(0.8, 0.8, 0.8), IOR);
    let brightest = |azimuth: f64| {
        let at = |i: u32| f64::from(i) * 1e-3 - 1.2;
        let best = (0..2400).max_by(|&a, &b| {
            let of = |i| seen.scattering(above(at(i), azimuth)).value.y;
            of(a).total_cmp(&of(b))
        });
        at(best.unwrap())
    };
    assert!((brightest(0.0) - (-0.3 + 2.0 * tilt)).abs() < 0.02, "reflected {}", brightest(0.0));
    assert!((brightest(PI) - (-0.3 - tilt)).abs() < 0.02, "through {}", brightest(PI));
}

/// A fibre that is seen along itself has no plane across which the viewer is, and directions are numbers all the same.
#[test]
fn hair_that_is_seen_along_itself_is_finite() {
    for viewer in [DVec3::X, -DVec3::X, DVec3::new(1.0, 1e-30, 1e-30), DVec3::Y] {
        let seen = Seen::hair(&hair(0.05, 0.05, 2.0), viewer, WHITE, 1.0);
        for number in 0..200 {
            let sample = seen.sample(1, number);
            let (d, f) = (sample.direction, sample.factor);
            assert!([d.x, d.y, d.z, f.x, sample.density].iter().all(|c| c.is_finite()), "{viewer}: {d:?}");
            assert!((d.dot(d) - 1.0).abs() < 1e-6, "{viewer}: {d:?}");
        }
        for to in [direction(0.3, 0.1), direction(2.0, 4.0), DVec3::X, -DVec3::X] {
            assert!(seen.scattering(to).value.y.is_finite(), "{viewer}, {to}");
        }
    }
}
