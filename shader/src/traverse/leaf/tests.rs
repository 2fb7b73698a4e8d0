//! Which end of a chord counts, and which side of what.

use super::{Leaf, Primitives, disk, occluded, sphere};
use crate::bvh8::Bvh8View;
use crate::data::{Effects, Frame, Primitive, Specialisation};
use crate::ray::{Hit, Ray};
use crate::real::{Fast, Real, Scalar, V3};
use crate::scene::{LaunchContext, TraceContext};
use crate::traverse::tests::cases;
use crate::traverse::{Closest, Occlusion, Query};
use bytemuck::Zeroable;
use glam::Vec3;
use proptest::prelude::*;

/// The hit of a ray among primitives under these effects and those of spheres and disks.
fn hit<Q: Query, R: Scalar>(primitives: &[Primitive], effects: u32, ray: &Ray<R>) -> Hit<R> {
    let frame = Frame::zeroed();
    let effects = Effects(effects | Effects::SPHERE | Effects::DISK);
    let spec = Specialisation { effects, ..Specialisation::default() };
    let context = TraceContext {
        base: LaunchContext::new(&frame, spec, bytemuck::cast_slice(primitives), &[]),
        nodes: &[],
        wide: &[],
        bvh8: Bvh8View::default(),
        cutout: Default::default(),
    };
    let mut hit = Hit::none(R::splat(f32::MAX));
    for index in 0..primitives.len() as u32 {
        Primitives::intersect::<Q, R>(&context, (index, u32::MAX), ray, &mut hit);
    }
    hit
}

fn leaving<R: Scalar>(source: u32, origin: [f32; 3], direction: [f32; 3]) -> Ray<R> {
    Ray::leaving(R::index(source), V3::splat(Vec3::from(origin)), V3::splat(Vec3::from(direction)))
}

/// Where a ray meets the ball of radius 1/2 and number 3 around the origin.
fn ball<R: Scalar>(source: u32, origin: [f32; 3], direction: [f32; 3]) -> Option<f32> {
    let ball = Primitive::sphere(Vec3::ZERO, 0.5, 3, 0, 0);
    let hit = hit::<Closest, R>(&[ball], 0, &leaving::<R>(source, origin, direction));
    (hit.primitive == 3).then(|| hit.t.to_f32())
}

const NOWHERE: u32 = Hit::<f32>::NOTHING;
const INSIDE: u32 = 3 | Ray::<f32>::INSIDE;

fn ends<R: Scalar>() {
    let right = [1.0, 0.0, 0.0];
    assert_eq!(ball::<R>(NOWHERE, [-1.0, 0.0, 0.0], right), Some(0.5), "the near end from outside");
    assert_eq!(ball::<R>(NOWHERE, [-0.25, 0.0, 0.0], right), Some(0.75), "the far one from inside");
    assert_eq!(ball::<R>(NOWHERE, [-0.5, 0.0, 0.0], right), Some(1.0), "the far one from the surface");
    assert_eq!(ball::<R>(NOWHERE, [0.75, 0.0, 0.0], right), None, "none that is behind");
    assert_eq!(ball::<R>(NOWHERE, [-1.0, 0.5, 0.0], right), Some(1.0), "where it is tangent");
    assert_eq!(ball::<R>(NOWHERE, [-1.0, 0.625, 0.0], right), None, "none beside");
    // It starts on the ball itself.
    assert_eq!(ball::<R>(3, [0.5, 0.0, 0.0], right), None);
    assert_eq!(ball::<R>(3, [0.5, 0.0, 0.0], [0.0, 1.0, 0.0]), None);
    assert_eq!(ball::<R>(INSIDE, [-0.5, 0.0, 0.0], right), Some(1.0));
    assert_eq!(ball::<R>(2, [-1.0, 0.0, 0.0], right), Some(0.5), "what starts on another meets it as any");
    assert_eq!(ball::<R>(2 | Ray::<R>::INSIDE, [-1.0, 0.0, 0.0], right), Some(0.5));
}

#[test]
fn the_nearest_end_ahead_is_met() {
    ends::<f32>();
    ends::<Fast>();
    ends::<f64>();
}

/// Rounding may lose the chord of a ray that goes inside, but not its end: half a chord's square is off by up to 16 roundoffs
/// of the radius' square.
#[test]
fn a_ray_that_goes_inside_meets_the_far_side_however_flat() {
    let off = 16.0 * f32::ROUNDOFF * 0.25;
    for flat in [1e-2f32, 1e-4, 1e-6, 1e-8, 0.0, -1e-8, -1e-6] {
        let t = ball::<f32>(INSIDE, [-0.5, 0.0, 0.0], [flat, 1.0, 0.0]).expect("it leaves again");
        let half = (0.5 * flat / (1.0 + flat * flat)).max(0.0);
        let error = (half * half + off).sqrt() - half + 1e-7;
        assert!(t >= 0.0 && (t - 2.0 * half).abs() <= error, "{flat}: {t}");
    }
}

#[test]
fn culling_hides_insides_and_backs_but_not_those_of_glass_or_of_two_sides() {
    let of =
        |flags| [Primitive::sphere(Vec3::ZERO, 0.5, 0, 0, flags), Primitive::disk(Vec3::X, Vec3::X, 0.5, 1, 0, flags)];
    let right = leaving::<f32>(NOWHERE, [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
    let back = leaving::<f32>(NOWHERE, [2.0, 0.0, 0.0], [-1.0, 0.0, 0.0]);
    let seen = |flags, effects, ray| hit::<Closest, f32>(&of(flags), effects, ray).primitive;
    assert_eq!((seen(0, 0, &right), seen(0, 0, &back)), (0, 1));
    assert_eq!((seen(0, Effects::CULLING, &right), seen(0, Effects::CULLING, &back)), (NOWHERE, 1));
    let clear = |ray| seen(Primitive::TRANSPARENT, Effects::CULLING | Effects::TRANSPARENT, ray);
    assert_eq!((clear(&right), clear(&back)), (0, 1));
    let two_sided = |ray| seen(Primitive::TWO_SIDED, Effects::CULLING, ray);
    assert_eq!((two_sided(&right), two_sided(&back)), (0, 1));
    let disk = |effects, ray| hit::<Closest, f32>(&of(0)[1..], effects, ray).primitive;
    assert_eq!((disk(0, &right), disk(Effects::CULLING, &right), disk(Effects::CULLING, &back)), (1, NOWHERE, 1));
}

#[test]
fn opaque_spheres_and_disks_cast_shadows_from_both_sides() {
    let of =
        |flags| [Primitive::sphere(Vec3::ZERO, 0.5, 0, 0, flags), Primitive::disk(Vec3::X, Vec3::X, 0.5, 1, 0, flags)];
    let effects = Effects::CULLING | Effects::TRANSPARENT;
    let dark = |primitive: Primitive, x: f32, to: f32| {
        occluded(&hit::<Occlusion, f32>(&[primitive], effects, &leaving(NOWHERE, [x, 0.0, 0.0], [to, 0.0, 0.0])))
    };
    for (i, from, to) in [(0, 2.0, -1.0), (0, 0.0, 1.0), (0, -2.0, 1.0), (1, 2.0, -1.0), (1, 0.0, 1.0)] {
        assert!(dark(of(0)[i], from, to), "{i} from {from}");
        assert!(!dark(of(Primitive::TRANSPARENT)[i], from, to), "{i} of glass from {from}");
        assert!(!dark(of(0)[i], from.signum() * 3.0, from.signum()), "{i} is behind");
    }
}

#[test]
fn a_disk_is_not_met_again_by_what_leaves_it() {
    let disk = Primitive::disk(Vec3::ZERO, Vec3::Z, 0.5, 3, 0, 0);
    for (height, down) in [(1e-7, -1.0), (-1e-7, 1.0), (1e-7, -1e-6)] {
        let t =
            |source| hit::<Closest, f32>(&[disk], 0, &leaving(source, [0.1, 0.0, height], [0.1, 0.2, down])).primitive;
        assert_eq!((t(NOWHERE), t(3), t(4)), (3, NOWHERE, 3), "{height} {down}");
    }
}

/// A touching disk and spheres that are one: the least number is met.
#[test]
fn ties_go_to_the_least_number_in_any_order() {
    let disk = |number| Primitive::disk(Vec3::new(0.0, 0.0, 0.5), Vec3::Z, 0.25, number, 0, 0);
    let ball = |number| Primitive::sphere(Vec3::ZERO, 0.5, number, 0, 0);
    let down = leaving::<f32>(NOWHERE, [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]);
    let first = |all: &[Primitive]| hit::<Closest, f32>(all, 0, &down).primitive;
    assert_eq!(first(&[disk(5), ball(3), ball(4)]), 3);
    assert_eq!(first(&[ball(4), disk(2), ball(3)]), 2);
    assert_eq!(first(&[ball(4), ball(6), ball(3)]), 3);
}

fn point(size: f32) -> impl Strategy<Value = [f32; 3]> {
    prop::array::uniform3(-size..size)
}

proptest! {
    #![proptest_config(cases(50_000))]

    /// What a GPU computes anew has the bits that a CPU kept with the hit.
    #[test]
    fn recomputed_coordinates_are_those_of_the_hit(
        origin in point(1.0), centre in point(0.5), normal in point(1.0), radius in 0.01f32..0.5, aside in point(0.4),
        source in prop_oneof![Just(NOWHERE), Just(INSIDE)],
    ) {
        let normal = Vec3::from(normal).normalize_or(Vec3::Z);
        let towards = Vec3::from(centre) + Vec3::from(aside) * radius - Vec3::from(origin);
        let ray = leaving::<f32>(source, origin, towards.to_array());
        let ball = Primitive::sphere(Vec3::from(centre), radius, 3, 0, 0);
        let found = hit::<Closest, f32>(&[ball], 0, &ray);
        if found.primitive == 3 {
            prop_assert_eq!(found.coordinates(), sphere::coordinates(&ball, &ray));
        }
        let plate = Primitive::disk(Vec3::from(centre), normal, radius, 2, 0, 0);
        let found = hit::<Closest, f32>(&[plate], 0, &ray);
        if found.primitive == 2 {
            let (u, v) = found.coordinates();
            prop_assert_eq!((u, v), disk::coordinates(&plate, &ray));
            prop_assert!(u * u + v * v <= 1.0 + 1e-5, "inside of it");
        }
    }
}
