//! Strands whose surfaces are known.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};

use super::super::frame::Frame;
use super::super::stations::Station;
use super::*;

fn area(mesh: &Mesh) -> f64 {
    corners(mesh).map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length()).sum()
}

fn volume(mesh: &Mesh) -> f64 {
    corners(mesh).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

/// Four Bezier arcs, which are a circle but for 2.8e-4 of its radius (Riškus, Approximation of a cubic Bezier curve by circular arcs, 2006).
fn ring(radius: f64, thick: f64) -> Vec<ControlPoint> {
    let handle = 0.551_784_777_791_315 * radius;
    let quarter = |number: usize| {
        let turn = |x: f64, y: f64| match number % 4 {
            0 => DVec3::new(x, y, 0.0),
            1 => DVec3::new(-y, x, 0.0),
            2 => DVec3::new(-x, -y, 0.0),
            _ => DVec3::new(y, -x, 0.0),
        };
        [turn(radius, 0.0), turn(radius, handle), turn(handle, radius)]
    };
    let all = (0..4).flat_map(quarter).chain([DVec3::X * radius]);
    all.map(|place| point(place, thick)).collect()
}

#[test]
fn a_b_spline_is_the_strand_of_bezier_curves_with_its_converted_points() {
    let of = |x: f64, y: f64, z: f64| point(DVec3::new(x, y, z), 0.75);
    // Multiples of six, so that converted points are whole numbers: those between two lie at thirds, and where curves meet in the middle.
    let spline =
        [of(0.0, 0.0, 0.0), of(6.0, 12.0, 0.0), of(18.0, 6.0, 6.0), of(24.0, -12.0, 12.0), of(30.0, 0.0, -6.0)];
    let bezier = [
        of(7.0, 9.0, 1.0),
        of(10.0, 10.0, 2.0),
        of(14.0, 8.0, 4.0),
        of(17.0, 4.0, 6.0),
        of(20.0, 0.0, 8.0),
        of(22.0, -6.0, 10.0),
        of(24.0, -7.0, 8.0),
    ];
    let (spline, bezier) = (mesh(&round(Basis::BSpline, 0.01), &spline), mesh(&round(Basis::Bezier, 0.01), &bezier));
    assert!(spline.triangles == bezier.triangles);
    assert!(spline.triangles.len() > 1000);
    let near = |(a, b): (&Vec3, &Vec3)| a.abs_diff_eq(*b, 1e-5);
    assert!(spline.positions.iter().zip(&bezier.positions).all(near));
    assert!(spline.normals.iter().zip(&bezier.normals).all(near));
}

#[test]
fn a_straight_strand_is_a_cylinder_and_one_that_gets_thinner_a_cone() {
    let (radius, height) = (0.5, 3.0);
    let line: Vec<_> = (0..4).map(|k| point(DVec3::new(1.0, f64::from(k), 2.0), radius)).collect();
    for tolerance in [0.05f32, 0.01, 0.001] {
        for basis in [Basis::Bezier, Basis::CatmullRom, Basis::Linear] {
            let tube = mesh(&round(basis, tolerance), &line);
            let (side, end) = (TAU * radius * height, PI * radius * radius);
            let most = f64::from(tolerance) * (side + 2.0 * end);
            assert!((volume(&tube) - end * height).abs() < most, "{basis} {tolerance}");
            assert!((area(&tube) - side - 2.0 * end).abs() < most / radius, "{basis} {tolerance}");
            assert_closed(&tube);
        }
    }
    let sides = |sides| Curves { sides: Some(sides), ..round(Basis::Bezier, 0.1) };
    let section = 0.5 * 7.0 * (TAU / 7.0).sin() * radius * radius;
    let prism = mesh(&sides(7), &line);
    assert!((volume(&prism) - section * height).abs() < 1e-6);
    assert_eq!((prism.triangles.len(), prism.positions.len()), (2 * 7 + 2 * 5, 2 * 7 + 2 * 7));
    let cone = [point(DVec3::ZERO, radius), point(DVec3::Y * height, 0.0)];
    let cone = mesh(&Curves { basis: Basis::Linear, ..sides(7) }, &cone);
    assert!((volume(&cone) - section * height / 3.0).abs() < 1e-6);
    assert_eq!(cone.triangles.len(), 7 + 5);
    assert_closed(&cone);
    // A cone's normals lean by its slope.
    let wanted = 0.5 / (0.25f64 + 9.0).sqrt();
    assert!(cone.normals[..7].iter().all(|normal| (f64::from(normal.y) - wanted).abs() < 1e-6));
}

#[test]
fn a_ring_has_the_area_and_the_volume_of_a_torus() {
    let (radius, thick) = (2.0, 0.4);
    for tolerance in [0.04, 0.01, 0.002] {
        let tube = mesh(&round(Basis::Bezier, tolerance as f32), &ring(radius, thick));
        let (side, end) = (TAU * radius * TAU * thick, PI * thick * thick);
        // Its ends are closed, and face each other.
        let (area, volume) = (area(&tube) - 2.0 * end, volume(&tube));
        assert!(
            (volume - TAU * radius * end).abs() < (2.0 * tolerance + 3e-4 * radius) * side,
            "{tolerance}: {volume}"
        );
        assert!((area - side).abs() < 2.0 * (2.0 * tolerance + 3e-4 * radius) / thick * side, "{tolerance}: {area}");
    }
}

#[test]
fn linear_strands_have_their_points_and_no_others_and_corners_are_round() {
    let bent: Vec<_> = (0..9).map(|k| point(DVec3::new(f64::from(k), 0.1 * f64::from(k % 3), 0.0), 0.25)).collect();
    let tube = mesh(&Curves { sides: Some(6), ..round(Basis::Linear, 0.05) }, &bent);
    // The first ring is followed by the end that it belongs to.
    let rings: Vec<&[Vec3]> = tube.positions.chunks(6).collect();
    assert_eq!(rings.len(), bent.len() + 2);
    for (ring, point) in rings[..1].iter().chain(&rings[2..10]).zip(&bent) {
        let center = ring.iter().map(|place| place.as_dvec3()).sum::<DVec3>() / 6.0;
        assert!(center.distance(point.position.as_dvec3()) < 1e-6);
    }
    let corner = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0)].map(|place| point(place, 0.25));
    let tube = mesh(&round(Basis::Linear, 0.005), &corner);
    assert_closed(&tube);
    for place in tube.positions.iter().map(|place| place.as_dvec3()) {
        let to = |a: DVec3, way: DVec3| place.distance(a + way * (place - a).dot(way).clamp(0.0, 1.0));
        assert!(to(DVec3::ZERO, DVec3::X).min(to(DVec3::X, DVec3::Y)) < 0.25 + 1e-6, "{place}");
    }
    let outside = DVec3::new(1.0, 0.0, 0.0) + DVec3::new(0.25, -0.25, 0.0) / 2f64.sqrt();
    assert!(tube.positions.iter().any(|place| place.as_dvec3().distance(outside) < 0.02));
}

#[test]
fn reversals_cusps_and_repeated_points_are_closed_and_finite() {
    let (a, b, c) = (DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.5));
    let cusp = [DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0), DVec3::new(0.0, 1.0, 0.0), DVec3::X];
    let all: [&[DVec3]; 8] = [
        &[a, b, a, b, a, b, a],
        &[a, a, a, b],
        &[a, a, b, b, b, c, c],
        &[a, b, b, b, b, b, c],
        &cusp,
        &[a, a, b, b],
        &[a, c, c, a],
        &[a, b, 2.0 * b, 3.0 * b],
    ];
    for places in all {
        for basis in [Basis::Bezier, Basis::BSpline, Basis::CatmullRom, Basis::Linear] {
            let points: Vec<_> = places.iter().map(|&place| point(place, 0.1)).collect();
            for kind in [CurveKind::Round, CurveKind::Ribbon] {
                let (has_coordinates, has_tangents) = (true, true);
                let curves = Curves { kind, has_coordinates, has_tangents, ..round(basis, 0.01) };
                let mesh = mesh(&curves, &points);
                assert_sound(&mesh);
                // What goes back on its own way may be in one place twice.
                let is_closed = edges(&mesh).iter().all(|[one, other]| one == other);
                assert!(is_closed || kind == CurveKind::Ribbon, "{basis}: {places:?}");
            }
        }
    }
}

#[test]
fn what_can_not_be_drawn_says_why_and_is_left_out() {
    let of = |places: &[f32], radius: f32| -> Vec<ControlPoint> {
        places.iter().map(|&x| ControlPoint { position: Vec3::splat(x), radius }).collect()
    };
    let all = [
        (of(&[0.0, 1.0, 2.0], 1.0), Basis::Bezier, "has 3 points, and bezier wants 4 points"),
        (of(&[0.0, 1.0, 2.0], 1.0), Basis::BSpline, "at least 4 points"),
        (of(&[0.0], 1.0), Basis::Linear, "at least 2 points"),
        (of(&[0.0, f32::NAN], 1.0), Basis::Linear, "point number 2 the position"),
        (of(&[0.0, 1.0], -1.0), Basis::Linear, "point number 1 the radius -1"),
        (of(&[0.0, 1.0], f32::INFINITY), Basis::CatmullRom, "the radius inf"),
        (of(&[0.0, 1.0], 0.0), Basis::Linear, "no radius above 0"),
        (of(&[7.1; 4], 1.0), Basis::BSpline, "at one place"),
    ];
    for (points, basis, wanted) in all {
        let fault = Strand { points: &points, ups: &[], colours: &[] }.fault(basis).unwrap();
        assert!(fault.contains(wanted), "{fault}");
        // Code may ask for it all the same.
        let mesh = mesh(&round(basis, 1.0), &points);
        assert!(mesh.positions.is_empty() || basis != Basis::BSpline, "{fault}");
    }
}

/// Along a helix the frame that turns no more than it must turns against Frenet's by the torsion (Bishop, There is more than one way to
/// frame a curve, 1975).
#[test]
fn normals_turn_against_those_of_a_helix_by_its_torsion() {
    let (radius, rise, turns) = (1.0, 0.5, 3.0);
    let (speed, steps) = (f64::hypot(radius, rise), 600);
    let mut frame = Frame::default();
    let mut wanted = None;
    for step in 0..=steps {
        let angle = TAU * turns * f64::from(step) / f64::from(steps);
        let (sine, cosine) = angle.sin_cos();
        let station = Station {
            center: DVec3::new(radius * cosine, radius * sine, rise * angle),
            radius: 0.1,
            tangent: DVec3::new(-radius * sine, radius * cosine, rise) / speed,
            slope: 0.0,
            piece: 0,
            share: 0.0,
        };
        let normal = frame.normal(&station, None);
        let inwards = DVec3::new(-cosine, -sine, 0.0);
        let found = normal.dot(station.tangent.cross(inwards)).atan2(normal.dot(inwards));
        let first = *wanted.get_or_insert(found);
        let off = found - (first - rise / speed * angle);
        assert!((off - TAU * (off / TAU).round()).abs() < 1e-4, "{step}: {off}");
    }
}

#[test]
fn a_ribbon_is_as_wide_as_it_says_and_faces_up() {
    let flat = Curves { kind: CurveKind::Ribbon, up: Some(Vec3::Z * 3.0), ..round(Basis::Bezier, 0.001) };
    let ribbon = mesh(&flat, &ring(2.0, 0.5));
    // A flat ring between two circles.
    assert!((area(&ribbon) - PI * (2.5 * 2.5 - 1.5 * 1.5)).abs() < 0.02);
    assert!(ribbon.normals.iter().all(|normal| normal.abs_diff_eq(Vec3::Z, 1e-6)));
    let front = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).normalize().z > 0.999;
    assert!(corners(&ribbon).all(front));
    // One that stands upright around it.
    let line: Vec<_> = (0..4).map(|k| point(DVec3::X * f64::from(k), 0.5)).collect();
    let ups = [Vec3::Z, Vec3::Z, Vec3::Y, Vec3::Y];
    let mut twisted = Strands::default();
    twisted.push(Strand { points: &line, ups: &ups, colours: &[] });
    let ribbon = Curves { basis: Basis::Linear, ..flat }.mesh(&twisted);
    for (vertex, up) in ups.iter().enumerate() {
        assert!(ribbon.normals[2 * vertex..2 * vertex + 2].iter().all(|normal| normal.abs_diff_eq(*up, 1e-6)));
    }
}

#[test]
fn coordinates_follow_the_length_and_tangents_the_strand() {
    let line = [0.0, 1.0, 4.0].map(|x| point(DVec3::X * x, 0.5));
    let curves = Curves { sides: Some(4), has_coordinates: true, has_tangents: true, ..round(Basis::Linear, 0.1) };
    let tube = mesh(&curves, &line);
    for (place, own) in tube.positions.iter().zip(&tube.coordinates[0]) {
        assert!((own.x - place.x / 4.0).abs() < 1e-6, "{place} {own}");
    }
    let side = |vertex: &usize| tube.normals[*vertex].x.abs() < 0.5;
    let sides: Vec<usize> = (0..tube.positions.len()).filter(side).collect();
    assert_eq!(sides.len(), 3 * 5);
    for vertex in sides {
        assert!(tube.tangents[vertex].abs_diff_eq(Vec3::X.extend(1.0), 1e-6));
        // The bitangent leads to where the second coordinate is less.
        let (normal, own) = (tube.normals[vertex], tube.coordinates[0][vertex].y);
        let angle = f64::from(TAU as f32 * own);
        let first = tube.normals[0].as_dvec3();
        let wanted = first * angle.cos() + DVec3::X.cross(first) * angle.sin();
        assert!(normal.as_dvec3().distance(wanted) < 1e-5);
    }
}

#[test]
fn colours_are_those_of_the_points_and_white_of_strands_without() {
    let line = [0.0, 1.0].map(|x| point(DVec3::X * x, 0.5));
    let (red, clear) = (glam::Vec4::new(1.0, 0.0, 0.0, 1.0), glam::Vec4::new(0.0, 0.0, 1.0, 0.5));
    let mut both = Strands::default();
    both.push(Strand { points: &line, ups: &[], colours: &[] });
    both.push(Strand { points: &line, ups: &[], colours: &[red, clear] });
    let ribbons = Curves { kind: CurveKind::Ribbon, ..round(Basis::Linear, 0.1) }.mesh(&both);
    let white = glam::Vec4::ONE;
    assert_eq!(ribbons.colours, [white, white, white, white, red, red, clear, clear]);
}

#[test]
fn what_is_counted_first_is_no_less_than_what_is_made_and_counting_ends_where_it_is_refused() {
    let line: Vec<_> =
        (0..40).map(|k| point(DVec3::new(f64::from(k % 3), f64::from(k % 5), f64::from(k)), 0.1)).collect();
    let all = strands(&line);
    for kind in [CurveKind::Round, CurveKind::Ribbon] {
        let curves = Curves { kind, has_coordinates: true, ..round(Basis::CatmullRom, 0.001) };
        let mut last = (0, 0);
        let fits = |triangles, vertices| {
            last = (triangles, vertices);
            Ok::<_, ()>(())
        };
        curves.count(&all, fits).unwrap();
        let mesh = curves.mesh(&all);
        assert!(mesh.triangles.len() <= last.0 && mesh.triangles.len() > last.0 * 9 / 10);
        assert!(mesh.positions.len() <= last.1 && mesh.positions.len() > last.1 * 9 / 10);
        let mut calls = 0;
        let refused = curves.count(&all, |triangles, _| {
            calls += 1;
            if triangles > 1000 { Err(triangles) } else { Ok(()) }
        });
        assert!(refused.is_err_and(|triangles| triangles < 1000 + 300) && calls < 1000);
    }
}
