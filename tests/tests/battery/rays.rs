//! Rays with zeros, extremes and what is no number in them, from places where boxes and triangles meet.

use eyerays::stream::{Stream, StreamRay};
use eyerays_tests::model::{add_box, empty, matt};
use eyerays_tests::pack;
use eyerays_tests::surface::Surface;
use glam::{DVec3, Vec3};

use crate::against::{assert_like_brute_force, ray};

/// Every kind of component: signs and zeros, below what counts, subnormal, and so large that a square overflows.
const COMPONENTS: [f32; 12] = [0.0, -0.0, 1.0, -1.0, 0.37, 1e-19, -1e-40, 1e-45, 1e18, -1e18, 2e-18, -1e-5];
/// In the middle, on a box's plane, on its edge, at its vertex, and where cells of the floor meet; in a normalised
/// scene.
const ORIGINS: [[f32; 3]; 9] = [
    [0.125, 0.25, -0.0625],
    [0.5, 0.25, 0.125],
    [-0.5, -0.0, 0.125],
    [0.5, 0.5, 0.125],
    [0.5, 0.5, 0.5],
    [-0.5, 0.5, -0.5],
    [0.75, -0.75, 0.125],
    [0.25, -0.75, 0.25],
    [-1.0, -0.75, -1.0],
];

/// A box over a floor of cells, all of it in exact coordinates.
fn assert_rays(what: &str, rays: Vec<StreamRay>) {
    let floor = Surface::plane(DVec3::new(0.0, -0.75, 0.0), 2.0, 8);
    let mut scene = floor.scene();
    add_box(&mut scene, matt(Vec3::ONE), Vec3::splat(-0.5), Vec3::splat(0.5));
    let packed = pack(&scene, &empty().cameras[0], scene.settings);
    assert_eq!(packed.normalisation().scale, 1.0);
    assert_like_brute_force(&format!("rays, {what}"), &packed, &Stream::new(rays.into_iter()), 0);
}

fn directions(components: &[f32]) -> Vec<Vec3> {
    let count = components.len();
    let part = |i: usize| components[i % count];
    (0..count.pow(3)).map(|i| Vec3::new(part(i), part(i / count), part(i / count / count))).collect()
}

fn from_everywhere(directions: &[Vec3]) -> Vec<StreamRay> {
    ORIGINS.iter().flat_map(|&origin| directions.iter().map(move |&d| ray(Vec3::from(origin), d))).collect()
}

#[test]
fn every_pattern_of_direction() {
    assert_rays("every pattern of direction", from_everywhere(&directions(&COMPONENTS)));
}

#[test]
fn nan_directions_and_origins() {
    let with_nan = directions(&[f32::NAN, 1.0, -0.25, 0.0]).into_iter().filter(|d| d.is_nan());
    assert_rays("NaN directions", from_everywhere(&with_nan.collect::<Vec<_>>()));
    let origins = directions(&[f32::NAN, 0.125, -0.25]).into_iter().filter(|o| o.is_nan());
    let rays = origins.flat_map(|o| directions(&[1.0, -0.5]).into_iter().map(move |d| ray(o, d)));
    assert_rays("NaN origins", rays.collect());
}

/// Along the floor at an angle to its normal of 90 degrees less 1e-7 (and less), so that it is met far away or not
/// at all; and exactly in its plane.
#[test]
fn grazing() {
    let height = |lift: f32| f32::from_bits((-0.75f32).to_bits() - lift as u32);
    let (mut rays, tilts) = (Vec::new(), [1e-7f64, 1e-7f64.to_radians(), 1e-6, 6e-8, 0.0]);
    for (turn, tilt) in (0..64).flat_map(|turn| tilts.map(|tilt| (turn, tilt))) {
        let (sine, cosine) = (f64::from(turn) * 0.1).sin_cos();
        let direction = DVec3::new(cosine, -tilt.sin(), sine).as_vec3();
        for lift in [0.0, 1.0, 2.0, 5.0] {
            rays.push(ray(Vec3::new(-0.9 * direction.x, height(lift), -0.9 * direction.z), direction));
            rays.push(ray(Vec3::new(0.25, height(lift), -0.5), direction));
        }
    }
    assert_rays("grazing at 90 degrees - 1e-7", rays);
}
