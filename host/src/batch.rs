//! Rays of one's own, in the scene's units, traced many at once.

use eyerays_shader::real::TINY;
use glam::DVec3;
use rayon::prelude::*;

use crate::device_scene::{Normalisation, flushed};
use crate::job::Job;
use crate::stream::{Answers, Stream, StreamRay};

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

/// What a ray meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// How far it is from the ray's origin, in lengths of its direction.
    pub t: f64,
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
/// assert!(batch.hits(&job, &answers)[0].is_some_and(|hit| hit.t <= 1.0));
/// # Ok(())
/// # }
/// ```
pub struct Batch {
    stream: Stream,
    measures: Vec<Measure>,
}

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
    pub fn t(&self, found: f32) -> f64 {
        self.moved + f64::from(found) * self.unit
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
        Batch::of(packed, rays.len(), |i| rays[i])
    }

    /// The same of rays that are made as they are needed, by many threads.
    pub fn of(packed: &Job, count: usize, ray: impl Fn(usize) -> Ray + Sync) -> Self {
        let normalisation = packed.normalisation();
        let placed = (0..count).into_par_iter().map(|i| placed(normalisation, &ray(i)));
        let (stream, measures): (Vec<StreamRay>, Vec<Measure>) = placed.unzip();
        Batch { stream: Stream::new(stream.into_iter()), measures }
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
        let copy = packed.instances().get(found.instance as usize);
        let primitive = copy.map_or(number, |copy| copy.number(number));
        let (u, v) = found.coordinates;
        Some(Hit { t: self.measure(ray).t(found.t), primitive, coordinates: [u, v] })
    }
}

/// A ray in the normalised scene: one from outside starts where it comes to the scene's cube, before anything is rounded. Its direction is
/// multiplied by a power of two, which rounds nothing, so that its greatest component is at least 1 and below 2.
#[inline]
pub(crate) fn placed(normalisation: &Normalisation, ray: &Ray) -> (StreamRay, Measure) {
    let (direction, (binade, over)) = grown(ray.direction);
    let (scale, origin) = (normalisation.scale, normalisation.exactly(ray.origin));
    let limit = ray.tmax * scale * binade;
    let Some(enters) = entry(origin, direction).filter(|enters| limit >= *enters) else {
        return (StreamRay::AWAY, Measure::default());
    };
    let origin = origin + direction * enters;
    // What is at the end counts; and no limit is so small that a device takes it for zero.
    let limit = ((limit - enters).min(f64::from(f32::MAX)) as f32).next_up().clamp(TINY, f32::MAX);
    let source_primitive = StreamRay::NOWHERE;
    let unit = over / scale;
    let placed =
        StreamRay { origin: flushed(origin.as_vec3()), direction: direction.as_vec3(), limit, source_primitive };
    (placed, Measure { moved: enters * unit, unit })
}

/// A direction over a power of two, that, and one over it. What is no direction stays none.
#[inline]
fn grown(direction: DVec3) -> (DVec3, (f64, f64)) {
    let size = direction.abs().max_element();
    // The bits of its exponent: none below the least normal number, whose inverse is no infinity.
    let binade = f64::from_bits(size.to_bits() & f64::INFINITY.to_bits()).max(f64::MIN_POSITIVE);
    let over = 1.0 / binade;
    (direction * over, (binade, over))
}

/// How far a ray is from the cube around a normalised scene, zero in it; none if it never comes there, or is none.
#[inline]
fn entry(origin: DVec3, direction: DVec3) -> Option<f64> {
    /// A little more than the scene's, so that nothing on its faces is passed.
    const HALF: DVec3 = DVec3::splat(1.0 + 1.0 / 64.0);
    // Of no place, or nowhere.
    if !origin.is_finite() || !direction.is_finite() || direction == DVec3::ZERO {
        return None;
    }
    if origin.abs().cmple(HALF).all() {
        return Some(0.0);
    }
    // What goes along a pair of faces is between them all its way, or never; and no zero times infinity.
    let along = DVec3::select(direction.cmpeq(DVec3::ZERO), DVec3::splat(f64::MIN_POSITIVE), direction);
    let over = along.recip();
    let (one, other) = ((-HALF - origin) * over, (HALF - origin) * over);
    let (enters, leaves) = (one.min(other).max_element().max(0.0), one.max(other).min_element());
    (leaves >= enters).then_some(enters)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use proptest::prelude::*;

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
        let met = [false, true, false, false, false, false];
        assert_eq!(hits[4..].iter().map(Option::is_some).collect::<Vec<_>>(), met);
        let (answers, _) = cpu::cast(&packed, Method::Wide.into(), 1, batch.stream(), Question::Occlusion).unwrap();
        let Answers::Occlusion(shadows) = answers else { panic!("other answers") };
        assert_eq!(shadows[4..], met.map(u32::from), "what meets nothing is in no shadow");
    }

    proptest! {
        /// Directions of all sizes that there are, but those below the least normal number.
        #[test]
        fn a_direction_grows_by_a_power_of_two(mantissa in prop::array::uniform3(-1f64..1.0), exponent in -1015i32..1023) {
            let direction = DVec3::from(mantissa) * 2f64.powi(exponent);
            prop_assume!(direction.abs().max_element() >= f64::MIN_POSITIVE);
            let (up, (binade, over)) = grown(direction);
            prop_assert!((1.0..2.0).contains(&up.abs().max_element()), "{direction}: {up}");
            prop_assert_eq!(up * binade, direction);
            prop_assert_eq!(over * binade, 1.0);
        }

        /// As far as the nearest and the farthest of three slabs, by definition.
        #[test]
        fn a_ray_enters_the_cube_where_it_comes_to_it(
            origin in prop::array::uniform3(-3f64..3.0), direction in prop::array::uniform3(-1f64..1.0),
        ) {
            let (origin, direction) = (DVec3::from(origin), DVec3::from(direction));
            let inside = |t: f64| (origin + direction * t).abs().max_element() <= 1.0 + 1.0 / 64.0 + 1e-9;
            match entry(origin, direction) {
                Some(enters) => {
                    prop_assert!(inside(enters));
                    prop_assert!(enters == 0.0 || !inside(enters - 1e-6));
                }
                None => prop_assert!((0..2000).all(|i| !inside(f64::from(i) * 5e-3 / direction.length() - 1e-12))),
            }
        }
    }
}
