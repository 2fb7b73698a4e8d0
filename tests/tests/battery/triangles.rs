//! Triangles that are hardly any, or too many in one place: hits are those of brute force, and what is no number is
//! refused by the number of its triangle.

use eyerays::error::Error;
use eyerays::job::Job;
use eyerays::scene::Scene;
use eyerays::stream::{Stream, StreamRay};
use eyerays_bvh::Quality;
use eyerays_tests::count;
use eyerays_tests::machine::Machine;
use eyerays_tests::random::Random;
use eyerays_tests::surface::Surface;
use glam::{DVec3, Vec3};

use crate::against::{assert_like_brute_force, ray, rays};

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
    let mut random = Random::new(3);
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
    let mut random = Random::new(4);
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
    let mut random = Random::new(5);
    let odd = |random: &mut Random| Vec3::from_array(std::array::from_fn(|_| ODD[random.index(ODD.len())]));
    let odd = (0..400).map(|_| std::array::from_fn(|_| odd(&mut random))).collect::<Vec<_>>();
    assert_soup("subnormal and -0 vertices", [odd, ordinary(50, &mut random)].concat());
    // The largest coordinate is subnormal: the scene is scaled up.
    let tiny = (0..50).map(|_| std::array::from_fn(|_| place(&mut random) * 1e-40)).collect();
    assert_soup("a subnormal scene", tiny);
}

#[test]
fn duplicates() {
    let mut random = Random::new(6);
    let one = ordinary(1, &mut random)[0];
    assert_soup("10,000 duplicates", vec![one; 10_000]);
    assert_soup("100,000 duplicates", vec![one; 100_000]);
}

#[test]
fn coplanar_overlaps() {
    let mut random = Random::new(7);
    let flat = |random: &mut Random, axis: usize| {
        let mut triangle: [Vec3; 3] = std::array::from_fn(|_| place(random));
        triangle.iter_mut().for_each(|vertex| vertex[axis] = 0.25);
        triangle
    };
    assert_soup("coplanar overlaps", (0..300).map(|i| flat(&mut random, i % 3)).collect());
}

#[test]
fn equal_centroids() {
    let mut random = Random::new(8);
    let around = |random: &mut Random| {
        let (a, b) = (place(random) * 0.5, place(random) * 0.5);
        [a, b, -(a + b)]
    };
    assert_soup("equal centroids", (0..2000).map(|_| around(&mut random)).collect());
}

#[test]
fn one_triangle() {
    assert_soup("one", ordinary(1, &mut Random::new(9)));
}

/// A triangle and a ray of its plane, exactly, that runs by the triangle on one side; less than `room` from `centre`.
fn beside_in_plane(centre: DVec3, room: f64, random: &mut Random) -> ([Vec3; 3], StreamRay) {
    let whole = |random: &mut Random, most: usize| random.index(most + 1) as f64;
    let vector = |random: &mut Random| DVec3::from_array(std::array::from_fn(|_| whole(random, 16) - 8.0));
    let (mut along, mut across) = (DVec3::ZERO, DVec3::ZERO);
    while along.cross(across) == DVec3::ZERO {
        (along, across) = (vector(random), vector(random));
    }
    let step = room / 128.0;
    let mut corner = || {
        let (on, off) = (whole(random, 4), 1.0 + whole(random, 3));
        (centre + step * (on * along + off * across)).as_vec3()
    };
    let triangle = std::array::from_fn(|_| corner());
    (triangle, StreamRay { limit: 1.0, ..ray(centre.as_vec3(), (4.0 * step * along).as_vec3()) })
}

/// Seen edge-on it is a line, and the ray is in line with it, but not where the triangle is.
#[test]
fn rays_beside_triangles_in_their_planes() {
    const CELLS: usize = 16;
    const CELL: f64 = 2.0 / CELLS as f64;
    let mut random = Random::new(12);
    let cell = |axis: usize| (axis % CELLS) as f64 + 0.5;
    let centre = |i: usize| CELL * DVec3::new(cell(i), cell(i / CELLS), cell(i / CELLS / CELLS)) - DVec3::ONE;
    for machine in Machine::all() {
        let (mut met, mut total) = (0, 0);
        for _ in 0..count::of(1, 20) {
            let cells = (0..CELLS.pow(3)).map(|i| beside_in_plane(centre(i), CELL / 2.0, &mut random));
            let (triangles, rays): (Vec<_>, Vec<_>) = cells.unzip();
            let (packed, stream) = (soup(triangles).pack(), Stream::new(rays.into_iter()));
            assert_eq!(packed.normalisation().exactly(DVec3::ONE), DVec3::ONE, "rays are of the world");
            let tracer = machine.tracer(&packed);
            for traversal in machine.traversals() {
                met += tracer.closest(traversal, &stream).iter().filter(|hit| hit.w != StreamRay::NOWHERE).count();
                total += stream.len();
            }
        }
        count::none("triangles, met by rays beside them in their planes", machine, met, total);
    }
}

/// What a scene without vouched-for numbers is refused with.
fn refusal(scene: &Scene) -> Option<Error> {
    Job::new(scene, scene.settings, Quality::Medium).err()
}

#[test]
fn none_at_all() {
    let error = refusal(&soup([]).scene()).expect("there is nothing to see").to_string();
    assert!(error.contains("no primitives") && !error.contains('\n'), "{error}");
}

#[test]
fn nan_and_infinite_vertices() {
    let (mut accepted, mut cases) = (0, 0);
    for bad in [f32::NAN, -f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for (corner, axis) in (0..9).map(|i| (i / 3, i % 3)) {
            let mut triangles = ordinary(10, &mut Random::new(10));
            triangles[7][corner][axis] = bad;
            let error = refusal(&soup(triangles).scene()).map(|e| e.to_string());
            let named = error.is_some_and(|e| e.contains("triangle 7 ") && !e.contains('\n'));
            accepted += usize::from(!named);
            cases += 1;
        }
    }
    count::none("triangles, NaN and infinite vertices not refused", "packing", accepted, cases);
}
