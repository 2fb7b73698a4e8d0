//! Rays of one's own meet the surfaces of a scene, whatever these are made of, at the places that are told.

use eyerays::batch::{Hit, Ray};
use eyerays::gpu::AdapterRequest;
use eyerays::quality::Bvh;
use eyerays::queries::{Place, Queries};
use eyerays::scene::{Primitives, Scene};
use eyerays_tests::random::Random;
use eyerays_tests::{gpu, shipped};
use glam::DVec3;

/// Rays of each scene.
const RAYS: usize = 4000;

/// Rays from anywhere around a scene towards anywhere in it.
fn rays(scene: &Scene) -> Vec<Ray> {
    let corners = scene.objects.iter().flat_map(|object| object.bounds).map(|corner| corner.as_dvec3());
    let (least, greatest) = corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)));
    let (middle, size) = ((least + greatest) / 2.0, (greatest - least).max_element());
    let mut random = Random::new(11);
    let ray = |_| {
        let (origin, aim) = (middle + random.cube() * size, middle + random.cube() * size * 0.5);
        Ray::new(origin, aim - origin)
    };
    (0..RAYS).map(ray).collect()
}

/// Glass, spheres, holes of pictures, copies of meshes and what is hidden from some.
const SCENES: [&str; 6] = ["glass", "whitted", "frosted", "finishes", "subdivision", "room"];

fn asked(queries: &Queries, rays: &[Ray]) -> (Vec<Option<Hit>>, Vec<bool>) {
    let of = |i: usize| rays[i];
    (queries.closest(rays.len(), of).unwrap(), queries.any(rays.len(), of).unwrap())
}

#[test]
fn anything_is_met_where_something_is_met_first() {
    for name in SCENES {
        let scene = shipped(name);
        let rays = rays(&scene);
        let queries = Queries::new(&scene, Bvh::Medium, 0).unwrap();
        let (hits, any) = asked(&queries, &rays);
        let met: Vec<bool> = hits.iter().map(Option::is_some).collect();
        assert!(met == any, "{name}");
        let count = met.iter().filter(|&&met| met).count();
        assert!((RAYS / 50..=RAYS).contains(&count), "{name}: {count}");
        // And nothing before what is met first, but for the last bits of single precision.
        let before = |i: usize| Ray { tmax: hits[i].map_or(0.0, |hit| hit.t * (1.0 - 1e-5)), ..rays[i] };
        let early = queries.any(RAYS, before).unwrap();
        assert!(early.iter().all(|early| !early), "{name}");
    }
}

#[test]
fn places_are_on_the_triangles_and_along_the_rays() {
    for name in SCENES {
        let scene = shipped(name).flattened();
        let rays = rays(&scene);
        let queries = Queries::new(&scene, Bvh::Medium, 0).unwrap();
        let (hits, _) = asked(&queries, &rays);
        let mut seen = 0;
        for (i, ray) in rays.iter().enumerate() {
            let Some(hit) = hits[i] else { continue };
            let at = queries.place(&hit).expect("it is somewhere");
            let (object, within) = queries.surface(&hit).expect("all are of objects");
            let Primitives::Triangles(range) = &scene.objects[object as usize].primitives else { continue };
            assert_eq!(range.start + within as usize, hit.primitive as usize, "{name}");
            let [a, b, c] = scene.mesh.triangles[hit.primitive as usize]
                .map(|vertex| scene.mesh.positions[vertex as usize].as_dvec3());
            let normal = (b - a).cross(c - a).normalize();
            if !normal.is_finite() || normal.dot(ray.direction.normalize()).abs() < 1e-3 {
                continue;
            }
            let Place { point, error, .. } = at;
            let size = a.abs().max(b.abs()).max(c.abs()).max_element();
            assert!((point - a).dot(normal).abs() <= error + 1e-15 * size, "{name}: {point} of {ray:?}");
            assert!(at.normal.as_dvec3().distance(normal) < 1e-3, "{name}: {} and {normal}", at.normal);
            let along = ray.origin + ray.direction * hit.t;
            assert!(along.distance(point) < 2e-3 * along.distance(ray.origin).max(size), "{name}: {along} and {point}");
            seen += 1;
        }
        assert!(seen > 20, "{name}: {seen}");
    }
}

#[test]
fn a_gpu_has_the_same_answers() {
    let Some(gpu) = gpu(&AdapterRequest { exact: true, ..AdapterRequest::default() }) else { return };
    for name in ["whitted", "room"] {
        let scene = shipped(name);
        let rays = rays(&scene);
        let cpu = Queries::new(&scene, Bvh::Fast, 0).unwrap();
        let ((hits, any), (others, other)) = (asked(&cpu, &rays), asked(&cpu.on(&gpu).unwrap(), &rays));
        let place = |hit: &Option<Hit>| hit.as_ref().and_then(|hit| cpu.place(hit));
        assert!(any == other, "{name}");
        for i in 0..RAYS {
            assert_eq!((hits[i], place(&hits[i])), (others[i], place(&others[i])), "{name}, ray {i}");
        }
    }
}

/// So many that a CPU asks them by their directions; few of them are asked as they come.
#[test]
fn rays_from_one_place_have_the_answers_that_each_has_by_itself() {
    let (count, few) = ((1 << 17) + 77, 10_000);
    let mut random = Random::new(4);
    let scene = shipped("room");
    let rays: Vec<Ray> = (0..count).map(|_| Ray::new(DVec3::new(0.1, 1.2, -0.3), random.cube())).collect();
    let queries = Queries::new(&scene, Bvh::Medium, 2).unwrap();
    let (hits, any) = asked(&queries, &rays);
    assert!(hits.iter().flatten().count() > count / 2);
    for (part, rays) in rays.chunks(few).enumerate() {
        let (own, own_any) = asked(&queries, rays);
        let all = few * part..few * part + rays.len();
        assert!(hits[all.clone()] == own && any[all] == own_any, "part {part}");
    }
}

#[test]
fn no_rays_have_no_answers() {
    let queries = Queries::new(&shipped("cornell"), Bvh::Fast, 1).unwrap();
    let (hits, any) = asked(&queries, &[]);
    assert!(hits.is_empty() && any.is_empty());
}
