//! Any strands.

use glam::DVec3;
use proptest::prelude::*;

use super::super::stations::{self, Station};
use super::*;

fn stations(basis: Basis, tolerance: f64, points: &[ControlPoint]) -> Vec<Station> {
    let mut all = Vec::new();
    let strand = Strand { points, ups: &[], colours: &[] };
    stations::each(&strand, basis, tolerance, |station| {
        all.push(station);
        Ok::<_, ()>(())
    })
    .unwrap();
    all
}

/// Weights of four control points, as books have them.
fn weights(basis: Basis, t: f64) -> [f64; 4] {
    let (s, t2, t3) = (1.0 - t, t * t, t * t * t);
    match basis {
        Basis::Bezier => [s * s * s, 3.0 * s * s * t, 3.0 * s * t2, t3],
        Basis::BSpline => {
            [s * s * s, 3.0 * t3 - 6.0 * t2 + 4.0, -3.0 * t3 + 3.0 * t2 + 3.0 * t + 1.0, t3].map(|weight| weight / 6.0)
        }
        Basis::CatmullRom => [-t3 + 2.0 * t2 - t, 3.0 * t3 - 5.0 * t2 + 2.0, -3.0 * t3 + 4.0 * t2 + t, t3 - t2]
            .map(|weight| weight / 2.0),
        Basis::Linear => [s, t, 0.0, 0.0],
    }
}

fn any_points(count: std::ops::Range<usize>) -> impl Strategy<Value = Vec<ControlPoint>> {
    let one = (prop::array::uniform3(-2.0f32..2.0), 0.01f32..0.3);
    let one = one.prop_map(|(place, radius)| ControlPoint { position: place.into(), radius });
    prop::collection::vec(one, count)
}

fn any_basis() -> impl Strategy<Value = Basis> {
    prop::sample::select(vec![Basis::Bezier, Basis::BSpline, Basis::CatmullRom, Basis::Linear])
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, ..ProptestConfig::default() })]

    #[test]
    fn every_tube_is_closed(basis in any_basis(), mut points in any_points(7..14), tolerance in 0.001f32..0.3, has in any::<[bool; 2]>()) {
        points.truncate(points.len() / 3 * 3 - 2);
        let curves = Curves { has_coordinates: has[0], has_tangents: has[1], ..round(basis, tolerance) };
        let mesh = mesh(&curves, &points);
        assert_sound(&mesh);
        assert_closed(&mesh);
    }

    #[test]
    fn stations_lie_where_weights_of_control_points_say(basis in any_basis(), points in any_points(10..11)) {
        let places: Vec<DVec3> = points.iter().map(|point| point.position.as_dvec3()).collect();
        for Station { center, piece, share, .. } in stations(basis, 0.05, &points) {
            let first = match basis {
                Basis::Bezier => 3 * piece,
                Basis::BSpline | Basis::Linear => piece,
                // The ends have no point before or behind.
                Basis::CatmullRom if piece == 0 || piece + 2 == places.len() => continue,
                Basis::CatmullRom => piece - 1,
            };
            let own = weights(basis, share).into_iter().enumerate();
            let wanted: DVec3 = own.filter(|(_, weight)| *weight != 0.0).map(|(k, weight)| places[first + k] * weight).sum();
            // Between stations at a cusp there are some on a straight line.
            prop_assert!(center.distance(wanted) < 0.05, "{basis} {piece} {share}: {center} {wanted}");
        }
    }

    /// Strands that bend gently, so that no other part of the curve is nearer than the middle of a ring.
    #[test]
    fn vertices_are_as_far_from_the_curve_as_the_radius_says(
        steps in prop::collection::vec((-0.5f64..0.5, -0.5f64..0.5), 8), basis in any_basis(), tolerance in 0.002f32..0.05,
    ) {
        let place = |(number, &(x, y)): (usize, &(f64, f64))| DVec3::new(x, y, number as f64);
        let mut places: Vec<DVec3> = steps.iter().enumerate().map(place).take(7).collect();
        if basis == Basis::Bezier {
            // Without a corner, inside of which two arms lie in each other.
            places[3] = 0.5 * (places[2] + places[4]);
        }
        let points: Vec<_> = places.iter().map(|&place| point(place, 0.1)).collect();
        let tube = mesh(&round(basis, tolerance), &points);
        let pieces = basis.pieces(points.len()).unwrap();
        let curve = (0..pieces).flat_map(|number| {
            let piece = basis.piece(number, points.len(), |at| points[at].position.as_dvec3());
            (0..=200).map(move |step| {
                let own = weights(Basis::Bezier, f64::from(step) / 200.0);
                piece.iter().zip(own).map(|(place, weight)| *place * weight).sum::<DVec3>()
            })
        });
        let curve: Vec<DVec3> = curve.collect();
        let distance = |place: DVec3| curve.iter().map(|at| at.distance(place)).fold(f64::INFINITY, f64::min);
        let (tolerance, is_smooth) = (f64::from(tolerance), basis != Basis::Linear);
        for place in tube.positions.iter().map(|place| place.as_dvec3()) {
            let distance = distance(place);
            prop_assert!(distance < 0.1 + tolerance + 1e-4, "{basis}: {place} {distance}");
            prop_assert!(!is_smooth || distance > 0.1 - tolerance - 1e-4, "{basis}: {place} {distance}");
        }
        let ends = [curve[0], curve[curve.len() - 1]];
        let is_end = |corners: &[DVec3; 3]| ends.iter().any(|end| corners.iter().all(|at| at.distance(*end) < 0.101));
        for triangle in corners(&tube).filter(|corners| is_smooth && !is_end(corners)) {
            // As far as edges around it may be, and as far as those along it.
            let distance = distance(triangle.iter().sum::<DVec3>() / 3.0);
            prop_assert!((0.1 - 2.0 * tolerance - 1e-4..0.1 + tolerance + 1e-4).contains(&distance), "{basis}: {distance}");
        }
    }
}
