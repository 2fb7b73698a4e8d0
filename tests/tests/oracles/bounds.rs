//! The errors that the kernels' sources state, against what intervals show them to be.

use eyerays::scene::Settings;
use eyerays_shader::data::{BOX_PADDING, CentredPair, Effects, NodePair, NodeRef, Primitive};
use eyerays_shader::geometry::SurfaceInteraction;
use eyerays_shader::geometry::{sheared, slab};
use eyerays_shader::ray::Ray;
use eyerays_shader::real::V3;
use eyerays_shader::traverse::step;
use eyerays_tests::numbers::exact::{self, ROUNDOFF};
use eyerays_tests::numbers::{Interval, picture};
use eyerays_tests::{SHIPPED, count, pack, settings, shipped};
use fastrand::Rng;
use glam::Vec3;

use super::corpus::cases;

type V = V3<Interval>;

/// Each ray with some triangles of its scene.
fn pairs(mut f: impl FnMut(&Ray<Interval>, [Vec3; 3], &mut Rng)) {
    let mut rng = Rng::with_seed(13);
    for case in cases(count::of(3_000, 300_000)) {
        let triangles = case.triangles();
        for ray in &case.rays {
            let ray = Ray::<Interval>::new(V::splat(ray.origin), V::splat(ray.direction));
            f(&ray, triangles[rng.usize(0..triangles.len())], &mut rng);
        }
    }
}

/// `geometry::triangle`: a sheared vertex is off by less than 16 roundoffs on each axis.
#[test]
fn sheared_vertices() {
    let (mut most, mut vertices) = (0f64, 0);
    pairs(|ray, triangle, _| {
        for p in triangle {
            let (x, y) = sheared(ray.seen(p), ray.slopes());
            most = most.max(x.error()).max(y.error());
            vertices += 1;
        }
    });
    println!("sheared vertices: largest error {:.2} roundoffs of 16, {vertices} vertices", most / ROUNDOFF);
    assert!(most <= exact::SHEAR && most > ROUNDOFF);
}

/// `geometry::slab`: an entry errs by less than gamma(3), and the widened exit is never too near. Then the boxes of
/// nodes by centre and half their extent: a plane's distance is worth a shift of less than 7 roundoffs.
#[test]
fn boxes() {
    let gamma = 3.0 * ROUNDOFF / (1.0 - 3.0 * ROUNDOFF);
    let (mut entry, mut shift, mut tests) = (0f64, 0f64, 0);
    pairs(|ray, triangle, _| {
        let (least, greatest) = Primitive::triangle(triangle, 0, 0, 0).bounds();
        let own = slab(V::splat(least), V::splat(greatest), ray);
        if own.near.value > 0.0 {
            entry = entry.max(own.near.error() / f64::from(own.near.value));
        }
        let widen = 1.0 + 8.0 * ROUNDOFF;
        if own.far.value >= 0.0 && own.near.value <= own.far.value {
            assert!(f64::from(own.far.value) >= own.far.high / widen, "{own:?} leaves too soon");
        }
        let child = (least, greatest, NodeRef::leaf(0, 1));
        let pair = CentredPair::from(&NodePair::new(child, NodePair::EMPTY));
        let node = step::inside(pair.left_centre, pair.left_half, ray, V::splat(glam::Vec3::MAX).x);
        // Entry and exit are those of some axis; the least inverse makes the most of the error.
        for bound in [node.near, node.far].into_iter().filter(|b| b.value != 0.0) {
            let axes = [ray.inverse.x, ray.inverse.y, ray.inverse.z].map(|i| f64::from(i.value.abs()));
            let on = axes.into_iter().fold(0.0, f64::max);
            shift = shift.max(bound.error() / on);
        }
        if own.near.value <= own.far.value {
            assert!(node.near.value <= own.near.value && node.far.value >= node.near.value, "{node:?} culls {own:?}");
        }
        tests += 1;
    });
    println!(
        "boxes: largest error of an entry {:.2} roundoffs of 3, of a node's plane {:.2} of 7; {tests} tests",
        entry / ROUNDOFF,
        shift / ROUNDOFF
    );
    assert!(entry <= gamma && entry > 0.0);
    assert!(shift <= 7.0 * ROUNDOFF && shift > 0.0);
    assert!(f64::from(CentredPair::MARGIN) > 28.0 * ROUNDOFF && f64::from(BOX_PADDING) >= exact::SHEAR);
}

/// `data::triangle`: an own box is the triangle's extent and the padding on every side, but for one rounding. (No ray
/// that was found needs the padding: the widened exit alone covers what the test errs by. The proof needs it.)
#[test]
fn own_boxes_are_padded() {
    let mut rng = fastrand::Rng::with_seed(11);
    for i in 0..100_000 {
        let mut vertices = [0; 3].map(|_| Vec3::from([0; 3].map(|_| 2.0 * rng.f32() - 1.0)));
        // Flat along an axis, three times of four.
        if i % 4 < 3 {
            let place = vertices[0][i % 4];
            vertices.iter_mut().for_each(|v| v[i % 4] = place);
        }
        let (least, greatest) = Primitive::triangle(vertices, 0, 0, 0).bounds();
        let low = vertices[0].min(vertices[1]).min(vertices[2]);
        let high = vertices[0].max(vertices[1]).max(vertices[2]);
        for padding in [low - least, greatest - high] {
            assert!((padding - BOX_PADDING).abs().max_element() <= f32::EPSILON, "{padding} around {vertices:?}");
        }
    }
}

/// `geometry::interaction`: a place errs by less than gamma(7) of its coordinates, its error_offset covers what of that lies
/// across the surface, and where a ray leaves is exactly on its own side.
#[test]
fn places_and_clearances() {
    let gamma = 7.0 * ROUNDOFF / (1.0 - 7.0 * ROUNDOFF);
    let (mut place, mut share, mut sides, mut thin) = (0f64, 0f64, 0, 0);
    pairs(|_, triangle, rng| {
        let [a, b, c] = triangle;
        let longest = (b - a).length().max((c - a).length()).max((c - b).length());
        // Clearance is stated for triangles no thinner than a fifth of their length.
        if (b - a).as_dvec3().cross((c - a).as_dvec3()).length() < 0.2 * f64::from(longest * longest) || longest < 1e-4
        {
            thin += 1;
            return;
        }
        let (u, v) = (rng.f32(), rng.f32());
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        let direction = Vec3::new(rng.f32() - 0.5, rng.f32() - 0.5, rng.f32() - 0.5).normalize();
        let splat = |x: f32| Interval::exact(x);
        let at = SurfaceInteraction::new(
            Effects(0),
            &Primitive::triangle(triangle, 0, 0, 0),
            (splat(u), splat(v)),
            V::splat(direction),
        );
        let reach = a.abs().max(b.abs()).max(c.abs()).as_dvec3().to_array();
        let (position, normal) =
            ([at.position.x, at.position.y, at.position.z], [at.normal.x, at.normal.y, at.normal.z]);
        let mut across = 0.0;
        for axis in (0..3).filter(|&axis| reach[axis] > 0.0) {
            place = place.max(position[axis].error() / reach[axis]);
            across += position[axis].error() * f64::from(normal[axis].value.abs());
        }
        share = share.max(across / f64::from(at.error_offset.value));
        let leaves = at.offset_ray_origin(V::splat(-direction));
        let origin = Vec3::new(leaves.x.value, leaves.y.value, leaves.z.value);
        let side = exact::side(triangle, origin);
        let viewer = exact::side(triangle, a - direction * 4.0);
        assert_eq!(side, viewer, "{triangle:?}, weights {u} {v}: {origin} is not on the side of {}", -direction);
        sides += 1;
    });
    println!(
        "places: largest error {:.2} roundoffs of 7; {:.3} of the error_offset; {sides} origins on their own side, \
        {thin} triangles too thin to ask",
        place / ROUNDOFF,
        share
    );
    assert!(place <= gamma && share <= 1.0 && sides > 1000);
}

/// Whole pictures of one bounce: along the ways that their branches take, most pixels are within 1e-4 of exact
/// arithmetic, and every value is finite. (An interval does not know that two of its operands err together, so it
/// loses some pixels, and with further bounces most.)
#[test]
fn pictures() {
    let edge = count::of(48, 256) as u32;
    for name in SHIPPED {
        let scene = shipped(name);
        for camera in &scene.cameras {
            let packed = pack(&scene, camera, Settings { bounces: 1, ..settings(&scene, (edge, edge * 3 / 4), 1) });
            let film = picture::<Interval>(&packed);
            let alone = picture::<f32>(&packed);
            assert!(film.iter().zip(&alone).all(|(a, b)| (a.x.value, a.y.value, a.z.value) == (b.x, b.y, b.z)));
            let mut errors: Vec<f64> = film.iter().map(|p| p.x.error().max(p.y.error()).max(p.z.error())).collect();
            errors.sort_by(f64::total_cmp);
            let far = errors.iter().filter(|e| **e > 1e-4).count();
            let (median, most) = (errors[errors.len() / 2], errors[errors.len() - 1 - errors.len() / 1000]);
            println!(
                "{name}, camera {}: median error {median:.1e}, of 99.9 % {most:.1e}, {far} of {} over 1e-4",
                camera.name,
                errors.len()
            );
            assert!(film.iter().all(|p| p.x.value.is_finite() && p.y.value.is_finite() && p.z.value.is_finite()));
            assert!(far * 100 <= errors.len(), "{name}, camera {}", camera.name);
        }
    }
}
