//! Hits against those of brute force.

use eyerays::job::Job;
use eyerays::stream::{Stream, StreamRay};
use eyerays_shader::data::{BOX_PADDING, Primitive};
use eyerays_shader::real::Fast;
use eyerays_tests::brute_force::{Found, brute_force, brute_force_of, found};
use eyerays_tests::count;
use eyerays_tests::machine::Machine;
use eyerays_tests::random::Random;
use eyerays_tests::surface::triangles;
use glam::{DVec3, Vec3};

/// A ray that leaves nothing and goes as far as it gets.
pub fn ray(origin: Vec3, direction: Vec3) -> StreamRay {
    StreamRay { origin, direction, limit: f32::MAX, source_primitive: StreamRay::NOWHERE }
}

/// Rays from anywhere around the triangles of a packed scene, and from vertices: into triangles, at vertices, along
/// axes and anywhere.
pub fn rays(packed: &Job, count: usize) -> Stream {
    let triangles: Vec<[DVec3; 3]> = triangles(packed).iter().map(|t| t.vertices().map(|v| v.as_dvec3())).collect();
    let corners = triangles.as_flattened();
    let least = corners.iter().copied().fold(DVec3::ONE, DVec3::min);
    let extent = corners.iter().copied().fold(DVec3::NEG_ONE, DVec3::max) - least;
    let mut random = Random::new(2);
    let rays = (0..count).map(|kind| {
        let place = |random: &mut Random| least + extent * (0.5 + 0.6 * random.cube());
        let [a, b, c] = triangles[random.index(triangles.len())];
        let origin = if kind % 7 == 0 { corners[random.index(corners.len())] } else { place(&mut random) };
        let origin = origin.clamp(DVec3::NEG_ONE, DVec3::ONE).as_vec3();
        let target = match kind % 4 {
            0 => b,
            1 => place(&mut random),
            _ => {
                let [u, v, w] = random.weights();
                a * u + b * v + c * w
            }
        };
        let direction = (target - origin.as_dvec3()).as_vec3();
        let axis = [Vec3::X, Vec3::NEG_Y, Vec3::Z][random.index(3)];
        ray(origin, if kind % 9 == 0 || direction == Vec3::ZERO { axis } else { direction })
    });
    Stream::new(rays)
}

/// Is the mesh so small beside its distance from zero that the padding of boxes makes them one? A ray then meets most
/// triangles, and software, which ends loops after 65,535 rounds, can't follow it.
pub fn is_crowded(packed: &Job) -> bool {
    is_crowd(packed.primitives().iter().flat_map(Primitive::vertices))
}

/// The same of some of its vertices.
pub fn is_crowd(vertices: impl Iterator<Item = Vec3>) -> bool {
    let none = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let (least, greatest) = vertices.fold(none, |(least, greatest), v| (least.min(v), greatest.max(v)));
    (greatest.as_dvec3() - least.as_dvec3()).length() < 1024.0 * f64::from(BOX_PADDING)
}

/// Is an answer a miss, or a place on a triangle?
fn is_sound(hit: Found) -> bool {
    let [t, u, v] = [hit[0], hit[1], hit[2]].map(f32::from_bits);
    hit[3] == StreamRay::NOWHERE || ((0.0..=f32::MAX).contains(&t) && u.is_finite() && v.is_finite())
}

/// In fast precision: is it the other answer but for its last bits?
fn is_near(hit: Found, want: Found) -> bool {
    let [t, other] = [hit[0], want[0]].map(f32::from_bits);
    (hit[3] == StreamRay::NOWHERE) == (want[3] == StreamRay::NOWHERE) && (t - other).abs() <= 1e-3 * t.max(other)
}

/// Asserts that every traversal of every machine finds what brute force does in its precision: the same bits in exact
/// precision; in fast precision nothing but numbers, and how many differ is counted.
///
/// `rounds` are what a ray's traversal may take at most, for software that ends loops after 65,535 of them.
pub fn assert_like_brute_force(what: &str, packed: &Job, stream: &Stream, rounds: usize) {
    let (exact, fast) = (brute_force(packed, stream), brute_force_of::<Fast>(packed, stream));
    for machine in Machine::all() {
        if machine.is_software() && rounds > 30_000 {
            println!("battery: {what}, {machine}: left out, since software ends loops early");
            continue;
        }
        let (want, is_same) = (if machine.exact { &exact } else { &fast }, machine.exact);
        let (tracer, traversals) = (machine.tracer(packed), machine.traversals());
        let (mut differing, mut unsound) = (0, 0);
        for &traversal in &traversals {
            let hits = tracer.closest(traversal, stream);
            let pairs = || hits.iter().map(|&hit| found(packed, hit)).zip(want);
            unsound += pairs().filter(|&(hit, _)| !is_sound(hit)).count();
            let same = |hit: Found, want: Found| if is_same { hit == want } else { is_near(hit, want) };
            differing += pairs().filter(|&(hit, &want)| !same(hit, want)).count();
        }
        let total = traversals.len() * stream.len();
        count::none(format_args!("{what}, no number"), machine, unsound, total);
        let what = format!("{what}, other hits than brute force");
        if is_same {
            count::none(what, machine, differing, total);
        } else {
            // What is degenerate is hit or not by rounding, which is the device's own.
            count::line(&what, machine, differing, total);
        }
    }
}
