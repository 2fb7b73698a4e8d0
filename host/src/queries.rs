//! Rays of one's own through the surfaces of a scene, on the device that is asked for: many at once, in the scene's units.

use std::sync::Arc;

use eyerays_kernels_cpu::Isa;
use eyerays_shader::geometry::SurfaceInteraction;
use eyerays_shader::real::V3;
use eyerays_shader::scene::LaunchContext;
use eyerays_shader::stage::SHADOWED;
use glam::{DVec3, Vec3};

use crate::batch::{Batch, Hit, Ray};
use crate::cpu;
use crate::error::Result;
use crate::gpu::{Caster, Gpu};
use crate::job::Job;
use crate::method::{Layout, Method, Traversal};
use crate::quality::Bvh;
use crate::scene::{Material, Mesh, ObjectNumbers, Scene, Settings};
use crate::stream::{Answers, Question};

/// The surfaces of a scene, ready for rays. Cheap to clone.
///
/// ```
/// # use eyerays::{quality::Bvh, scene_io};
/// use eyerays::batch::Ray;
/// use eyerays::queries::Queries;
/// # fn main() -> eyerays::error::Result<()> {
/// let (scene, _) = scene_io::load("../scenes/cornell.toml".as_ref())?;
/// let queries = Queries::new(&scene, Bvh::Medium, 0)?;
/// let down = |i: usize| Ray::new([0.0, 0.1 * i as f64, 0.0].into(), [0.0, -1.0, 0.0].into());
/// let hits = queries.closest(10, down)?;
/// assert!(hits.hit(9).is_some_and(|hit| hit.distance < 1.0));
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct Queries {
    surfaces: Arc<Surfaces>,
    caster: Option<Arc<Caster>>,
}

struct Surfaces {
    job: Job,
    objects: ObjectNumbers,
    threads: rayon::ThreadPool,
}

/// Rays that are followed at once: what they take of memory is some hundred megabytes at most, and a GPU has enough of them.
const MOST_RAYS: usize = 1 << 20;

impl Queries {
    /// Of all surfaces of a scene, whatever they are made of and whoever sees them, on the CPU, with `threads` threads (0: one a core).
    ///
    /// # Errors
    /// As [`Job::new`], or the threads can't be had.
    pub fn new(scene: &Scene, quality: Bvh, threads: usize) -> Result<Queries> {
        let threads = cpu::pool(threads)?;
        let bare = bare(scene);
        let job = threads.install(|| Job::new(&bare, Settings::default(), quality.quality()))?;
        let surfaces = Surfaces { job, objects: ObjectNumbers::of(scene), threads };
        Ok(Queries { surfaces: Arc::new(surfaces), caster: None })
    }

    /// The same on a GPU that is exact: the answers have the same bits.
    ///
    /// # Errors
    /// What does not fit the GPU, or what its driver reports.
    pub fn on(&self, gpu: &Gpu) -> Result<Queries> {
        let caster = Caster::new(gpu, &self.surfaces.job, Layout::Gathered)?;
        Ok(Queries { surfaces: self.surfaces.clone(), caster: Some(Arc::new(caster)) })
    }

    /// The most rays that are worth asking for at once.
    pub fn most_rays(&self) -> usize {
        MOST_RAYS
    }

    /// What each of `count` rays meets first.
    ///
    /// # Errors
    /// What a GPU reports.
    pub fn closest(&self, count: usize, ray: impl Fn(usize) -> Ray + Sync) -> Result<Hits> {
        let (batch, answers) = self.ask(count, &ray, Question::Closest)?;
        Ok(Hits { surfaces: self.surfaces.clone(), batch, answers })
    }

    /// Runs something with its threads.
    pub fn install<R: Send>(&self, run: impl FnOnce() -> R + Send) -> R {
        self.surfaces.threads.install(run)
    }

    /// Whether each of `count` rays meets anything up to its end, or a roundoff farther: what is met first is met up to its distance.
    ///
    /// # Errors
    /// What a GPU reports.
    pub fn any(&self, count: usize, ray: impl Fn(usize) -> Ray + Sync) -> Result<Vec<bool>> {
        match self.ask(count, &ray, Question::Occlusion)?.1 {
            Answers::Occlusion(shadows) => Ok(shadows.into_iter().map(|shadow| shadow == SHADOWED).collect()),
            Answers::Closest(_) => unreachable!("a device answers what it is asked"),
        }
    }

    fn ask(&self, count: usize, ray: &(impl Fn(usize) -> Ray + Sync), question: Question) -> Result<(Batch, Answers)> {
        let Surfaces { job, threads, .. } = &*self.surfaces;
        threads.install(|| {
            let batch = Batch::of(job, count, ray);
            let answers = match &self.caster {
                Some(caster) if count > 0 => {
                    let cast = caster.upload(batch.stream())?;
                    caster.trace(&cast, true, Traversal::default(), question)?;
                    caster.answers(&cast, question)?
                }
                _ => cpu::cast_here(Isa::best(), job, Method::Wide.into(), batch.stream(), question).0,
            };
            Ok((batch, answers))
        })
    }
}

/// What rays have met, by their numbers.
pub struct Hits {
    surfaces: Arc<Surfaces>,
    batch: Batch,
    answers: Answers,
}

/// Where on a surface something was met.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Where in the scene, computed from the primitive and the coordinates on it, which is nearer to the surface than a point along the
    /// ray.
    pub point: DVec3,
    /// The unit normal of the primitive's front: where a triangle's vertices go counter-clockwise, a sphere's outside, what a disk's
    /// normal is on.
    pub normal: Vec3,
    /// A bound of how far rounding has moved the point off the surface, in the scene's units.
    pub error: f64,
}

impl Hits {
    /// What a ray has met first.
    pub fn hit(&self, ray: usize) -> Option<Hit> {
        self.batch.hit(&self.surfaces.job, &self.answers, ray)
    }

    /// The object of a hit by its place in [`Scene::objects`], and which of the object's primitives it is. A scene whose objects were
    /// left out has none.
    pub fn surface(&self, hit: &Hit) -> Option<(u32, u32)> {
        let (object, within) = self.surfaces.objects.within(hit.primitive as usize)?;
        Some((object, within as u32))
    }

    /// Where a ray has met something.
    pub fn place(&self, ray: usize) -> Option<Place> {
        let job = &self.surfaces.job;
        let (record, copy) = self.batch.record(&self.answers, ray)?;
        job.primitives().get(record.w as usize)?;
        let [u, v] = [record.y, record.z].map(f32::from_bits);
        let frame = job.stream_frame(0);
        let spec = job.specialisation(&Traversal::default());
        let launch = LaunchContext::new(&frame, spec, bytemuck::cast_slice(job.primitives()), job.instances());
        let primitive = launch.placed(record.w, copy, 0.0);
        let direction = self.batch.stream().ray(ray).direction;
        let at = SurfaceInteraction::<f32>::new(spec.effects, &primitive, (u, v), V3::splat(direction));
        let vector = |v: V3<f32>| Vec3::new(v.x, v.y, v.z);
        let normalisation = job.normalisation();
        let normal = vector(at.normal);
        Some(Place {
            point: normalisation.inverse().transform_point3(vector(at.position).as_dvec3()),
            normal: if at.front { normal } else { -normal },
            error: f64::from(at.error_offset) / normalisation.scale,
        })
    }
}

/// The surfaces of a scene without what they are made of: no material, no light, nothing that moves. What is behind glass, or where a
/// picture has a hole, is behind a surface all the same.
fn bare(scene: &Scene) -> Scene {
    let mesh = Mesh {
        positions: scene.mesh.positions.clone(),
        triangles: scene.mesh.triangles.clone(),
        materials: vec![0; scene.mesh.triangles.len()],
        ..Mesh::default()
    };
    let spheres = scene.spheres.iter().map(|sphere| crate::scene::Sphere { material: 0, ..*sphere });
    let disks = scene.disks.iter().map(|disk| crate::scene::Disk { material: 0, ..*disk });
    Scene {
        shared: scene.shared.clone(),
        instances: scene.instances.clone(),
        spheres: spheres.collect(),
        disks: disks.collect(),
        ..Scene::of_mesh(mesh, Material::default())
    }
}
