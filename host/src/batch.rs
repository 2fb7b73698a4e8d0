//! Rays of one's own, in the scene's units, traced many at once.

use eyerays_shader::real::TINY;
use glam::{DVec3, UVec4, Vec3};
use rayon::prelude::*;

use crate::device_scene::flushed;
use crate::job::Job;
use crate::stream::{Answers, Stream, StreamRay};

/// A ray in the scene's units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it starts, anywhere. Kernels take it rounded to single precision once, in the normalised scene and there in its cube.
    pub origin: DVec3,
    /// Where it goes, of any length but zero.
    pub direction: DVec3,
    /// How far it goes, in the scene's units; [`Ray::ENDLESS`] for one without an end.
    pub length: f64,
}

/// What a ray meets first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// The distance from the ray's origin, in the scene's units.
    pub distance: f64,
    /// The primitive's number in the scene: its triangles' first, then those of copies of meshes, then its spheres', then its disks'.
    pub primitive: u32,
    /// Where on it: barycentric weights of a triangle's second and third vertex, octahedral coordinates of a sphere's normal,
    /// or a disk's coordinates along two tangents, in radii.
    pub coordinates: [f32; 2],
}

/// Rays as kernels take them, for [`crate::cpu::cast`] and [`crate::gpu::Caster`].
///
/// ```
/// # use eyerays::{cpu, job::Job, method::Method, quality::Bvh, scene_io, stream::Question};
/// use eyerays::batch::{Batch, Ray};
/// # fn main() -> eyerays::error::Result<()> {
/// # let (scene, _) = scene_io::load("../scenes/cornell.toml".as_ref())?;
/// let job = Job::new(&scene, scene.settings, Bvh::Fast.quality())?;
/// let down = Ray::new([0.0, 1.0, 0.0].into(), [0.0, -1.0, 0.0].into());
/// let batch = Batch::new(&job, &[down]);
/// let (answers, _time) = cpu::cast(&job, Method::Wide.into(), 0, batch.stream(), Question::Closest)?;
/// assert!(batch.hits(&job, &answers)[0].is_some_and(|hit| hit.distance <= 1.0));
/// # Ok(())
/// # }
/// ```
pub struct Batch {
    stream: Stream,
    /// How far each ray was moved along itself towards the scene, in the scene's units.
    moved: Vec<f64>,
    scale: f64,
}

impl Ray {
    /// The length of a ray without an end.
    pub const ENDLESS: f64 = f64::INFINITY;

    /// From a place in a direction, without an end.
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Ray { origin, direction, length: Ray::ENDLESS }
    }
}

impl Batch {
    /// Rays through a scene. One that goes nowhere, or from no place, meets nothing.
    pub fn new(packed: &Job, rays: &[Ray]) -> Self {
        Batch::of(packed, rays.len(), |i| rays[i])
    }

    /// The same of rays that are made as they are needed, by many threads.
    pub fn of(packed: &Job, count: usize, ray: impl Fn(usize) -> Ray + Sync) -> Self {
        let scale = packed.normalisation().scale;
        let placed = (0..count).into_par_iter().map(|i| placed(packed, &ray(i)));
        let (stream, moved): (Vec<StreamRay>, Vec<f64>) = placed.unzip();
        Batch { stream: Stream::new(stream.into_iter()), moved, scale }
    }

    /// The rays for a device.
    pub fn stream(&self) -> &Stream {
        &self.stream
    }

    /// What each ray met, from a device's answers to [`crate::stream::Question::Closest`]; nothing from other answers.
    pub fn hits(&self, packed: &Job, answers: &Answers) -> Vec<Option<Hit>> {
        (0..self.moved.len()).map(|ray| self.hit(packed, answers, ray)).collect()
    }

    /// What a ray met.
    pub fn hit(&self, packed: &Job, answers: &Answers, ray: usize) -> Option<Hit> {
        let (record, copy) = self.record(answers, ray)?;
        let number = packed.primitives().get(record.w as usize)?.number();
        let copy = packed.instances().get(copy as usize);
        let primitive = copy.map_or(number, |copy| copy.number(number));
        let [t, u, v] = [record.x, record.y, record.z].map(f32::from_bits);
        let distance = self.moved[ray] + f64::from(t) / self.scale;
        Some(Hit { distance, primitive, coordinates: [u, v] })
    }

    /// A ray's answer as a device gives it, and the copy of a mesh that it is in.
    pub(crate) fn record(&self, answers: &Answers, ray: usize) -> Option<(UVec4, u32)> {
        let Answers::Closest(records) = answers else { return None };
        let copy = records.get(self.moved.len() + ray).map_or(StreamRay::NOWHERE, |record| record.w);
        Some((*records.get(ray)?, copy))
    }
}

/// A ray in the normalised scene, and how far it was moved along itself, in the scene's units: one from outside starts where it comes to
/// the scene's cube, before anything is rounded.
fn placed(packed: &Job, ray: &Ray) -> (StreamRay, f64) {
    let normalisation = packed.normalisation();
    // Scaled first, so that no square overflows or is lost; by zero that is NaN, which becomes zero.
    let size = ray.direction.abs().max_element();
    let direction = (ray.direction / size).normalize_or_zero();
    let origin = normalisation.exactly(ray.origin);
    let (enters, leaves) = span(origin, direction);
    let limit = ray.length * normalisation.scale - enters;
    // A limit below zero would say that something has been found; and what is compared with NaN is not so.
    if direction == DVec3::ZERO || !(leaves >= enters && limit >= 0.0) {
        return (AWAY, 0.0);
    }
    let origin = flushed((origin + direction * enters).as_vec3());
    // What is at the end counts; and no limit is so small that a device takes it for zero.
    let limit = (limit.min(f64::from(f32::MAX)) as f32).next_up().clamp(TINY, f32::MAX);
    let source_primitive = StreamRay::NOWHERE;
    (StreamRay { origin, direction: direction.as_vec3(), limit, source_primitive }, enters / normalisation.scale)
}

/// Where a ray enters the cube around a normalised scene, at least at its origin, and where it leaves it.
fn span(origin: DVec3, direction: DVec3) -> (f64, f64) {
    /// A little more than the scene's, so that nothing on its faces is passed.
    const HALF: f64 = 1.0 + 1.0 / 64.0;
    let ends = |axis: usize| {
        let (from, along) = (origin[axis], direction[axis]);
        match along == 0.0 {
            true if from.abs() <= HALF => (f64::NEG_INFINITY, f64::INFINITY),
            true => (f64::INFINITY, f64::NEG_INFINITY),
            false => ((-HALF * along.signum() - from) / along, (HALF * along.signum() - from) / along),
        }
    };
    let [x, y, z] = [0, 1, 2].map(ends);
    (x.0.max(y.0).max(z.0).max(0.0), x.1.min(y.1).min(z.1))
}

/// A ray that meets nothing: it starts beside the scene and goes away from it.
const AWAY: StreamRay = StreamRay {
    origin: Vec3::new(2.0, 0.0, 0.0),
    direction: Vec3::X,
    limit: 0.0,
    source_primitive: StreamRay::NOWHERE,
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cpu;
    use crate::method::Method;
    use crate::quality::Bvh;
    use crate::scene_io;
    use crate::stream::Question;

    /// The floor of the shipped scene `whitted` from above, near and far: the same distance in the scene's units, wherever
    /// the ray starts.
    #[test]
    fn distances_are_in_the_scenes_units_from_where_a_ray_starts() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/whitted.toml");
        let scene = scene_io::load(path.as_ref()).unwrap().0;
        let packed = Job::new(&scene, scene.settings, Bvh::Fast.quality()).unwrap();
        let bottom = scene.mesh.positions.iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
        let corner = scene.mesh.positions.iter().copied().reduce(Vec3::min).unwrap() + Vec3::new(0.25, 0.0, 0.25);
        let up = |height: f64| DVec3::new(corner.x.into(), f64::from(bottom) + height, corner.z.into());
        let mut rays: Vec<Ray> = [0.5, 3.0, 1e3, 1e6].map(|height| Ray::new(up(height), -2.0 * DVec3::Y)).into();
        rays.push(Ray { length: 900.0, ..rays[2] });
        rays.push(Ray { length: 1100.0, ..rays[2] });
        rays.push(Ray::new(up(1e3), DVec3::Y));
        rays.push(Ray::new(up(1e3), DVec3::ZERO));
        rays.push(Ray::new(DVec3::splat(f64::NAN), DVec3::Y));
        rays.push(Ray { length: f64::NAN, ..rays[2] });
        let batch = Batch::new(&packed, &rays);
        let (answers, _) = cpu::cast(&packed, Method::Wide.into(), 1, batch.stream(), Question::Closest).unwrap();
        let hits = batch.hits(&packed, &answers);
        for (hit, ray) in hits[..4].iter().zip(&rays) {
            let (hit, height) = (hit.expect("the floor is below"), ray.origin.y - f64::from(bottom));
            assert!((hit.distance - height).abs() <= 1e-6 * height, "{height}: {hit:?}");
            assert!(
                scene.mesh.triangles[hit.primitive as usize]
                    .iter()
                    .all(|&v| scene.mesh.positions[v as usize].y == bottom)
            );
        }
        let met = [false, true, false, false, false, false];
        assert_eq!(hits[4..].iter().map(Option::is_some).collect::<Vec<_>>(), met);
        let (answers, _) = cpu::cast(&packed, Method::Wide.into(), 1, batch.stream(), Question::Occlusion).unwrap();
        let Answers::Occlusion(shadows) = answers else { panic!("other answers") };
        assert_eq!(shadows[4..], met.map(u32::from), "what meets nothing is in no shadow");
    }
}
