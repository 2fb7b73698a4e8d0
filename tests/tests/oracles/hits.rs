//! The kernels' closest hits against exact arithmetic over every triangle.

use eyerays::cpu;
use eyerays::method::Method;
use eyerays::stream::{Answers, Question, Stream, StreamRay};
use eyerays_shader::geometry::intersect_watertight;
use eyerays_shader::ray::Ray;
use eyerays_shader::real::{Real, V3};
use eyerays_tests::count;
use eyerays_tests::numbers::Interval;
use eyerays_tests::numbers::exact::{self, Crossing, Sheared, nearest};
use glam::{UVec4, Vec3};
use rayon::prelude::*;

use super::corpus::{Case, cases};

/// Across a ray, a sheared vertex may lie so far from its place on both axes.
const EDGE: f64 = exact::SHEAR * std::f64::consts::SQRT_2;
/// Triangles that are further beside a ray are not asked: much more than an edge's bound and than double precision's
/// error, and no more than what saves time.
const BESIDE: f64 = 1e-4;

/// What was found of a case's rays.
#[derive(Debug, Default, Clone, Copy)]
struct Tally {
    rays: usize,
    /// The exact nearest triangle, or exactly nothing.
    right: usize,
    /// Another triangle, as far away as the nearest within both bounds.
    tied: usize,
    /// The nearest was missed within the bound of its edge, or what was hit was exactly missed within it.
    edge: usize,
    /// The greatest error of t over its bound.
    t_share: f64,
    /// The greatest relative error of t in roundoffs, where the ray is no flatter than 1 in 8.
    t_roundoffs: f64,
}

/// A triangle that a ray meets exactly, or nearly.
struct Near {
    primitive: u32,
    crossing: Crossing,
    sheared: Sheared,
}

impl Near {
    fn of(primitive: u32, triangle: [Vec3; 3], ray: &StreamRay) -> Option<Near> {
        let sheared = Sheared::new(triangle, ray.origin, ray.direction);
        for axis in 0..2 {
            let [a, b, c] = sheared.vertices.map(|p| p[axis]);
            if a.min(b).min(c) > BESIDE || a.max(b).max(c) < -BESIDE {
                return None;
            }
        }
        let crossing = exact::crossing(triangle, ray.origin, ray.direction)?;
        Some(Near { primitive, crossing, sheared })
    }

    fn t(&self) -> f64 {
        nearest(&self.crossing.t)
    }
}

/// Compares a ray's answer (its t and primitive, if any) with the truth.
fn judge(case: &Case, triangles: &[[Vec3; 3]], ray: &StreamRay, answer: Option<(f32, u32)>) -> Tally {
    let mut tally = Tally { rays: 1, ..Tally::default() };
    let near: Vec<Near> =
        triangles.iter().zip(0..).filter_map(|(&triangle, primitive)| Near::of(primitive, triangle, ray)).collect();
    let truth = near
        .iter()
        .filter(|n| n.crossing.meets)
        .min_by(|a, b| a.crossing.t.cmp(&b.crossing.t).then(a.primitive.cmp(&b.primitive)));
    let what = || format!("{}: {ray:?} answers {answer:?}", case.name);
    let Some((t, primitive)) = answer else {
        // Nothing that it meets well inside and well in front of its origin may be missed.
        for missed in near.iter().filter(|n| n.crossing.meets && n.t() > n.sheared.t_error()) {
            let inside = missed.sheared.depth_inside();
            assert!(inside <= EDGE, "{}, but meets {} by {inside:e} inside", what(), missed.primitive);
        }
        *(if truth.is_none() { &mut tally.right } else { &mut tally.edge }) += 1;
        return tally;
    };
    let Some(hit) = near.iter().find(|n| n.primitive == primitive) else {
        // A triangle seen exactly edge-on has no crossing; the sheared one had.
        let inside = Sheared::new(triangles[primitive as usize], ray.origin, ray.direction).depth_inside();
        assert!(inside == 0.0, "{}, which it is far from", what());
        tally.edge += 1;
        return tally;
    };
    let (error, bound) = ((f64::from(t) - hit.t()).abs(), hit.sheared.t_error());
    assert!(error <= bound, "{}, but t is {}, off by {error:e} of {bound:e}", what(), hit.t());
    assert!(hit.sheared.depth_inside() >= -EDGE, "{}, {:e} outside", what(), -hit.sheared.depth_inside());
    tally.t_share = if bound.is_finite() { error / bound } else { 0.0 };
    let flat = hit.sheared.t_error() * hit.sheared.major.abs() > 9.0 * exact::SHEAR;
    tally.t_roundoffs = if flat { 0.0 } else { error / f64::from(t) / exact::ROUNDOFF };
    for nearer in near.iter().filter(|n| n.crossing.meets && n.t() > n.sheared.t_error()) {
        let passed = nearer.t() + nearer.sheared.t_error() < f64::from(t);
        let inside = nearer.sheared.depth_inside();
        assert!(!passed || inside <= EDGE, "{}, past {} by {inside:e} inside", what(), nearer.primitive);
    }
    match truth {
        Some(truth) if truth.primitive == primitive => tally.right += 1,
        Some(truth) if hit.crossing.meets && (truth.t() - hit.t()).abs() <= bound + truth.sheared.t_error() => {
            tally.tied += 1;
        }
        _ => tally.edge += 1,
    }
    tally
}

/// The t and primitive of each ray's closest hit in exact precision.
fn answers(case: &Case, method: Method) -> Vec<Option<(f32, u32)>> {
    let stream = Stream::new(case.rays.iter().copied());
    let (answers, _) = cpu::cast(&case.packed, method.into(), 0, &stream, Question::Closest).unwrap();
    let Answers::Closest(hits) = answers else { unreachable!("closest hits were asked for") };
    let slot = |hit: UVec4| case.packed.primitives().get(hit.w as usize).map(|t| (f32::from_bits(hit.x), t.number()));
    hits.into_iter().map(slot).collect()
}

/// By both methods that `auto` takes.
#[test]
fn closest_hits_are_exact_within_their_bounds() {
    println!(
        "scene, rays, exact nearest, ties within bounds, edges within bounds, t error / bound, t error in roundoffs"
    );
    for case in cases(count::of(2_000, 200_000)) {
        let (triangles, answers) = (case.triangles(), [Method::Packet, Method::Wide].map(|m| answers(&case, m)));
        assert!(answers[0] == answers[1], "{}", case.name);
        let tally = (case.rays.par_iter().zip(&answers[0]))
            .map(|(ray, answer)| judge(&case, &triangles, ray, *answer))
            .reduce(Tally::default, Tally::and);
        let Tally { rays, right, tied, edge, t_share, t_roundoffs } = tally;
        println!("{}, {rays}, {right}, {tied}, {edge}, {t_share:.3}, {t_roundoffs:.2}", case.name);
        assert_eq!(rays, right + tied + edge);
        assert!(right * 10 >= rays * 6, "{tally:?}: most rays are no special cases");
    }
}

impl Tally {
    fn and(self, other: Tally) -> Tally {
        Tally {
            rays: self.rays + other.rays,
            right: self.right + other.right,
            tied: self.tied + other.tied,
            edge: self.edge + other.edge,
            t_share: self.t_share.max(other.t_share),
            t_roundoffs: self.t_roundoffs.max(other.t_roundoffs),
        }
    }
}

/// Intervals through the kernels' own triangle test: the exact t and weights lie between the bounds, and the value is
/// what `f32` computes.
#[test]
fn intervals_hold_exact_crossings() {
    let (mut crossings, mut rng) = (0, fastrand::Rng::with_seed(5));
    for case in cases(count::of(3_000, 100_000)) {
        let triangles = case.triangles();
        for (i, ray) in case.rays.iter().enumerate() {
            // From where the ray starts to anywhere in a triangle, or a little beside it.
            let triangle = triangles[i * 7919 % triangles.len()];
            let [a, b, c] = triangle;
            let (s, t) = (rng.f32() * 1.02 - 0.01, rng.f32());
            let ray = &StreamRay { direction: a + (b - a) * s + (c - a) * (1.0 - s) * t - ray.origin, ..*ray };
            let Some(exact) = exact::crossing(triangle, ray.origin, ray.direction) else { continue };
            let (got, alone) = (crossed::<Interval>(triangle, ray), crossed::<f32>(triangle, ray));
            assert_eq!((got.depth.value, got.u.value, got.area.value), (alone.depth, alone.u, alone.area));
            if !got.inside {
                continue; // The kernel goes no further beside a triangle.
            }
            let what = format!("{}: {ray:?} and {triangle:?}", case.name);
            assert!(got.depth.div(got.area).contains(nearest(&exact.t)), "{what}: t");
            assert!(got.u.div(got.area).contains(nearest(&exact.weights[0])), "{what}: u");
            assert!(got.v.div(got.area).contains(nearest(&exact.weights[1])), "{what}: v");
            crossings += 1;
        }
    }
    println!("{crossings} crossings lie between their intervals' bounds");
    assert!(crossings > 10_000);
}

/// Crosses a triangle with a ray by the kernels' own test.
pub fn crossed<R: Real>(triangle: [Vec3; 3], ray: &StreamRay) -> eyerays_shader::geometry::Candidate<R> {
    let ray = Ray::<R>::new(V3::splat(ray.origin), V3::splat(ray.direction));
    let [a, b, c] = triangle.map(|p| ray.seen(p));
    intersect_watertight(a, b, c, ray.slopes(), ray.along())
}
