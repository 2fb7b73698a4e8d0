//! Photons: where they are sent, and how they are found again.

use eyerays_shader::data::{Frame, pack};
use eyerays_shader::photon::{Casters, Grid, Landed, Photons, RECORDS, file, radius};
use eyerays_shader::real::V3;
use eyerays_shader::sampler::hash;
use glam::{DVec3, UVec4, Vec3};
use std::f64::consts::PI;

type V = V3<f64>;

/// The records of balls that are as likely as they are large.
fn casters(balls: &[(Vec3, f32)]) -> Vec<UVec4> {
    let all: f64 = balls.iter().map(|ball| f64::from(ball.1).powi(2)).sum();
    let mut records = vec![pack(Vec3::ZERO, balls.len() as u32)];
    let mut sum = 0.0;
    for &(centre, size) in balls {
        let share = f64::from(size).powi(2) / all;
        sum += share;
        records.push(pack(centre, (sum * 4_294_967_295.0) as u32));
        records.push(pack(Vec3::new(size, share as f32, 0.0), 0));
    }
    records
}

const BALLS: [(Vec3, f32); 3] =
    [(Vec3::new(0.3, 0.1, 0.0), 0.2), (Vec3::new(0.2, 0.2, 0.1), 0.3), (Vec3::new(-0.5, 0.0, 0.4), 0.1)];

fn draws(number: u32) -> (u32, (u32, u32)) {
    let [a, b, c] = hash([number, 7, 1]);
    (a, (b, c))
}

fn vector(v: V) -> DVec3 {
    DVec3::new(v.x, v.y, v.z)
}

/// How far a line from a place along a unit direction passes by a ball.
fn aside(from: DVec3, direction: DVec3, centre: DVec3) -> f64 {
    let away = centre - from;
    (away - direction * away.dot(direction)).length()
}

/// Directions go to some ball, and one over their density is the solid angle in which the balls are seen, in the mean: of cones that overlap
/// each direction counts once.
#[test]
fn directions_go_to_balls_and_their_density_is_of_all_of_them() {
    let records = casters(&BALLS);
    let casters = Casters { records: &records };
    for from in [DVec3::new(0.0, 0.9, 0.0), DVec3::new(-0.9, -0.2, 0.9), DVec3::new(0.25, 0.15, 0.0)] {
        let (count, mut sum) = (200_000, 0.0);
        let is_inside = BALLS.iter().any(|ball| ball.0.as_dvec3().distance(from) < f64::from(ball.1));
        for number in 0..count {
            let (choice, pair) = draws(number);
            let (direction, density) = casters.direction(V::new(from.x, from.y, from.z), choice, pair);
            let direction = vector(direction);
            assert!((direction.length() - 1.0).abs() < 1e-6 && density > 0.0);
            let meets = |ball: &(Vec3, f32)| {
                let centre = ball.0.as_dvec3();
                aside(from, direction, centre) <= f64::from(ball.1) + 1e-6 && direction.dot(centre - from) > 0.0
            };
            assert!(is_inside || BALLS.iter().any(meets), "{direction} from {from}");
            sum += 1.0 / density;
        }
        // By all directions alike.
        let seen = (0..count).filter(|&number| {
            let [a, b, _] = hash([number, 3, 5]);
            let (up, turn) = (f64::from(a) / 2f64.powi(31) - 1.0, f64::from(b) / 2f64.powi(32) * 2.0 * PI);
            let across = (1.0 - up * up).sqrt();
            let direction = DVec3::new(across * turn.cos(), across * turn.sin(), up);
            let meets = |ball: &(Vec3, f32)| {
                let centre = ball.0.as_dvec3();
                let is_in = centre.distance(from) < f64::from(ball.1);
                is_in || aside(from, direction, centre) < f64::from(ball.1) && direction.dot(centre - from) > 0.0
            };
            BALLS.iter().any(meets)
        });
        let want = 4.0 * PI * seen.count() as f64 / f64::from(count);
        let got = sum / f64::from(count);
        assert!((got / want - 1.0).abs() < 0.03, "from {from}: {got}, not {want}");
    }
}

/// The same of parallel light: places lie before some ball, and one over their density is the area that all of them take across it.
#[test]
fn parallel_light_comes_to_balls_by_the_area_that_they_take() {
    let records = casters(&BALLS);
    let casters = Casters { records: &records };
    for along in [DVec3::new(0.0, -1.0, 0.0), DVec3::new(0.6, -0.48, 0.64)] {
        let (count, mut sum) = (200_000, 0.0);
        let reaches = |place: DVec3, room: f64| {
            BALLS.iter().any(|ball| aside(place, along, ball.0.as_dvec3()) <= f64::from(ball.1) + room)
        };
        for number in 0..count {
            let (choice, pair) = draws(number);
            let (place, density) = casters.place(V::new(along.x, along.y, along.z), choice, pair);
            assert!(density > 0.0 && reaches(vector(place), 1e-6), "{place:?}");
            sum += 1.0 / density;
        }
        let [x, y] = [along.any_orthonormal_vector(), along.cross(along.any_orthonormal_vector())];
        let hit = (0..count).filter(|&number| {
            let [a, b, _] = hash([number, 3, 5]);
            let unit = |drawn: u32| f64::from(drawn) / 2f64.powi(31) - 1.0;
            reaches(x * unit(a) + y * unit(b), 0.0)
        });
        let (got, want) = (sum / f64::from(count), 4.0 * hit.count() as f64 / f64::from(count));
        assert!((got / want - 1.0).abs() < 0.03, "along {along}: {got}, not {want}");
    }
}

/// Places of photons, some of them close together, of two samples.
fn places(count: u32) -> Vec<Vec3> {
    let unit = |drawn: u32| (f64::from(drawn) / 2f64.powi(31) - 1.0) as f32;
    let place = |number: u32| {
        let [a, b, c] = hash([number, 11, 2]);
        let size = if number.is_multiple_of(3) { 0.02 } else { 0.9 };
        Vec3::new(unit(a), unit(b), unit(c)) * size
    };
    (0..count).map(place).collect()
}

/// Each photon of the own sample within the radius is found once, whichever lists share cells, and no other one is.
#[test]
fn all_photons_around_are_found_once() {
    let photons = 3000;
    // So few lists that most cells share one.
    for (heads, reach) in [(16, 0.05f32), (4096, 0.011), (8192, 0.3)] {
        let frame = Frame { photons, heads, radius: reach, sample: 0, slots: 2 * photons, ..Frame::default() };
        let places = places(2 * photons);
        let mut records = vec![UVec4::ZERO; (RECORDS * frame.slots) as usize];
        for (slot, place) in places.iter().enumerate() {
            // Some have not landed.
            if !slot.is_multiple_of(7) {
                let place = V3::splat(*place);
                Landed::new::<f32>(place, V3::splat(Vec3::Y), V3::splat(Vec3::ONE), 1).store(slot as u32, &mut records);
            }
        }
        let mut lists = vec![0; heads as usize];
        for slot in 0..frame.slots {
            file(&frame, slot, &mut records, |list, first| std::mem::replace(&mut lists[list as usize], first));
        }
        let all = Photons { records: &records, heads: &lists };
        for (sample, at) in [(0, Vec3::ZERO), (1, Vec3::splat(0.011)), (1, Vec3::new(-0.4, 0.2, 0.7)), (0, Vec3::X)] {
            let radius = radius(&frame, sample);
            let grid = Grid::new(&frame, sample, radius);
            let is_near = |place: Vec3| place.distance(at) < radius;
            let mut found = Vec::new();
            let mut search = grid.around(V3::splat(at), &all);
            while search.goes_on() {
                let (next, number, place, is_own) = search.step(&frame, &grid, &all);
                search = next;
                if is_own && is_near(Vec3::new(place.x, place.y, place.z)) {
                    found.push(number);
                }
            }
            found.sort_unstable();
            let own = sample * photons..(sample + 1) * photons;
            let want: Vec<u32> =
                own.filter(|&slot| !slot.is_multiple_of(7) && is_near(places[slot as usize])).collect();
            assert_eq!(found, want, "{heads} lists, sample {sample} at {at}");
        }
    }
}

/// The square of the radius falls as the number of the sample to the power of -1/3.
#[test]
fn later_samples_look_less_far() {
    let frame = Frame { radius: 0.25, ..Frame::default() };
    for (sample, share) in [(0u32, 1.0), (7, 0.5), (63, 0.25), (728, 1.0 / 9.0), (16_777_215, 1.0 / 256.0)] {
        let (got, want): (f32, f64) = (radius(&frame, sample), 0.25 * f64::sqrt(share));
        assert!((f64::from(got) / want - 1.0).abs() < 1e-5, "sample {sample}: {got}, not {want}");
    }
}
