//! No subnormal number is used in the tests of spheres and disks but where it is flushed, however small what they take.

use eyerays::stream::StreamRay;
use eyerays_shader::data::Primitive;
use eyerays_shader::geometry::SurfaceInteraction;
use eyerays_shader::ray::Hit;
use eyerays_shader::real::{Scalar, V3};
use eyerays_shader::traverse::{Closest, Occlusion, leaf};
use eyerays_tests::bare::{Bare, prepared};
use eyerays_tests::count;
use eyerays_tests::numbers::{Counting, Flushing, subnormals};
use fastrand::Rng;
use glam::Vec3;

use super::draw::{Drawn, From, cube, power, unit};

/// The bits of what a ray finds: hit, place and where it leaves from there.
type Found = [u32; 12];

fn found<R: Scalar>(bare: &Bare, ray: &StreamRay, out: Vec3) -> Found {
    let prepared = prepared::<R>(ray);
    let hit = bare.hit::<Closest, R>(&prepared, ray.limit);
    let dark = leaf::occluded(&bare.hit::<Occlusion, R>(&prepared, ray.limit));
    let bits = |x: R| x.to_f32().to_bits();
    if hit.primitive == Hit::<R>::NOTHING {
        return [u32::from(dark), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];
    }
    let (u, v) = hit.coordinates();
    let at = SurfaceInteraction::new(bare.effects, &bare.primitives[0], (u, v), prepared.direction);
    let out = V3::<R>::splat(out);
    let (start, along) = (at.offset_ray_origin(out), at.offset_ray_origin_along(out));
    let found = [hit.t, u, v, start.x, start.y, start.z, along.x, along.y, along.z, at.normal.x];
    let found = found.map(bits);
    assert!(found.iter().all(|&bits| f32::from_bits(bits).is_finite()), "{bare:?} {ray:?}");
    std::array::from_fn(|i| match i {
        0 => u32::from(dark) + 2,
        1 => at.source_primitive(out),
        i => found[i - 2],
    })
}

/// Zero, or of a size down to the least that a coordinate has.
fn small(rng: &mut Rng) -> f32 {
    if rng.u32(0..3) == 0 { 0.0 } else { (power(rng, -18.0, 0.0) * if rng.bool() { 1.0 } else { -1.0 }) as f32 }
}

/// A part of either kind of every size, and a ray of every length at it: often through its centre, or beside it by next to
/// nothing.
fn draw(rng: &mut Rng) -> (Primitive, StreamRay) {
    let Drawn { mut centre, mut radius, mut ray } = From::ALL[rng.usize(0..From::ALL.len())].draw(rng);
    match rng.u32(0..4) {
        0 => {}
        1 => {
            radius = power(rng, -12.0, 0.0) as f32;
            ray.direction = centre - ray.origin;
        }
        2 => {
            centre = Vec3::from_array([0; 3].map(|_| small(rng)));
            radius = power(rng, -12.0, 0.0) as f32;
            ray.origin = Vec3::from_array([0; 3].map(|_| small(rng)));
            ray.direction = centre - ray.origin;
        }
        _ => {
            radius = power(rng, -12.0, 0.0) as f32;
            ray.origin = centre + cube(rng).as_vec3() * radius * 2.0;
            ray.direction = Vec3::from_array([0; 3].map(|_| small(rng)));
        }
    }
    ray.direction *= power(rng, -15.0, 12.0) as f32;
    // Of lengths from 2^-57 to 2^62: the square of a longer one is no number.
    let length = ray.direction.as_dvec3().length();
    if !(1e-17..4e18).contains(&length) {
        ray.direction = Vec3::X;
    }
    ray.source_primitive = [StreamRay::NOWHERE, 7, 8, 7 | 1 << 31][rng.usize(0..4)];
    let normal = if rng.bool() { Vec3::from_array([0; 3].map(|_| small(rng))) } else { unit(rng).as_vec3() };
    let normal = normal.as_dvec3().normalize_or(glam::DVec3::Z).as_vec3();
    let normal = normal.map(|x| if x.abs() < 2f32.powi(-60) { 0.0 } else { x });
    let primitive = if rng.bool() {
        Primitive::sphere(centre, radius, 7, 0, 0)
    } else {
        Primitive::disk(centre, normal, radius, 7, 0, 0)
    };
    (primitive, ray)
}

#[test]
fn none_is_used_in_spheres_and_disks() {
    let (rays, mut rng, mut hits) = (count::of(200_000, 20_000_000), Rng::with_seed(23), 0);
    for _ in 0..rays {
        let (primitive, ray) = draw(&mut rng);
        let (bare, out) = (Bare::new(vec![primitive]), unit(&mut rng).as_vec3());
        let alone = found::<f32>(&bare, &ray, out);
        hits += usize::from(alone[0] > 1);
        assert_eq!(alone, found::<Counting>(&bare, &ray, out));
        assert_eq!(alone, found::<Flushing>(&bare, &ray, out), "on a device that flushes: {bare:?} {ray:?}");
    }
    let found = subnormals();
    println!("{} subnormal operands in {rays} rays, {hits} hits", found.values().sum::<u64>());
    assert!(
        found.is_empty() && hits * 4 > rays,
        "subnormal operands, by place in the kernels: {found:#?}, {hits} hits"
    );
}
