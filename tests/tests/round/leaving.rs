//! Rays that leave spheres and disks: outwards they do not meet them again, inwards they meet the far side once.

use eyerays_shader::data::Primitive;
use eyerays_shader::geometry::SurfaceInteraction;
use eyerays_shader::ray::{Hit, Ray};
use eyerays_shader::real::{Fast, Real, Scalar, V3};
use eyerays_shader::traverse::{Closest, Occlusion, leaf};
use eyerays_tests::bare::{Bare, prepared};
use eyerays_tests::count;
use fastrand::Rng;
use glam::{DVec3, Vec3};

use super::draw::{From, across, power, sign, unit};
use super::tallied;

/// Rays that leave, and what became of them.
#[derive(Debug, Default, Clone, Copy)]
struct Tally {
    outwards: usize,
    /// Met what they leave outwards.
    returned: usize,
    inwards: usize,
    /// Did not meet the far side.
    lost: usize,
    /// Met it at another place than the chord's end, or before its start.
    astray: usize,
}

impl Tally {
    fn and(self, other: Tally) -> Tally {
        Tally {
            outwards: self.outwards + other.outwards,
            returned: self.returned + other.returned,
            inwards: self.inwards + other.inwards,
            lost: self.lost + other.lost,
            astray: self.astray + other.astray,
        }
    }
}

fn place<R: Scalar>(v: V3<R>) -> DVec3 {
    DVec3::new(f64::from(v.x.to_f32()), f64::from(v.y.to_f32()), f64::from(v.z.to_f32()))
}

/// A direction at an angle to a plane of 1e-8 to 1 on either side, or any.
fn way_out(normal: DVec3, rng: &mut Rng) -> Vec3 {
    let way = if rng.bool() {
        unit(rng)
    } else {
        let flat = if rng.u32(0..8) == 0 { 1e-6 } else { power(rng, -8.0, 0.0) };
        across(normal, rng) + normal * sign(rng) * flat
    };
    way.normalize().as_vec3()
}

/// Hits something and leaves from there `count` times.
fn leave<R: Scalar>(is_disk: bool, count: usize, rng: &mut Rng) -> Tally {
    // A place of double precision is not known so well as it is met.
    let is_single = R::ROUNDOFF.to_f32() == f32::ROUNDOFF;
    let mut tally = Tally::default();
    let from = From::ALL[rng.usize(0..From::ALL.len())];
    let drawn = from.draw(rng);
    let (centre, radius) = (drawn.centre, drawn.radius);
    let primitive = if is_disk {
        Primitive::disk(centre, unit(rng).as_vec3(), radius, 7, 0, 0)
    } else {
        Primitive::sphere(centre, radius, 7, 0, 0)
    };
    let bare = Bare::new(vec![primitive]);
    let ray = prepared::<R>(&drawn.ray);
    let hit = bare.hit::<Closest, R>(&ray, f32::MAX);
    if hit.primitive == Hit::<R>::NOTHING {
        return tally;
    }
    let at = SurfaceInteraction::new(bare.effects, &primitive, hit.coordinates(), ray.direction);
    for _ in 0..count {
        let out = V3::<R>::splat(way_out(place(at.normal), rng)).normalised().0;
        let source = at.source_primitive(out);
        for start in [at.offset_ray_origin(out), at.offset_ray_origin_along(out)] {
            let leaving = Ray::<R>::leaving(source, start, out);
            let again = bare.hit::<Closest, R>(&leaving, f32::MAX);
            let is_met = again.primitive != Hit::<R>::NOTHING;
            let is_dark = leaf::occluded(&bare.hit::<Occlusion, R>(&leaving, f32::MAX));
            if source & Ray::<R>::INSIDE == 0 {
                tally.outwards += 1;
                tally.returned += usize::from(is_met || is_dark);
                continue;
            }
            tally.inwards += 1;
            tally.lost += usize::from(!is_met || !is_dark);
            // From the start to the end of its chord, as the exact sphere has it.
            let (from, way) = (place(start) - centre.as_dvec3(), place(out));
            let (along, r) = (from.dot(way), f64::from(radius));
            let half = (r * r - from.cross(way).length_squared()).max(0.0).sqrt();
            let (t, end) = (f64::from(again.t.to_f32()), half - along);
            // A start is off the surface by an eighth of the radius at most, and so is what a chord's end is off by.
            let error = (t - end.max(0.0)).abs();
            tally.astray += usize::from(is_met && is_single && !(t >= 0.0 && error <= 1e-3 * r + 1e-6));
        }
    }
    tally
}

fn assert_leaving<R: Scalar>(what: &str, is_disk: bool) {
    let each = 16;
    let starts = count::of(4_000, 2_000_000 / each);
    let tally = tallied(usize::from(is_disk), starts, Tally::default, |rng| leave::<R>(is_disk, each, rng), Tally::and);
    let Tally { outwards, returned, inwards, lost, astray } = tally;
    println!("{what}: {returned} of {outwards} outwards return, {lost} of {inwards} inwards are lost, {astray} astray");
    assert!(returned == 0 && lost == 0 && astray == 0, "{what}: {tally:?}");
    assert!(outwards > starts && (is_disk || inwards > starts));
}

/// Every way, at angles from 1e-8 on.
#[test]
fn rays_that_leave_a_sphere_meet_its_far_side_inwards_and_nothing_outwards() {
    assert_leaving::<f32>("spheres, exact", false);
    assert_leaving::<Fast>("spheres, fast", false);
    assert_leaving::<f64>("spheres, reference", false);
}

#[test]
fn rays_that_leave_a_disk_do_not_return() {
    assert_leaving::<f32>("disks, exact", true);
    assert_leaving::<Fast>("disks, fast", true);
    assert_leaving::<f64>("disks, reference", true);
}
