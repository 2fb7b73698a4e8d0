//! Split triangles: their references cover them, and nothing else.

mod common;

use common::*;
use eyerays_bvh::{Reference, Statistics, split};
use eyerays_shader::data::{BOX_PADDING, Primitive, numbers};
use glam::{Vec3, vec3};
use proptest::{collection::vec, prelude::*};

/// A point of a triangle, by weights from 0 to 1.
fn point(triangle: &Primitive, [u, v]: [f64; 2]) -> [f64; 3] {
    let [a, b, c] = triangle.vertices().map(|v| v.as_dvec3());
    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
    (a + (b - a) * u + (c - a) * v).to_array()
}

fn contains(reference: &Reference, point: [f64; 3]) -> bool {
    let (least, greatest) = (numbers(reference.bounds.least), numbers(reference.bounds.greatest));
    (0..3).all(|i| f64::from(least[i]) <= point[i] && point[i] <= f64::from(greatest[i]))
}

/// Checks that references are few enough, inside own boxes, and cover points with padding around.
fn check(triangles: &[Primitive], budget: f32, weights: &[[f64; 2]]) -> usize {
    let references = split(triangles, budget).unwrap();
    let most = triangles.len() + (budget * triangles.len() as f32) as usize;
    assert!((triangles.len()..=most).contains(&references.list().len()));
    let mut of: Vec<Vec<Reference>> = vec![Vec::new(); triangles.len()];
    for reference in references.list() {
        let (least, greatest) = triangles[reference.primitive as usize].bounds();
        let (low, high) = (numbers(reference.bounds.least), numbers(reference.bounds.greatest));
        assert!(least.cmple(low).all() && low.cmple(high).all() && high.cmple(greatest).all());
        of[reference.primitive as usize].push(*reference);
    }
    // Less by the rounding of own boxes.
    let pad = f64::from(BOX_PADDING) * 0.8;
    for (triangle, its) in triangles.iter().zip(&of) {
        for (weights, side) in weights.iter().zip(0..) {
            let sign = |axis: u32| if side >> axis & 1 == 1 { pad } else { -pad };
            let [x, y, z] = point(triangle, *weights);
            let beside = [x + sign(0), y + sign(1), z + sign(2)];
            assert!(its.iter().any(|r| contains(r, [x, y, z])), "a point is not covered");
            assert!(its.iter().any(|r| contains(r, beside)), "a point is not covered with padding");
        }
    }
    references.list().len()
}

/// Weights all over the triangle, its edges and corners among them.
fn weights() -> Vec<[f64; 2]> {
    let grid = (0..=16).flat_map(|i| (0..=16 - i).map(move |j| [f64::from(i) / 16.0, f64::from(j) / 16.0]));
    grid.collect()
}

#[test]
fn without_a_budget_each_triangle_is_whole() {
    let triangles = scattered(1000, 3);
    for budget in [0.0, -1.0, f32::NAN, 0.0009] {
        let references = split(&triangles, budget).unwrap();
        let mut references = references.list().to_vec();
        references.sort_by_key(|reference| reference.primitive);
        assert_eq!(references.len(), 1000);
        for (i, reference) in references.iter().enumerate() {
            assert_eq!(reference.primitive, i as u32);
            let own = (numbers(reference.bounds.least), numbers(reference.bounds.greatest));
            assert_eq!(own, triangles[i].bounds());
        }
    }
}

#[test]
fn slivers_are_split_and_covered() {
    let triangles = slivers(100);
    for budget in [0.05, 0.5, 4.0] {
        let references = check(&triangles, budget, &weights());
        assert!(references > 100, "{budget}");
    }
}

#[test]
fn a_triangle_across_a_mesh_is_split_and_cheaper() {
    let mut triangles = scattered(2000, 5);
    triangles.extend(mesh([[Vec3::NEG_ONE, Vec3::ONE, vec3(-1.0, 1.0, -0.9)]]));
    assert!(check(&triangles, 0.5, &weights()) > 2001);
    for quality in QUALITIES {
        let cost = |budget| {
            let bvh = build_and_check(&split(&triangles, budget).unwrap(), quality);
            Statistics::of(&bvh, &triangles)
        };
        let (whole, parts) = (cost(0.0), cost(0.5));
        assert!(parts.sah_cost < whole.sah_cost && parts.wide_sah_cost < whole.wide_sah_cost, "{quality:?}");
        assert_eq!((parts.primitives, whole.references), (2001, 2001));
        assert!(parts.references > 2001);
    }
}

#[test]
fn meshes_that_break_builders() {
    let meshes = [
        scattered(1, 1),
        scattered(2, 1),
        scattered(7, 1),
        duplicates(3),
        duplicates(5000),
        fan(2000),
        nested(3000),
        concentric(3000),
        collinear(3000),
        grid(40),
        shrinking(100, 20),
        mesh([[Vec3::NEG_ONE; 3], [Vec3::ONE; 3], [Vec3::NEG_ONE, Vec3::ONE, Vec3::NEG_ONE]]),
        mesh((0..500).map(|i| [Vec3::NEG_ONE, Vec3::ONE, vec3(1.0, i as f32 / 500.0, -1.0)])),
    ];
    for triangles in &meshes {
        for budget in [0.3, 2.0] {
            check(triangles, budget, &weights());
            build_and_check_all(&split(triangles, budget).unwrap());
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn random_triangles_are_covered(
        corners in vec(prop::array::uniform9(-1.0f32..=1.0), 1..60), weights in vec(prop::array::uniform2(0.0f64..=1.0), 40),
        budget in 0.0f32..4.0,
    ) {
        let at = |c: &[f32]| vec3(c[0], c[1], c[2]);
        let triangles = mesh(corners.iter().map(|c| [at(&c[..3]), at(&c[3..6]), at(&c[6..])]));
        check(&triangles, budget, &weights);
    }
}
