//! Spheres and disks by hand, and the coordinates on them.

use super::{Chord, Crossing, intersect_disk, intersect_sphere, octahedral, tangents, unit_of};
use crate::real::{F32xN, Fast, Lanes, Real, Scalar, V3};
use glam::{DVec3, Vec3};
use proptest::prelude::*;

const ROUNDOFF: f64 = <f32 as Real>::ROUNDOFF as f64;

fn v<R: Scalar>(x: f32, y: f32, z: f32) -> V3<R> {
    V3::splat(Vec3::new(x, y, z))
}

fn double(v: V3<f32>) -> DVec3 {
    Vec3::new(v.x, v.y, v.z).as_dvec3()
}

/// The chord of a ray along -z from the origin.
fn chord<R: Scalar>(centre: [f32; 3], radius: f32, length: f32) -> Chord<R> {
    let [x, y, z] = centre;
    intersect_sphere(v(x, y, z), R::splat(radius), v(0.0, 0.0, 0.0), v(0.0, 0.0, -length))
}

/// Do base, near and far have these values?
fn assert_chord<R: Scalar>(chord: Chord<R>, ends: [f32; 3]) {
    assert!(chord.meets);
    assert_eq!([chord.base, chord.near, chord.far].map(R::to_f32), ends);
}

fn chords<R: Scalar>() {
    assert_chord::<R>(chord([0.0, 0.0, -2.0], 1.0, 1.0), [2.0, -1.0, 1.0]);
    assert_chord::<R>(chord([0.0, 0.0, -2.0], 1.0, 2.0), [1.0, -0.5, 0.5]);
    // 3, 4, 5.
    assert_chord::<R>(chord([0.0, 0.75, -2.0], 1.25, 1.0), [2.0, -1.0, 1.0]);
    // From inside, from the centre and from the surface.
    assert_chord::<R>(chord([0.0, 0.0, -0.5], 1.0, 1.0), [0.5, -1.0, 1.0]);
    assert_chord::<R>(chord([0.0, 0.0, 0.0], 1.0, 1.0), [0.0, -1.0, 1.0]);
    assert_chord::<R>(chord([0.0, 0.0, -1.0], 1.0, 1.0), [1.0, -1.0, 1.0]);
    // Tangent: both ends in one place.
    assert_chord::<R>(chord([1.0, 0.0, -2.0], 1.0, 1.0), [2.0, 0.0, 0.0]);
    // Behind: the line meets it, at distances below zero.
    assert_chord::<R>(chord([0.0, 0.0, 2.0], 1.0, 1.0), [-2.0, -1.0, 1.0]);
    // Beside, by much and by little.
    assert!(!chord::<R>([0.0, 1.5, -2.0], 1.0, 1.0).meets);
    assert!(!chord::<R>([0.0, 1.0 + 1e-6, -2.0], 1.0, 1.0).meets);
}

#[test]
fn chords_by_hand() {
    chords::<f32>();
    chords::<Fast>();
    chords::<f64>();
}

/// Where the square of the distance has no digit of the radius left.
#[test]
fn a_small_sphere_far_away_has_its_chord() {
    let radius = 1.0 / (1 << 20) as f32;
    let beside = 0.6 * radius;
    let chord = chord::<f32>([beside, 0.0, -1.75], radius, 1.0);
    assert!(chord.meets && chord.base == 1.75);
    assert!((chord.far / radius - 0.8).abs() < 1e-6 && chord.near == -chord.far);
    // Half of it is below what the origin's coordinates resolve.
    let off = V3::new(0.5f32, 0.25, 1.75);
    let from_there = intersect_sphere(off + V3::new(0.0, 0.0, -1.75), radius, off, V3::new(0.0, 0.0, -1.0));
    assert_eq!((from_there.near, from_there.far), (-radius, radius));
}

/// A lane has the bits of its sphere alone where it meets, and meets where that does.
#[test]
fn lanes_have_the_chords_of_their_spheres() {
    let radius = |i: usize| 0.25 + 0.125 * i as f32;
    let centre = |i: usize| Vec3::new(0.1 * i as f32, 0.3, -1.3 - 0.01 * i as f32);
    let direction = v::<f32>(0.1, 0.2, -0.7);
    let together = intersect_sphere::<F32xN<4>>(
        V3::of_lanes(|i| V3::splat(centre(i))),
        F32xN(core::array::from_fn(radius)),
        V3::splat(Vec3::ZERO),
        V3::of_lanes(|_| direction),
    );
    let mut met = 0;
    for i in 0..4 {
        let (lane, alone) =
            (together.lane::<f32>(i), intersect_sphere(V3::splat(centre(i)), radius(i), V3::zero(), direction));
        assert_eq!(lane.meets, alone.meets);
        if lane.meets {
            met += 1;
            assert_eq!((lane.base, lane.near, lane.far), (alone.base, alone.near, alone.far));
        }
    }
    assert!(met > 1 && <F32xN<4> as Lanes<f32>>::COUNT == 4);
}

/// The crossing of a disk of radius 1/2 around the origin that faces +z.
fn crossing<R: Scalar>(origin: [f32; 3], direction: [f32; 3]) -> Crossing<R> {
    let [x, y, z] = origin;
    let [dx, dy, dz] = direction;
    intersect_disk((V3::zero(), v(0.0, 0.0, 1.0), R::splat(0.5)), v(x, y, z), v(dx, dy, dz))
}

fn crossings<R: Scalar>() {
    let front = crossing::<R>([0.25, 0.0, 1.0], [0.0, 0.0, -0.5]);
    assert!(front.meets && front.front);
    assert_eq!((front.t.to_f32(), front.place.x.to_f32()), (2.0, 0.25));
    let back = crossing::<R>([-0.25, 0.0, -1.0], [0.0, 0.0, 1.0]);
    assert!(back.meets && !back.front && back.t.to_f32() == 1.0);
    let slanted = crossing::<R>([0.75, 0.0, 0.5], [-0.75, 0.0, -0.5]);
    assert!(slanted.meets && slanted.t.to_f32() == 1.0 && slanted.place.x.to_f32() == 0.0);
    // The rim is a part of it.
    assert!(crossing::<R>([0.5, 0.0, 1.0], [0.0, 0.0, -1.0]).meets);
    assert!(!crossing::<R>([0.5001, 0.0, 1.0], [0.0, 0.0, -1.0]).meets);
    // Behind, the line meets it at a distance below zero; along its plane never.
    let behind = crossing::<R>([0.0, 0.0, 1.0], [0.0, 0.0, 1.0]);
    assert!(behind.meets && behind.t.to_f32() == -1.0);
    assert!(!crossing::<R>([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]).meets);
    assert!(!crossing::<R>([-1.0, 0.0, 0.25], [1.0, 0.0, 0.0]).meets);
}

#[test]
fn crossings_of_a_disk_by_hand() {
    crossings::<f32>();
    crossings::<Fast>();
    crossings::<f64>();
}

#[test]
fn octahedral_coordinates_by_hand() {
    let at = |x: f32, y: f32, z: f32| {
        let (u, v, scale) = octahedral(V3::new(x, y, z));
        (u / scale, v / scale)
    };
    assert_eq!((at(0.0, 0.0, 2.0), at(3.0, 0.0, 0.0), at(0.0, -1.0, 0.0)), ((0.0, 0.0), (1.0, 0.0), (0.0, -1.0)));
    assert_eq!((at(1.0, 1.0, 2.0), at(1.0, -1.0, -2.0)), ((0.25, 0.25), (0.75, -0.75)));
    for (u, v, unit) in [
        (0.0, 0.0, [0.0, 0.0, 1.0]),
        (0.0, -1.0, [0.0, -1.0, 0.0]),
        (1.0, 1.0, [0.0, 0.0, -1.0]),
        (-1.0, 1.0, [0.0, 0.0, -1.0]),
    ] {
        let there: V3<f32> = unit_of(u, v);
        assert_eq!([there.x, there.y, there.z], unit);
    }
}

/// A unit vector with parts as small as any.
fn direction() -> impl Strategy<Value = DVec3> {
    let part = || prop_oneof![4 => -1f64..1.0, 1 => Just(0.0), 1 => (-9f64..0.0).prop_map(|e| 10f64.powf(e))];
    (part(), part(), part())
        .prop_map(|(x, y, z)| DVec3::new(x, y, z))
        .prop_filter("a direction", |v| v.length() > 1e-9)
        .prop_map(DVec3::normalize)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200_000))]

    /// There and back: of unit length within 4 roundoffs, and within 16 of where it was.
    #[test]
    fn octahedral_coordinates_lead_back(unit in direction(), length in -20f64..1.0) {
        let vector = (unit * length.exp2()).as_vec3();
        let (u, w, scale) = octahedral(V3::<f32>::splat(vector));
        let scale = scale.reciprocal();
        let (u, w) = (u * scale, w * scale);
        prop_assert!(u.abs() <= 1.0 + 4.0 * f32::EPSILON && w.abs() <= 1.0 + 4.0 * f32::EPSILON);
        let back = double(unit_of(u, w));
        let error = (back - vector.as_dvec3().normalize()).length() / ROUNDOFF;
        prop_assert!(error <= 16.0, "{error}");
        prop_assert!((back.length() - 1.0).abs() <= 4.0 * ROUNDOFF);
    }

    /// Of unit length and at right angles within 8 roundoffs, whatever the normal; and coordinates are along them.
    #[test]
    fn tangents_are_at_right_angles(normal in direction()) {
        let n = normal.as_vec3();
        let [x, y] = tangents(V3::<f32>::splat(n)).map(double);
        let n = n.as_dvec3();
        for (a, b, want) in [(x, x, 1.0), (y, y, 1.0), (x, y, 0.0), (x, n, 0.0), (y, n, 0.0)] {
            let error = (a.dot(b) - want).abs() / ROUNDOFF;
            prop_assert!(error <= 8.0, "{error}");
        }
        // Counter-clockwise around the normal.
        prop_assert!((x.cross(y) - n).length() <= 16.0 * ROUNDOFF);
        let (u, v) = super::coordinates(V3::splat(n.as_vec3()), V3::<f32>::splat((x * 0.25 - y * 0.5).as_vec3()));
        prop_assert!((u - 0.25).abs() < 1e-6 && (v + 0.5).abs() < 1e-6);
    }
}
