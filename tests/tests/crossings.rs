//! Crossings of closed meshes: even from outside, odd from inside, wherever a ray goes, on every device and by every hierarchy.

use std::collections::HashMap;

use eyerays::batch::Ray;
use eyerays::gpu::AdapterRequest;
use eyerays::quality::Bvh;
use eyerays::queries::{Crossings, Queries};
use eyerays::scene::{Instance, Material, Mesh, Object, Primitives, Scene, SharedMesh};
use eyerays_tests::gpu;
use eyerays_tests::random::Random;
use glam::{DVec3, Vec3};

/// A ball of triangles around zero, of radius one.
fn ball(level: u32) -> Mesh {
    let mut positions: Vec<Vec3> = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|axis| [axis, -axis]).collect();
    let eighths = (0..8u32).map(|i| {
        let [x, y, z] = [i & 1, 2 + (i >> 1 & 1), 4 + (i >> 2 & 1)];
        // Counter-clockwise from outside.
        if (i.count_ones()) % 2 == 0 { [x, y, z] } else { [x, z, y] }
    });
    let mut triangles: Vec<[u32; 3]> = eighths.collect();
    for _ in 0..level {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                positions.push((positions[a as usize] + positions[b as usize]).normalize());
                positions.len() as u32 - 1
            })
        };
        let quarters = triangles.iter().flat_map(|&[a, b, c]| {
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        });
        triangles = quarters.collect();
    }
    Mesh { positions, materials: vec![0; triangles.len()], triangles, ..Mesh::default() }
}

/// A bar of a square's cross-section, whose faces lie along the axes: many of them are seen edge-on by rays along these.
fn bar() -> Mesh {
    let corner =
        |i: u32| Vec3::new(2.0 * (i & 1) as f32 - 1.0, 2.0 * (i >> 1 & 1) as f32 - 1.0, 0.25 * (i >> 2) as f32);
    let triangles = vec![
        [0, 3, 1],
        [0, 2, 3],
        [4, 5, 7],
        [4, 7, 6],
        [0, 1, 5],
        [0, 5, 4],
        [2, 7, 3],
        [2, 6, 7],
        [0, 6, 2],
        [0, 4, 6],
        [1, 3, 7],
        [1, 7, 5],
    ];
    Mesh { positions: (0..8).map(corner).collect(), materials: vec![0; 12], triangles, ..Mesh::default() }
}

/// A ball of stripes by sines and cosines, whose coordinates are next to zero where they should be zero: by 1e-17.
fn stripes(around: u32, along: u32) -> Mesh {
    let turn = |of: u32, whole: f64, parts: u32| f64::from(of) * whole / f64::from(parts);
    let place = |row: u32, column: u32| {
        let (tilt, turn) = (turn(row, std::f64::consts::PI, along), turn(column, std::f64::consts::TAU, around));
        DVec3::new(tilt.sin() * turn.cos(), tilt.sin() * turn.sin(), tilt.cos()).as_vec3()
    };
    let rings = (1..along).flat_map(|row| (0..around).map(move |column| place(row, column)));
    let positions: Vec<Vec3> = [Vec3::Z, -Vec3::Z].into_iter().chain(rings).collect();
    let at = |row: u32, column: u32| match row {
        0 => 0,
        _ if row == along => 1,
        _ => 2 + (row - 1) * around + column % around,
    };
    let quads = (0..along).flat_map(|row| (0..around).map(move |column| (row, column)));
    let triangles = quads.flat_map(|(row, column)| {
        let [a, b] = [at(row, column), at(row, column + 1)];
        let [c, d] = [at(row + 1, column), at(row + 1, column + 1)];
        [[a, c, d], [a, d, b]]
    });
    // At the poles one of two has no area.
    let triangles: Vec<[u32; 3]> = triangles.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    Mesh { positions, materials: vec![0; triangles.len()], triangles, ..Mesh::default() }
}

fn scene(mesh: Mesh) -> Scene {
    let of = |name: &str, primitives| Object {
        name: name.to_owned(),
        primitives,
        bounds: mesh.bounds(),
        visibility: Default::default(),
    };
    let objects = vec![of("mesh", Primitives::Triangles(0..mesh.triangles.len()))];
    Scene { objects, ..Scene::of_mesh(mesh, Material::default()) }
}

/// Rays from a place at every vertex, the middle of every edge and of every triangle, and along the axes.
fn aimed(mesh: &Mesh, origin: DVec3) -> Vec<Ray> {
    let at = |of: u32| mesh.positions[of as usize].as_dvec3();
    let vertices = mesh.positions.iter().map(|p| p.as_dvec3());
    let others = mesh.triangles.iter().flat_map(|&[a, b, c]| [(at(a) + at(b)) / 2.0, (at(a) + at(b) + at(c)) / 3.0]);
    let to = vertices.chain(others).map(|aim| aim - origin);
    let axes = DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
    to.chain(axes).filter(|way| *way != DVec3::ZERO).map(|way| Ray::new(origin, way)).collect()
}

fn counts(crossings: &Crossings, rays: usize) -> Vec<usize> {
    (0..rays).map(|ray| crossings.of_ray(ray).len()).collect()
}

fn crossings(scene: &Scene, quality: Bvh, rays: &[Ray]) -> Crossings {
    Queries::new(scene, quality, 0).unwrap().crossings(0..rays.len(), &|i: usize| rays[i]).unwrap()
}

const INSIDE: [DVec3; 4] = [
    DVec3::new(0.0, 0.0, 0.125),
    DVec3::new(0.31, -0.22, 0.2),
    DVec3::new(-0.5, 0.5, 0.0625),
    DVec3::new(0.0, 0.25, 0.1),
];
const OUTSIDE: [DVec3; 5] = [
    DVec3::new(3.0, 0.0, 0.125),
    DVec3::new(0.0, -5.0, 0.0),
    DVec3::new(2.0, 2.0, 0.25),
    DVec3::new(1.5, 1.5, 1.5),
    DVec3::new(-4.0, 0.3, 1e3),
];

#[test]
fn a_closed_mesh_is_crossed_an_odd_number_of_times_from_inside_and_an_even_one_from_outside() {
    for mesh in [ball(4), bar()] {
        let scene = scene(mesh);
        for (parity, origins) in [(1, &INSIDE[..]), (0, &OUTSIDE[..])] {
            for &origin in origins {
                let rays = aimed(&scene.mesh, origin);
                let counts = counts(&crossings(&scene, Bvh::Medium, &rays), rays.len());
                let wrong = counts.iter().position(|count| count % 2 != parity);
                assert!(wrong.is_none(), "{origin}: {:?}", wrong.map(|i| (rays[i], counts[i])));
            }
        }
    }
}

/// From the middle of a ball whose vertices are next to its axes, but not on them: what is next to zero for one test is zero for another.
#[test]
fn what_is_next_to_zero_is_crossed_as_often() {
    let scene = scene(stripes(400, 16));
    for (parity, origin) in [(1, DVec3::ZERO), (0, DVec3::new(0.0, 3.0, 0.0)), (0, DVec3::new(-2.0, 0.0, 0.0))] {
        let rays = aimed(&scene.mesh, origin);
        let counts = counts(&crossings(&scene, Bvh::Medium, &rays), rays.len());
        let wrong = counts.iter().position(|count| count % 2 != parity);
        assert!(wrong.is_none(), "{origin}: {:?}", wrong.map(|i| (rays[i], counts[i])));
    }
}

/// A ball is convex but for its rounding: a silhouette counts 0 or 2 times.
#[test]
fn a_silhouette_is_crossed_twice_or_not_at_all() {
    let scene = scene(ball(3));
    let rays: Vec<Ray> = scene
        .mesh
        .positions
        .iter()
        .map(|p| {
            // Past a vertex, across its normal.
            let p = p.as_dvec3();
            let along = p.any_orthonormal_vector();
            Ray::new(p - 3.0 * along, along)
        })
        .collect();
    let counts = counts(&crossings(&scene, Bvh::High, &rays), rays.len());
    assert!(counts.iter().all(|count| [0, 2].contains(count)), "{counts:?}");
    assert!(counts.contains(&0) && counts.contains(&2));
}

#[test]
fn crossings_are_those_of_double_precision_and_every_triangle_in_order() {
    let scene = scene(ball(3));
    let mut random = Random::new(3);
    let rays: Vec<Ray> = (0..500).map(|_| Ray::new(2.0 * random.cube(), random.direction())).collect();
    let queries = Queries::new(&scene, Bvh::Medium, 0).unwrap();
    let found = queries.crossings(0..rays.len(), &|i: usize| rays[i]).unwrap();
    for (i, ray) in rays.iter().enumerate() {
        let mut expected: Vec<(f64, u32)> = Vec::new();
        for (number, corners) in (0..).zip(&scene.mesh.triangles) {
            let [a, b, c] = corners.map(|of| scene.mesh.positions[of as usize].as_dvec3());
            let p = ray.direction.cross(c - a);
            let over = 1.0 / (b - a).dot(p);
            let (u, q) = ((ray.origin - a).dot(p) * over, (ray.origin - a).cross(b - a));
            let (v, t) = (ray.direction.dot(q) * over, (c - a).dot(q) * over);
            if u > 0.0 && v > 0.0 && u + v < 1.0 && t > 0.0 {
                expected.push((t, number));
            }
        }
        expected.sort_by(|a, b| a.0.total_cmp(&b.0));
        let got = found.of_ray(i);
        assert_eq!(got.len(), expected.len(), "{ray:?}");
        for (hit, (t, triangle)) in got.iter().zip(&expected) {
            assert_eq!(hit.primitive, *triangle);
            assert!((hit.t - t).abs() < 1e-4, "{} and {t}", hit.t);
        }
        for hit in got {
            let place = queries.place(hit).expect("it is there").point;
            assert!(place.distance(ray.origin + ray.direction * hit.t) < 1e-4);
        }
    }
}

/// Triangles that lie in one another are crossed one after the other, those of lower numbers first; ends of rays count.
#[test]
fn what_is_equally_far_comes_by_its_number_and_a_ray_ends() {
    let bar = bar();
    let mut twice = bar.clone();
    twice.triangles.extend(&bar.triangles);
    twice.materials.extend(&bar.materials);
    let scene = scene(twice);
    let (up, origin) = (DVec3::Z, DVec3::new(0.3, 0.1, -1.0));
    let rays =
        [Ray::new(origin, up), Ray { tmax: 1.1, ..Ray::new(origin, up) }, Ray { tmax: 0.5, ..Ray::new(origin, up) }];
    for quality in Bvh::OF_HOST {
        let found = crossings(&scene, quality, &rays);
        assert_eq!(counts(&found, 3), [4, 2, 0]);
        let numbers = |ray| found.of_ray(ray).iter().map(|hit| hit.primitive).collect::<Vec<_>>();
        let [first, second, third, fourth] = numbers(0)[..] else { panic!("four") };
        assert!(first + 12 == second && third + 12 == fourth && numbers(1) == [first, second], "{:?}", numbers(0));
    }
}

/// Copies of a mesh, near and far, turned and stretched.
#[test]
fn every_device_and_hierarchy_has_the_same_crossings_and_copies_are_closed() {
    let (ball, bar) = (ball(3), bar());
    let mut mesh = bar.clone();
    let first = (mesh.positions.len(), mesh.triangles.len());
    mesh.positions.extend(&ball.positions);
    mesh.triangles.extend(ball.triangles.iter().map(|corners| corners.map(|of| of + first.0 as u32)));
    mesh.materials.resize(mesh.triangles.len(), 0);
    let turned = |angle: f32, size: f32, translation| Instance {
        mesh: 0,
        rows: [
            Vec3::new(angle.cos() * size, -angle.sin(), 0.0),
            Vec3::new(angle.sin() * size, angle.cos(), 0.0),
            Vec3::new(0.0, 0.1, size),
        ],
        translation,
    };
    let shared = SharedMesh { vertices: first.0..mesh.positions.len(), triangles: first.1..mesh.triangles.len() };
    let scene = Scene {
        shared: vec![shared],
        instances: vec![turned(0.3, 0.5, Vec3::new(0.0, 0.0, 3.0)), turned(2.0, 1.5, Vec3::new(6.0, 1.0, 0.0))],
        ..scene(mesh.clone())
    };
    let mut random = Random::new(9);
    let mut rays: Vec<Ray> = (0..2000).map(|_| Ray::new(12.0 * random.cube(), random.cube() * 4.0)).collect();
    rays.iter_mut().for_each(|ray| ray.direction -= ray.origin);
    // Through two things, one behind the other.
    let middles = [DVec3::ZERO, DVec3::new(0.0, 0.0, 3.0), DVec3::new(6.0, 1.0, 0.0)];
    rays.extend((0..600).map(|i| {
        let [near, far] = [middles[i % 3], middles[i / 3 % 3]].map(|middle| middle + 0.5 * random.cube());
        Ray::new(near + 12.0 * (near - far).normalize(), far - near)
    }));
    let of_vertices = mesh
        .positions
        .iter()
        .map(|p| Ray::new(DVec3::new(20.0, 3.0, 9.0), p.as_dvec3() * 1.5 - DVec3::new(14.0, 2.0, 9.0)));
    rays.extend(of_vertices);
    let queries = Queries::new(&scene, Bvh::Fast, 0).unwrap();
    let all = |queries: &Queries| {
        let found = queries.crossings(0..rays.len(), &|i: usize| rays[i]).unwrap();
        (0..rays.len())
            .map(|ray| found.of_ray(ray).iter().map(|hit| (*hit, queries.place(hit))).collect::<Vec<_>>())
            .collect::<Vec<_>>()
    };
    let expected = all(&queries);
    let outside = |ray: &Ray| ray.origin.length() > 9.0;
    let odd = rays.iter().zip(&expected).find(|(ray, found)| outside(ray) && found.len() % 2 != 0);
    assert!(odd.is_none(), "{odd:?}");
    assert!(expected.iter().filter(|found| found.len() > 2).count() > 100);
    for quality in [Bvh::Medium, Bvh::High] {
        assert!(all(&Queries::new(&scene, quality, 0).unwrap()) == expected, "{quality:?}");
    }
    if let Some(gpu) = gpu(&AdapterRequest { exact: true, ..AdapterRequest::default() }) {
        assert!(all(&queries.on(&gpu).unwrap()) == expected, "{}", gpu.report.name);
    }
}
