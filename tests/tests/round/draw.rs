//! What spheres, disks and rays the oracles are asked about.

use eyerays::stream::StreamRay;
use fastrand::Rng;
use glam::{DVec3, Vec3};

/// A centre, a radius and a ray that may meet what is there.
pub struct Drawn {
    pub centre: Vec3,
    pub radius: f32,
    pub ray: StreamRay,
}

/// From where a ray comes.
#[derive(Clone, Copy, Debug)]
pub enum From {
    /// Anywhere in the scene, to anywhere around the centre.
    Outside,
    /// The scene's faces, edges and corners.
    Far,
    /// Inside of the sphere.
    Inside,
    /// Anywhere, along the sphere's limb.
    Tangent,
    /// Very near the surface, along it.
    Surface,
}

impl From {
    pub const ALL: [From; 5] = [From::Outside, From::Far, From::Inside, From::Tangent, From::Surface];

    /// Draws a radius of 1e-6 to 1, a place, and a ray.
    pub fn draw(self, rng: &mut Rng) -> Drawn {
        let radius = power(rng, -6.0, 0.0) as f32;
        let centre = (cube(rng) * (1.0 - f64::from(radius))).as_vec3();
        let (c, r) = (centre.as_dvec3(), f64::from(radius));
        let (origin, towards) = match self {
            From::Outside => {
                let origin = cube(rng);
                (origin, c + unit(rng) * r * rng.f64() * 1.1 - origin)
            }
            From::Far => {
                let origin = cube(rng).signum() + cube(rng) * power(rng, -3.0, 0.0);
                let origin = origin.clamp(DVec3::NEG_ONE, DVec3::ONE);
                (origin, c + unit(rng) * r * rng.f64() * 1.1 - origin)
            }
            From::Inside => (c + unit(rng) * r * rng.f64(), unit(rng)),
            From::Tangent => {
                let origin = cube(rng);
                let way = c - origin;
                // Beside or through the limb by this share of the radius.
                let sine = r / way.length() * (1.0 + sign(rng) * power(rng, -10.0, -2.0));
                let across = across(way, rng);
                (origin, way.normalize() * (1.0 - sine * sine).max(0.0).sqrt() + across * sine)
            }
            From::Surface => {
                let normal = unit(rng);
                let origin = c + normal * r * (1.0 + sign(rng) * power(rng, -8.0, -1.0));
                (origin, across(normal, rng) + normal * sign(rng) * power(rng, -7.0, -1.0))
            }
        };
        let origin = origin.clamp(DVec3::NEG_ONE, DVec3::ONE).as_vec3();
        Drawn { centre, radius, ray: towards_at(origin, towards, rng) }
    }
}

/// A ray of any length that matters, now and then along an axis or a plane.
pub fn towards_at(origin: Vec3, towards: DVec3, rng: &mut Rng) -> StreamRay {
    let length = if rng.bool() { 1.0 / towards.length() } else { power(rng, -9.0, 9.0) };
    let mut direction = (towards * length).as_vec3();
    if rng.u32(0..8) == 0 {
        direction[rng.usize(0..3)] = 0.0;
    }
    if direction == Vec3::ZERO {
        direction = Vec3::X;
    }
    StreamRay { origin, direction, limit: f32::MAX, source_primitive: StreamRay::NOWHERE }
}

/// In a cube of edge 2 around zero.
pub fn cube(rng: &mut Rng) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|_| 2.0 * rng.f64() - 1.0))
}

/// Of unit length.
pub fn unit(rng: &mut Rng) -> DVec3 {
    loop {
        let v = cube(rng);
        if (1e-4..=1.0).contains(&v.length_squared()) {
            return v.normalize();
        }
    }
}

/// Of unit length at a right angle to another.
pub fn across(v: DVec3, rng: &mut Rng) -> DVec3 {
    v.cross(unit(rng)).normalize()
}

/// 10 to a power between these.
pub fn power(rng: &mut Rng, least: f64, greatest: f64) -> f64 {
    10f64.powf(least + (greatest - least) * rng.f64())
}

pub fn sign(rng: &mut Rng) -> f64 {
    if rng.bool() { 1.0 } else { -1.0 }
}
