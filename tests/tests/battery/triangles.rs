//! Triangles that are hardly any, or too many in one place: hits are those of brute force, and what is no number is
//! refused by the number of its triangle.

use eyerays::error::Error;
use eyerays::pack::Packed;
use eyerays::scene::Scene;
use eyerays_bvh::Quality;
use eyerays_tests::count;
use eyerays_tests::random::Random;
use eyerays_tests::surface::Surface;
use glam::{DVec3, Vec3};

use crate::against::{assert_like_brute_force, rays};

/// Each triangle with vertices of its own.
fn soup(triangles: impl IntoIterator<Item = [Vec3; 3]>) -> Surface {
    let positions = triangles.into_iter().flatten().collect::<Vec<_>>();
    let triangles = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Surface { positions, triangles }
}

/// A place in a cube.
fn place(random: &mut Random) -> Vec3 {
    random.cube().as_vec3()
}

fn ordinary(count: usize, random: &mut Random) -> Vec<[Vec3; 3]> {
    let near = |p: Vec3, random: &mut Random| p + 0.3 * place(random);
    let triangle = |_| {
        let p = place(random);
        [p, near(p, random), near(p, random)]
    };
    (0..count).map(triangle).collect()
}

fn assert_soup(what: &str, triangles: Vec<[Vec3; 3]>) {
    let (packed, meets) = (soup(triangles.clone()).pack(), triangles.len());
    let count = if meets > 10_000 { count::of(64, 1000) } else { count::of(500, 100_000) };
    assert_like_brute_force(&format!("triangles, {what}"), &packed, &rays(&packed, count), 2 * meets);
}

#[test]
fn slivers_of_aspect_1e7() {
    let mut random = Random(3);
    let sliver = |random: &mut Random| {
        let (a, along) = (place(random).as_dvec3() * 0.5, random.direction());
        let across = along.cross(random.direction()).normalize() * 1e-7;
        [a, a + along, a + along * random.unit() + across].map(|v: DVec3| v.as_vec3())
    };
    let slivers = (0..300).map(|_| sliver(&mut random)).collect::<Vec<_>>();
    assert_soup("slivers of aspect 1e7", [slivers, ordinary(100, &mut random)].concat());
}

#[test]
fn points_and_lines() {
    let mut random = Random(4);
    let line = |random: &mut Random| {
        let (a, b) = (place(random), place(random));
        [a, b, a + (b - a) * 0.5]
    };
    let points = (0..200).map(|_| [place(&mut random); 3]).collect::<Vec<_>>();
    let lines = (0..200).map(|_| line(&mut random)).collect::<Vec<_>>();
    assert_soup("points", points.clone());
    assert_soup("lines", lines.clone());
    assert_soup("points, lines and others", [points, lines, ordinary(100, &mut random)].concat());
}

#[test]
fn subnormal_and_negative_zero_vertices() {
    const ODD: [f32; 8] = [0.0, -0.0, 1e-40, -1e-45, f32::MIN_POSITIVE, 1e-19, 0.5, -1.0];
    let mut random = Random(5);
    let odd = |random: &mut Random| Vec3::from_array(std::array::from_fn(|_| ODD[random.index(ODD.len())]));
    let odd = (0..400).map(|_| std::array::from_fn(|_| odd(&mut random))).collect::<Vec<_>>();
    assert_soup("subnormal and -0 vertices", [odd, ordinary(50, &mut random)].concat());
    // The largest coordinate is subnormal: the scene is scaled up.
    let tiny = (0..50).map(|_| std::array::from_fn(|_| place(&mut random) * 1e-40)).collect();
    assert_soup("a subnormal scene", tiny);
}

#[test]
fn duplicates() {
    let mut random = Random(6);
    let one = ordinary(1, &mut random)[0];
    assert_soup("10,000 duplicates", vec![one; 10_000]);
    assert_soup("100,000 duplicates", vec![one; 100_000]);
}

#[test]
fn coplanar_overlaps() {
    let mut random = Random(7);
    let flat = |random: &mut Random, axis: usize| {
        let mut triangle: [Vec3; 3] = std::array::from_fn(|_| place(random));
        triangle.iter_mut().for_each(|vertex| vertex[axis] = 0.25);
        triangle
    };
    assert_soup("coplanar overlaps", (0..300).map(|i| flat(&mut random, i % 3)).collect());
}

#[test]
fn equal_centroids() {
    let mut random = Random(8);
    let around = |random: &mut Random| {
        let (a, b) = (place(random) * 0.5, place(random) * 0.5);
        [a, b, -(a + b)]
    };
    assert_soup("equal centroids", (0..2000).map(|_| around(&mut random)).collect());
}

#[test]
fn one_triangle() {
    assert_soup("one", ordinary(1, &mut Random(9)));
}

/// What a scene without vouched-for numbers is refused with.
fn refusal(scene: &Scene) -> Option<Error> {
    Packed::new(scene, &scene.cameras[0], scene.settings, Quality::Medium).err()
}

#[test]
fn none_at_all() {
    let error = refusal(&soup([]).scene()).expect("there is nothing to see").to_string();
    assert!(error.contains("no triangles") && !error.contains('\n'), "{error}");
}

#[test]
fn nan_and_infinite_vertices() {
    let (mut accepted, mut cases) = (0, 0);
    for bad in [f32::NAN, -f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for (corner, axis) in (0..9).map(|i| (i / 3, i % 3)) {
            let mut triangles = ordinary(10, &mut Random(10));
            triangles[7][corner][axis] = bad;
            let error = refusal(&soup(triangles).scene()).map(|e| e.to_string());
            let names = error.as_ref().is_some_and(|e| e.contains("primitive") && !e.contains('\n'));
            let exactly = bad.is_infinite() || error.as_ref().is_some_and(|e| e.contains("primitive 7"));
            accepted += usize::from(!(names && exactly));
            cases += 1;
        }
    }
    count::none("triangles, NaN and infinite vertices not refused", "packing", accepted, cases);
}
