//! Rays of one's own, in the scene's units, traced many at once.

mod place;

use std::ops::Range;

use eyerays_shader::stage::Found;
use glam::{DVec3, UVec4};
use rayon::prelude::*;

pub use self::place::{BLOCK, RayBlock, Rays};
pub(crate) use self::place::{Placed, place};
use crate::job::Job;
use crate::stream::{Answers, Stream};

/// A ray in the scene's units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it starts, anywhere. Kernels take it rounded to single precision once, in the normalised scene and there in its cube.
    pub origin: DVec3,
    /// Where it goes, of any length but zero.
    pub direction: DVec3,
    /// How far it goes, in lengths of its direction; [`Ray::ENDLESS`] for one without an end.
    pub tmax: f64,
}

/// What a ray meets. Two are equal that are the same place of a scene, wherever its hierarchies have that.
#[derive(Debug, Clone, Copy)]
pub struct Hit {
    /// How far it is from the ray's origin, in lengths of its direction.
    pub t: f64,
    /// The primitive's number in the scene: its triangles' first, then those of copies of meshes, then its spheres', then its disks'.
    pub primitive: u32,
    /// Where on it: barycentric weights of a triangle's second and third vertex, octahedral coordinates of a sphere's normal,
    /// or a disk's coordinates along two tangents, in radii.
    pub coordinates: [f32; 2],
    /// Where its record is, and the copy of a mesh that it is in.
    pub(crate) slot: (u32, u32),
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
/// assert!(batch.hits(&job, &answers)[0].is_some_and(|hit| hit.t <= 1.0));
/// # Ok(())
/// # }
/// ```
pub struct Batch {
    stream: Stream,
    measures: Vec<Measure>,
}

/// Rays that a thread places at once.
const TASK: usize = 1 << 12;

/// How distances of a kernel become lengths of a ray's direction.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Measure {
    /// How far the ray was moved along itself towards the scene.
    moved: f64,
    /// What one length of the kernel's direction is.
    unit: f64,
}

impl Measure {
    /// How far from the ray's origin something is that a kernel has found.
    #[inline]
    pub fn t(&self, found: f32) -> f64 {
        (self.moved + f64::from(found) * self.unit).min(f64::MAX)
    }
}

impl Hit {
    /// What a kernel has found on a primitive whose record has this number: that in its mesh where it is in a copy of one.
    #[inline]
    pub(crate) fn of(packed: &Job, number: u32, measure: &Measure, found: &Found<f32>) -> Hit {
        let Found { coordinates: (u, v), index, instance, .. } = *found;
        let copy = packed.instances().get(instance as usize);
        let primitive = copy.map_or(number, |copy| copy.number(number));
        Hit { t: measure.t(found.t), primitive, coordinates: [u, v], slot: (index, instance) }
    }
}

impl PartialEq for Hit {
    fn eq(&self, other: &Hit) -> bool {
        (self.t, self.primitive, self.coordinates) == (other.t, other.primitive, other.coordinates)
    }
}

impl Ray {
    /// That of a ray without an end.
    pub const ENDLESS: f64 = f64::INFINITY;

    /// From a place in a direction, without an end.
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Ray { origin, direction, tmax: Ray::ENDLESS }
    }
}

impl Batch {
    /// Rays through a scene. One that goes nowhere, or from no place, meets nothing.
    pub fn new(packed: &Job, rays: &[Ray]) -> Self {
        Batch::of(packed, 0..rays.len(), &|i: usize| rays[i])
    }

    /// The same of rays that are made as they are needed, by many threads.
    pub fn of(packed: &Job, range: Range<usize>, rays: &impl Rays) -> Self {
        let count = range.len();
        let (mut words, mut measures) = (vec![UVec4::ZERO; 2 * count], vec![Measure::default(); count]);
        let (firsts, seconds) = words.split_at_mut(count);
        let tasks = firsts.par_chunks_mut(TASK).zip(seconds.par_chunks_mut(TASK)).zip(measures.par_chunks_mut(TASK));
        tasks.enumerate().for_each(|(task, ((firsts, seconds), measures))| {
            place(
                packed.normalisation(),
                rays,
                range.start + TASK * task..range.end,
                Placed { firsts, seconds, measures },
            );
        });
        Batch { stream: Stream::of_words(words), measures }
    }

    /// The rays for a device.
    pub fn stream(&self) -> &Stream {
        &self.stream
    }

    /// How distances along a ray are to be taken.
    pub(crate) fn measure(&self, ray: usize) -> &Measure {
        &self.measures[ray]
    }

    /// What each ray met, from a device's answers to [`crate::stream::Question::Closest`]; nothing from other answers.
    pub fn hits(&self, packed: &Job, answers: &Answers) -> Vec<Option<Hit>> {
        (0..self.measures.len()).map(|ray| self.hit(packed, answers, ray)).collect()
    }

    fn hit(&self, packed: &Job, answers: &Answers, ray: usize) -> Option<Hit> {
        let found = answers.found(ray, self.measures.len())?;
        let number = packed.primitives().get(found.index as usize)?.number();
        Some(Hit::of(packed, number, self.measure(ray), &found))
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    use crate::cpu;
    use crate::method::Method;
    use crate::quality::Bvh;
    use crate::scene_io;
    use crate::stream::Question;

    /// The floor of the shipped scene `whitted` from above, near and far: the same distance, wherever the ray starts.
    #[test]
    fn distances_are_lengths_of_the_direction_from_where_a_ray_starts() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/whitted.toml");
        let scene = scene_io::load(path.as_ref()).unwrap().0;
        let packed = Job::new(&scene, scene.settings, Bvh::Fast.quality()).unwrap();
        let bottom = scene.mesh.positions.iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
        let corner = scene.mesh.positions.iter().copied().reduce(Vec3::min).unwrap() + Vec3::new(0.25, 0.0, 0.25);
        let up = |height: f64| DVec3::new(corner.x.into(), f64::from(bottom) + height, corner.z.into());
        let mut rays: Vec<Ray> = [0.5, 3.0, 1e3, 1e6].map(|height| Ray::new(up(height), -2.0 * DVec3::Y)).into();
        rays.push(Ray { tmax: 450.0, ..rays[2] });
        rays.push(Ray { tmax: 550.0, ..rays[2] });
        rays.push(Ray::new(up(1e3), DVec3::Y));
        rays.push(Ray::new(up(1e3), DVec3::ZERO));
        rays.push(Ray::new(DVec3::splat(f64::NAN), DVec3::Y));
        rays.push(Ray { tmax: f64::NAN, ..rays[2] });
        let batch = Batch::new(&packed, &rays);
        let (answers, _) = cpu::cast(&packed, Method::Wide.into(), 1, batch.stream(), Question::Closest).unwrap();
        let hits = batch.hits(&packed, &answers);
        for (hit, ray) in hits[..4].iter().zip(&rays) {
            let (hit, height) = (hit.expect("the floor is below"), ray.origin.y - f64::from(bottom));
            assert!((2.0 * hit.t - height).abs() <= 1e-6 * height, "{height}: {hit:?}");
            assert!(
                scene.mesh.triangles[hit.primitive as usize]
                    .iter()
                    .all(|&v| scene.mesh.positions[v as usize].y == bottom)
            );
        }
        // So short that no number of double precision is as large as the distance.
        let short = Ray::new(up(1.0), -DVec3::Y * 1e-310);
        let batch_of_short = Batch::new(&packed, &[short]);
        let (answers, _) =
            cpu::cast(&packed, Method::Wide.into(), 1, batch_of_short.stream(), Question::Closest).unwrap();
        assert_eq!(batch_of_short.hits(&packed, &answers)[0].expect("the floor is below").t, f64::MAX);
        let met = [false, true, false, false, false, false];
        assert_eq!(hits[4..].iter().map(Option::is_some).collect::<Vec<_>>(), met);
        let (answers, _) = cpu::cast(&packed, Method::Wide.into(), 1, batch.stream(), Question::Occlusion).unwrap();
        let Answers::Occlusion(shadows) = answers else { panic!("other answers") };
        assert_eq!(shadows[4..], met.map(u32::from), "what meets nothing is in no shadow");
    }
}
