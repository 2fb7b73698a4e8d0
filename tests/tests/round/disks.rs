//! Rays against disks by exact arithmetic: hit or miss, and where.

use eyerays_shader::data::Primitive;
use eyerays_tests::count;
use eyerays_tests::numbers::exact::ROUNDOFF;
use eyerays_tests::numbers::round::Crossing;
use fastrand::Rng;
use glam::{DVec3, Vec3};

use super::draw::{Drawn, From, across, cube, power, sign, towards_at, unit};
use super::tallied;
use super::tally::{Answer, FLUSHED, Tally};

/// From where a ray comes.
#[derive(Clone, Copy, Debug)]
enum At {
    /// Anywhere in the scene, to anywhere around the disk.
    Inside,
    /// The same, to the rim.
    Rim,
    /// Along the disk's plane but for a small angle.
    Grazing,
}

/// A disk, and a ray in its scene.
fn draw(case: At, rng: &mut Rng) -> (Drawn, Vec3) {
    let drawn = From::Outside.draw(rng);
    let axis = [DVec3::X, DVec3::NEG_Y, DVec3::Z][rng.usize(0..3)];
    let normal = if rng.u32(0..8) == 0 { axis } else { unit(rng) };
    let (c, r) = (drawn.centre.as_dvec3(), f64::from(drawn.radius));
    let in_plane = across(normal, rng);
    let target = match case {
        At::Inside | At::Grazing => c + in_plane * r * rng.f64() * 1.2,
        At::Rim => c + in_plane * r * (1.0 + sign(rng) * power(rng, -9.0, -2.0)),
    };
    let back = match case {
        At::Grazing => across(normal, rng) + normal * sign(rng) * power(rng, -6.0, -1.0),
        At::Inside | At::Rim => cube(rng),
    };
    let origin = (target + back * power(rng, -5.0, 0.0)).clamp(DVec3::NEG_ONE, DVec3::ONE).as_vec3();
    let ray = towards_at(origin, target - origin.as_dvec3(), rng);
    (Drawn { ray, ..drawn }, normal.as_vec3())
}

fn judge(case: At, rng: &mut Rng) -> Tally {
    let (drawn, normal) = draw(case, rng);
    let Drawn { centre, radius, ray } = drawn;
    let Answer { is_hit, t, direction } = Answer::of(Primitive::disk(centre, normal, radius, 0, 0, 0), &drawn);
    let flat = Tally { rays: 1, flat: 1, ..Tally::default() };
    let Some(crossing) = Crossing::of(centre, normal, ray.origin, direction) else { return flat };
    if crossing.slope <= 16.0 * ROUNDOFF {
        return flat;
    }
    let what = || format!("{case:?}: {centre} {normal} {radius}, {ray:?}: {crossing:?}, {:?}", (is_hit, t));
    let r = f64::from(radius);
    let way = crossing.way.max(crossing.t.abs() * crossing.length);
    let across = 8.0 * ROUNDOFF * way + FLUSHED;
    let along = across / crossing.slope;
    let mut tally = Tally { rays: 1, hits: usize::from(is_hit), ..Tally::default() };
    if is_hit != (crossing.from_centre <= r && crossing.t > 0.0) {
        tally.wrong = 1;
        if crossing.t.abs() * crossing.length > along {
            tally.wrong_share = (crossing.from_centre - r).abs() / (along + 4.0 * ROUNDOFF * r);
            assert!(tally.wrong_share <= 1.0, "{}", what());
        }
    }
    if is_hit {
        tally.t_share = (t - crossing.t).abs() * crossing.length / along;
        assert!(tally.t_share <= 1.0, "{}: {tally:?}", what());
    }
    tally
}

/// Of radii from 1e-6 to 1 of the scene, as `geometry::disk` states.
#[test]
fn hits_of_disks_are_exact_within_their_bounds() {
    println!(
        "from, rays, hits, too flat, wrong, greatest distance of a wrong one from the rim / bound, t error / bound"
    );
    for (number, case) in [At::Inside, At::Rim, At::Grazing].into_iter().enumerate() {
        let rays = count::of(50_000, 10_000_000);
        let Tally { rays, hits, flat, wrong, wrong_share, t_share, .. } =
            tallied(number, rays, Tally::default, |rng| judge(case, rng), Tally::and);
        println!("{case:?}, {rays}, {hits}, {flat}, {wrong}, {wrong_share:.3}, {t_share:.3}");
        assert!(hits * 4 > rays, "{case:?}: {hits} of {rays}");
    }
}
