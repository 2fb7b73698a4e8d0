//! The triangles that are nearest to points: as near as any, on every device and by every hierarchy with the same bits.

use eyerays::gpu::AdapterRequest;
use eyerays::quality::Bvh;
use eyerays::queries::Queries;
use eyerays::scene::{Instance, Material, Mesh, Scene, SharedMesh};
use eyerays_tests::gpu;
use eyerays_tests::random::Random;
use glam::{DVec3, Vec3};

/// Triangles of all sizes and shapes, slivers and needles among them, and some without any area.
fn shreds(random: &mut Random, count: usize) -> Mesh {
    let mut positions = Vec::new();
    for i in 0..count {
        let (at, long, short) =
            (random.cube(), 0.3 * random.cube(), 10f64.powi(-((i % 8) as i32)) * 0.3 * random.cube());
        let third = match i % 5 {
            0 => at + long,
            1 => at + 0.4 * long + short,
            _ => at + short,
        };
        positions.extend([at, at + long, third].map(DVec3::as_vec3));
    }
    let triangles = (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Mesh { positions, triangles, materials: vec![0; count], ..Mesh::default() }
}

/// The distance of a point from a triangle as the least of a plane's and its edges', by solving for weights (no code of the renderer).
fn distance(corners: [DVec3; 3], point: DVec3) -> f64 {
    let [a, b, c] = corners;
    let edge = |a: DVec3, b: DVec3| {
        let way = b - a;
        let share =
            if way == DVec3::ZERO { 0.0 } else { ((point - a).dot(way) / way.length_squared()).clamp(0.0, 1.0) };
        point.distance(a + way * share)
    };
    let least = edge(a, b).min(edge(b, c)).min(edge(c, a));
    let (u, v) = (b - a, c - a);
    let normal = u.cross(v);
    let within = [(a, b), (b, c), (c, a)].iter().all(|&(p, q)| (q - p).cross(point - p).dot(normal) >= 0.0);
    if within && normal != DVec3::ZERO { least.min(((point - a).dot(normal) / normal.length()).abs()) } else { least }
}

fn points(random: &mut Random, mesh: &Mesh, count: usize) -> Vec<DVec3> {
    let mut points: Vec<DVec3> = (0..count).map(|i| random.cube() * 4f64.powi((i % 12) as i32 - 1)).collect();
    points.extend(mesh.positions.iter().step_by(17).map(|p| p.as_dvec3()));
    points
}

#[test]
fn no_triangle_is_nearer_than_the_one_that_is_found() {
    let mut random = Random::new(5);
    let mesh = shreds(&mut random, 600);
    let points = points(&mut random, &mesh, 600);
    let queries = Queries::new(&Scene::of_mesh(mesh.clone(), Material::default()), Bvh::Medium, 0).unwrap();
    let found = queries.nearest(points.len(), |i| points[i]).unwrap();
    let corners = |of: &[u32; 3]| of.map(|of| mesh.positions[of as usize].as_dvec3());
    for (i, &point) in points.iter().enumerate() {
        let (hit, place) = found[i].expect("something is nearest");
        let least = mesh.triangles.iter().map(|of| distance(corners(of), point)).fold(f64::INFINITY, f64::min);
        assert!(hit.t - least <= place.error, "{point}: {} and {least}", hit.t);
        assert!(place.error <= 1e-5 * (1.0 + point.length()));
        // What is told of the triangle is far closer than that.
        let own = distance(corners(&mesh.triangles[hit.primitive as usize]), point);
        assert!((hit.t - own).abs() <= 1e-12 * (1.0 + point.length()), "{point}: {} and {own}", hit.t);
        assert!((place.point.distance(point) - own).abs() <= 1e-12 * (1.0 + point.length()));
    }
}

#[test]
fn what_is_nowhere_is_near_to_nothing() {
    let mesh = shreds(&mut Random::new(1), 3);
    let queries = Queries::new(&Scene::of_mesh(mesh, Material::default()), Bvh::Fast, 0).unwrap();
    let points = [DVec3::NAN, DVec3::splat(f64::INFINITY), DVec3::splat(1e300), DVec3::ZERO];
    let found = queries.nearest(4, |i| points[i]).unwrap();
    assert_eq!(found.iter().map(Option::is_some).collect::<Vec<_>>(), [false, false, true, true]);
}

#[test]
fn every_device_and_hierarchy_finds_the_same_also_in_copies() {
    let mut random = Random::new(8);
    let mesh = shreds(&mut random, 400);
    let copy = |angle: f32, size: f32, translation| Instance {
        mesh: 0,
        rows: [
            Vec3::new(angle.cos() * size, -angle.sin(), 0.2),
            Vec3::new(angle.sin(), angle.cos() * size, 0.0),
            Vec3::new(0.0, 0.5, -size),
        ],
        translation,
    };
    let instances = vec![copy(0.4, 0.5, Vec3::new(3.0, 0.0, 1.0)), copy(2.0, 2.5, Vec3::new(0.0, -6.0, 0.0))];
    let shared = vec![SharedMesh { vertices: 600..1200, triangles: 200..400 }];
    let points = points(&mut random, &mesh, 4000);
    // Those of a shared mesh are where its copies are.
    let corners = |of: &[u32; 3]| of.map(|of| mesh.positions[of as usize].as_dvec3());
    let mut own: Vec<[DVec3; 3]> = mesh.triangles[..200].iter().map(corners).collect();
    for copy in &instances {
        let rows = copy.rows.map(|row| row.as_dvec3());
        let place = |p: DVec3| DVec3::from(rows.map(|row| row.dot(p))) + copy.translation.as_dvec3();
        own.extend(mesh.triangles[200..].iter().map(|of| corners(of).map(place)));
    }
    let scene = Scene { shared, instances, ..Scene::of_mesh(mesh.clone(), Material::default()) };
    let queries = Queries::new(&scene, Bvh::Fast, 0).unwrap();
    let all = |queries: &Queries| {
        let found = queries.nearest(points.len(), |i| points[i]).unwrap();
        found.into_iter().map(|of| of.expect("something is nearest")).collect::<Vec<_>>()
    };
    let expected = all(&queries);
    for (point, (hit, place)) in points.iter().zip(&expected) {
        let least = own.iter().map(|&corners| distance(corners, *point)).fold(f64::INFINITY, f64::min);
        assert!((hit.t - least).abs() <= place.error, "{point}: {} and {least}", hit.t);
        let it = distance(own[hit.primitive as usize], *point);
        assert!((hit.t - it).abs() <= place.error, "{point}: {} and {it}", hit.t);
    }
    for quality in [Bvh::Medium, Bvh::High] {
        assert!(all(&Queries::new(&scene, quality, 0).unwrap()) == expected, "{quality:?}");
    }
    if let Some(gpu) = gpu(&AdapterRequest { exact: true, ..AdapterRequest::default() }) {
        assert!(all(&queries.on(&gpu).unwrap()) == expected);
    }
}
