//! Rays against spheres by exact arithmetic: hit or miss, and where.

use eyerays_shader::data::Primitive;
use eyerays_tests::count;
use eyerays_tests::numbers::exact::ROUNDOFF;
use eyerays_tests::numbers::round::Passage;
use fastrand::Rng;

use super::draw::{Drawn, From};
use super::tallied;
use super::tally::{Answer, FLUSHED, Tally};

/// What half a chord's square may be off by; see `geometry::sphere`.
fn square_error(radius: f64) -> f64 {
    16.0 * ROUNDOFF * radius * radius
}

/// What a root may be off by: what the square's error makes of half the chord, and some roundoffs.
fn root_error(passage: &Passage, radius: f64, root: f64) -> f64 {
    let (error, half) = (square_error(radius), passage.half(0.0));
    let of_chord = (passage.half(error) - half).max(half - passage.half(-error));
    of_chord + 2.0 * ROUNDOFF * (root.abs() + radius / passage.length) + FLUSHED / passage.length
}

fn judge(case: From, rng: &mut Rng) -> Tally {
    let drawn = case.draw(rng);
    let Drawn { centre, radius, ray } = drawn;
    let Answer { is_hit, t, direction } = Answer::of(Primitive::sphere(centre, radius, 0, 0, 0), &drawn);
    let (passage, r) = (Passage::of(centre, radius, ray.origin, direction), f64::from(radius));
    let what = || format!("{case:?}: {centre} {radius}, {ray:?}: {passage:?}, {:?}", (is_hit, t));
    let (half, error) = (passage.half(0.0), square_error(r));
    let roots = [passage.middle - half, passage.middle + half];
    let errors = roots.map(|root| root_error(&passage, r, root));
    let mut tally = Tally { rays: 1, hits: usize::from(is_hit), ..Tally::default() };
    if is_hit != (passage.square >= 0.0 && roots[1] > 0.0) {
        tally.wrong = 1;
        // An end at the origin itself is ahead or behind.
        if !roots.iter().zip(errors).any(|(root, error)| root.abs() <= error) {
            tally.wrong_share = passage.square.abs() / error;
            assert!(tally.wrong_share <= 1.0, "{}", what());
        }
    }
    if !is_hit {
        return tally;
    }
    // The near end is met unless it is behind; where it may be either, either is met.
    let ends = [roots[0] >= -errors[0], roots[0] <= errors[0]];
    let off = |end: usize| if ends[end] { (t - roots[end]).abs() / errors[end] } else { f64::INFINITY };
    tally.t_share = off(0).min(off(1));
    assert!(tally.t_share <= 1.0, "{}: {tally:?}, {roots:?} {errors:?}", what());
    // How far from the surface the place at t is.
    let along = (t - passage.middle) * passage.length;
    let distance = (along * along + r * r - passage.square).max(0.0).sqrt();
    tally.off_share = (distance - r).abs() / (8.0 * ROUNDOFF * r + ROUNDOFF * t * passage.length + FLUSHED);
    assert!(tally.off_share <= 1.0, "{}: {tally:?}", what());
    tally
}

/// Of radii from 1e-6 to 1 of the scene, from everywhere, as `geometry::sphere` states.
#[test]
fn hits_of_spheres_are_exact_within_their_bounds() {
    println!("from, rays, hits, wrong, greatest square of a wrong chord / bound, t error / bound, place off / bound");
    for (number, case) in From::ALL.into_iter().enumerate() {
        let rays = count::of(50_000, 10_000_000);
        let Tally { rays, hits, wrong, wrong_share, t_share, off_share, .. } =
            tallied(number, rays, Tally::default, |rng| judge(case, rng), Tally::and);
        println!("{case:?}, {rays}, {hits}, {wrong}, {wrong_share:.3}, {t_share:.3}, {off_share:.3}");
        assert!(hits * 4 > rays, "{case:?}: {hits} of {rays}");
    }
}
