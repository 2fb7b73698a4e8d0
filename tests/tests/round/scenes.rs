//! Scenes of triangles, spheres and disks that overlap, touch, nest and tie, and rays in them.

use eyerays::job::Job;
use eyerays::scene::{Disk, Scene, Sphere};
use eyerays::stream::{Stream, StreamRay};
use eyerays_bvh::Quality;
use eyerays_shader::data::Primitive;
use eyerays_shader::geometry::SurfaceInteraction;
use eyerays_shader::ray::Ray;
use eyerays_shader::real::V3;
use eyerays_tests::model::{add, empty, glass, matt};
use fastrand::Rng;
use glam::{DVec3, Vec3};

use super::draw::{across, cube, power, towards_at, unit};

/// How a scene's parts lie.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// Anywhere, of any size.
    Random,
    /// Spheres and disks alone, many of one size, as particles are.
    Particles,
    /// Spheres within spheres around few centres, with disks through them.
    Nested,
    /// On a grid, so that neighbours touch and some are there twice.
    Touching,
    /// Some of the scene's size and many of 1e-6 of it.
    TinyAndLarge,
    /// Spheres alone.
    Spheres,
    /// Disks alone.
    Disks,
}

impl Kind {
    pub const ALL: [Kind; 7] =
        [Kind::Random, Kind::Particles, Kind::Nested, Kind::Touching, Kind::TinyAndLarge, Kind::Spheres, Kind::Disks];

    /// A scene of about 200 parts, every fifth of them of glass.
    pub fn scene(self) -> Scene {
        let mut rng = Rng::with_seed(self as u64 + 1);
        let mut scene = empty();
        scene.materials = vec![matt(Vec3::ONE), glass(Vec3::ONE)];
        for i in 0..200 {
            let (center, size) = self.place(i, &mut rng);
            let material = u32::from(i % 5 == 4);
            let of = match self {
                Kind::Spheres => 0,
                Kind::Disks => 1,
                Kind::Particles => i % 2,
                _ => i % 3,
            };
            let (center, radius) = (center.as_vec3(), size as f32);
            match of {
                0 => scene.spheres.push(Sphere { center, radius, material }),
                1 => {
                    let axis = [Vec3::X, Vec3::NEG_Y, Vec3::Z][rng.usize(0..3)];
                    let normal = if rng.u32(0..3) == 0 { axis } else { unit(&mut rng).as_vec3().normalize() };
                    scene.disks.push(Disk { center, normal, radius, material });
                }
                _ => {
                    let corners = [0; 3].map(|_| center + (unit(&mut rng) * size).as_vec3());
                    add(&mut scene, matt(Vec3::ONE), &corners, &[[0, 1, 2]]);
                }
            }
        }
        scene
    }

    fn place(self, i: usize, rng: &mut Rng) -> (DVec3, f64) {
        let grid = |rng: &mut Rng| DVec3::from_array([0; 3].map(|_| f64::from(rng.i32(-3..=3)) / 4.0));
        match self {
            Kind::Particles => (cube(rng), 0.05),
            Kind::Nested => (cube(&mut Rng::with_seed(i as u64 % 4)) * 0.5, 0.5 * power(rng, -3.0, 0.0)),
            Kind::Touching => (grid(rng), 0.125),
            Kind::TinyAndLarge if !i.is_multiple_of(10) => (cube(rng) * 0.3, power(rng, -6.0, -5.0)),
            Kind::TinyAndLarge => (cube(rng), 0.4),
            Kind::Random | Kind::Spheres | Kind::Disks => (cube(rng), 0.5 * power(rng, -4.0, 0.0)),
        }
    }

    /// The same packed.
    pub fn pack(self, quality: Quality) -> Job {
        let scene = self.scene();
        Job::with_wide_nodes(&scene, scene.settings, quality).unwrap_or_else(|e| panic!("{self:?}: {e}"))
    }
}

/// A scene's primitives, each once and by its number, which no hierarchy changes.
fn primitives(packed: &Job) -> Vec<Primitive> {
    let mut all = packed.primitives().to_vec();
    all.sort_by_key(Primitive::number);
    all.dedup_by_key(|primitive| primitive.number());
    all
}

/// Rays from anywhere, from inside of spheres and along their limbs, at disks' rims; and rays that leave what they start on.
/// Some end soon.
pub fn rays(packed: &Job, count: usize) -> Stream {
    let (all, mut rng) = (primitives(packed), Rng::with_seed(3));
    Stream::new((0..count).map(|i| {
        let primitive = &all[rng.usize(0..all.len())];
        let limit = if i % 7 == 0 { power(&mut rng, -6.0, 0.0) as f32 } else { f32::MAX };
        if i % 3 == 0 {
            return StreamRay { limit, ..leaving(packed, primitive, &mut rng) };
        }
        let (c, r) = middle(primitive);
        let (origin, target) = match i % 5 {
            0 => (c + unit(&mut rng) * r * rng.f64(), cube(&mut rng)),
            1 => {
                let origin = cube(&mut rng);
                (origin, c + across(c - origin, &mut rng) * r)
            }
            2 if primitive.is_disk() => (cube(&mut rng), c + across(primitive.normal().as_dvec3(), &mut rng) * r),
            3 => (cube(&mut rng), cube(&mut rng)),
            _ => (cube(&mut rng), c + unit(&mut rng) * r * rng.f64()),
        };
        let origin = origin.clamp(DVec3::NEG_ONE, DVec3::ONE).as_vec3();
        StreamRay { limit, ..towards_at(origin, target - origin.as_dvec3(), &mut rng) }
    }))
}

/// The centre and the radius of what is there.
fn middle(primitive: &Primitive) -> (DVec3, f64) {
    if primitive.is_triangle() {
        let [a, b, c] = primitive.vertices().map(|v| v.as_dvec3());
        let centre = (a + b + c) / 3.0;
        return (centre, (a - centre).length());
    }
    (primitive.centre().as_dvec3(), f64::from(primitive.radius()))
}

/// A ray from a place on a primitive, as a picture's rays leave it.
fn leaving(packed: &Job, primitive: &Primitive, rng: &mut Rng) -> StreamRay {
    let (u, v) = (rng.f32(), rng.f32());
    let (u, v) = match () {
        () if primitive.is_sphere() => (2.0 * u - 1.0, 2.0 * v - 1.0),
        () if primitive.is_disk() => ((v * std::f32::consts::TAU).cos() * u, (v * std::f32::consts::TAU).sin() * u),
        () if u + v > 1.0 => (1.0 - u, 1.0 - v),
        () => (u, v),
    };
    let seen = V3::<f32>::splat(unit(rng).as_vec3());
    let at = SurfaceInteraction::new(packed.effects(), primitive, (u, v), seen);
    let normal = DVec3::new(at.normal.x.into(), at.normal.y.into(), at.normal.z.into());
    let flat = if rng.bool() { power(rng, -7.0, 0.0) } else { 1.0 };
    let way = (unit(rng) + normal * (flat - 1.0) * normal.dot(unit(rng))).normalize().as_vec3();
    let out = V3::<f32>::splat(way);
    let start = if rng.bool() { at.offset_ray_origin(out) } else { at.offset_ray_origin_along(out) };
    let source_primitive = at.source_primitive(out);
    debug_assert!(source_primitive & !Ray::<f32>::INSIDE == primitive.number());
    StreamRay { origin: Vec3::new(start.x, start.y, start.z), direction: way, limit: f32::MAX, source_primitive }
}
