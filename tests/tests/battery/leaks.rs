//! Rays from inside closed surfaces, aimed at faces, edges and vertices, never get out.

use eyerays::job::Job;
use eyerays::stream::{Stream, StreamRay};
use eyerays_tests::count;
use eyerays_tests::machine::Machine;
use eyerays_tests::random::Random;
use eyerays_tests::surface::{Surface, triangles};
use glam::{DVec3, Vec3};

use crate::against::{is_crowd, ray};

/// Far enough for a sphere of radius 2 to be 128 steps of single precision wide.
const FAR: DVec3 = DVec3::new(148_376.0, 1234.0, -223_423.0);
/// The most rays of a stream.
const PART: usize = 1 << 20;

/// A surface with no way out from where its rays start.
struct Closed<'a> {
    name: &'a str,
    packed: Job,
    /// Triangles that rays are aimed at, in the normalised scene.
    targets: Vec<[Vec3; 3]>,
    /// Rays to cast, and how many there are when all are asked for.
    rays: (usize, usize),
}

impl<'a> Closed<'a> {
    /// A surface around `eye`.
    fn new(name: &'a str, surface: &Surface, eye: DVec3, rays: (usize, usize)) -> Self {
        let packed = surface.pack_up_to(eye.as_vec3());
        let targets = triangles(&packed)[..surface.triangles.len()].iter().map(|t| t.vertices()).collect();
        Closed { name, packed, targets, rays }
    }

    /// A random place on a face, an edge or a vertex, one as often as the other, in the normalised scene.
    fn target(&self, kind: usize, random: &mut Random) -> DVec3 {
        let vertices = self.targets[random.index(self.targets.len())].map(|v| v.as_dvec3());
        let [a, b, c] = match (kind % 3, random.index(3)) {
            (0, _) => random.weights(),
            (1, side) => {
                let along = random.unit();
                let mut weights = [0.0; 3];
                (weights[side], weights[(side + 1) % 3]) = (along, 1.0 - along);
                weights
            }
            (_, corner) => std::array::from_fn(|i| if i == corner { 1.0 } else { 0.0 }),
        };
        vertices[0] * a + vertices[1] * b + vertices[2] * c
    }

    /// Rays from places in world units that `inside` makes.
    fn assert_no_leak(&self, inside: impl Fn(&mut Random) -> DVec3) {
        self.assert_no_ray_leaks(|kind, random| {
            towards(self.packed.normalisation().exactly(inside(random)), self.target(kind, random))
        });
    }

    /// Rays that `ray` makes, shared out among the traversals of each machine.
    fn assert_no_ray_leaks(&self, ray: impl Fn(usize, &mut Random) -> StreamRay) {
        let total = count::of(self.rays.0, self.rays.1);
        for machine in Machine::all() {
            if is_crowd(self.targets.iter().flatten().copied()) && machine.is_software() {
                println!("battery: leaks, {}, {machine}: left out, since software ends loops early", self.name);
                continue;
            }
            let (tracer, traversals) = (machine.tracer(&self.packed), machine.traversals());
            let part = total.div_ceil(traversals.len()).min(PART);
            let (mut random, mut leaks, mut done) = (Random::new(1), 0, 0);
            for &traversal in traversals.iter().cycle() {
                let size = part.min(total - done);
                let rays = (0..size).map(|kind| ray(kind, &mut random));
                let hits = tracer.closest(traversal, &Stream::new(rays));
                let is_met = |t: f32| t > 0.0 && t < f32::MAX;
                leaks += hits.iter().filter(|h| h.w == StreamRay::NOWHERE || !is_met(f32::from_bits(h.x))).count();
                done += size;
                if done == total {
                    break;
                }
            }
            count::none(format_args!("leaks, {}", self.name), machine, leaks, total);
        }
    }
}

/// A ray at a place.
fn towards(origin: DVec3, target: DVec3) -> StreamRay {
    let origin = origin.as_vec3();
    ray(origin, (target - origin.as_dvec3()).as_vec3())
}

/// Places within three quarters of a ball's radius.
fn ball(centre: DVec3, radius: f64) -> impl Fn(&mut Random) -> DVec3 {
    move |random| centre + random.direction() * (0.75 * radius * random.unit())
}

/// Rays to cast, and when all are asked for.
const COUNTS: (usize, usize) = (60_000, 10_000_000);

fn assert_sphere(name: &str, centre: DVec3, eye: DVec3, counts: (usize, usize)) {
    let surface = Surface::sphere(centre, 2.0, 200);
    Closed::new(name, &surface, eye, counts).assert_no_leak(ball(centre, 2.0));
}

#[test]
fn sphere() {
    assert_sphere("sphere", DVec3::ZERO, DVec3::ZERO, COUNTS);
}

#[test]
fn sphere_far_away() {
    assert_sphere("sphere far away", FAR, FAR, COUNTS);
}

/// A scene that reaches to the origin, so that it is not moved. Each ray meets most boxes, whose padding is wider than a triangle.
#[test]
fn sphere_far_from_the_origin() {
    assert_sphere("sphere far from the origin", FAR, DVec3::ZERO, (2_000, 20_000));
}

/// Rays at all but the outermost cells, which have nothing beside them.
fn assert_plane(name: &str, centre: DVec3) {
    let mut closed = Closed::new(name, &Surface::plane(centre, 12.0, 200), centre, COUNTS);
    let normalisation = closed.packed.normalisation();
    let (middle, half) = (normalisation.exactly(centre), 5.9 * normalisation.scale);
    let within = |v: &Vec3| (v.as_dvec3() - middle).abs().max_element() < half;
    closed.targets.retain(|vertices| vertices.iter().all(within));
    assert!(closed.targets.len() > 70_000);
    closed.assert_no_leak(|random| centre + random.cube() * DVec3::new(6.0, 2.0, 6.0) + DVec3::Y * 2.5);
}

#[test]
fn plane() {
    assert_plane("plane", DVec3::ZERO);
}

#[test]
fn plane_far_away() {
    assert_plane("plane far away", FAR);
}

/// From so near, and along flat boxes, that a vertex's rounding is large beside the distance: what boxes are padded for.
#[test]
fn large_cells_from_near() {
    let mut plane = Surface::plane(DVec3::ZERO, 12.0, 7);
    plane.positions.iter_mut().for_each(|p| p.y = 1e-4 * p.x + 3e-6 * p.z);
    let mut closed = Closed::new("large cells from near", &plane, DVec3::ZERO, COUNTS);
    let within = |v: &Vec3| v.as_dvec3().abs().max_element() < 5.5 * closed.packed.normalisation().scale;
    closed.targets.retain(|vertices| vertices.iter().all(within));
    closed.assert_no_ray_leaks(|kind, random| {
        let (target, away) = (closed.target(kind, random), random.direction());
        let height = 10f64.powf(random.between(-7.0, -1.0));
        // Nearer than a sheared vertex errs (16 roundoffs) a ray may as well start behind the surface.
        let up = (2e-4 + 10f64.powf(random.between(-5.0, 0.0))).max(16.0 * 0.5f64.powi(24) / height);
        towards(target + DVec3::new(away.x, up, away.z) * height, target)
    });
}

/// Hubs where 10,000 edges meet. A ray at one is tested against most of the triangles.
fn assert_fan(name: &str, centre: DVec3) {
    let closed = Closed::new(name, &Surface::bipyramid(centre, 2.0, 1.0, 10_000), centre, (2_000, 100_000));
    closed.assert_no_leak(ball(centre, 0.25));
}

#[test]
fn fan() {
    assert_fan("fan of 10,000 spokes", DVec3::ZERO);
}

#[test]
fn fan_far_away() {
    assert_fan("fan of 10,000 spokes far away", FAR);
}
