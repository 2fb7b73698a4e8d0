//! Rays and points of one's own, asked of the surfaces of a scene on the device that is asked for: many at once, in the scene's units.

mod crossings;
mod nearest;
mod on_cpu;
mod on_gpu;
mod order;
mod sink;
mod sorted;
mod surfaces;

use std::ops::Range;
use std::sync::Arc;

use eyerays_shader::stage::SHADOWED;
use glam::DVec3;

pub use self::crossings::Crossings;
use self::on_cpu::on_cpu;
use self::on_gpu::on_gpu;
pub use self::sink::{Sink, Split};
use self::sorted::Ordered;
pub use self::surfaces::Place;
use self::surfaces::Surfaces;
use crate::batch::{Hit, Ray, Rays};
use crate::cpu::{self, Follower};
use crate::error::{Error, Result};
use crate::gpu::{Caster, Chunk, Gpu};
use crate::job::Job;
use crate::method::Layout;
use crate::quality::Bvh;
use crate::scene::{Material, Mesh, ObjectNumbers, Scene, Settings};
use crate::stream::{Question, found};

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
/// assert!(hits[9].is_some_and(|hit| hit.t < 1.0));
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct Queries {
    surfaces: Arc<Surfaces>,
    caster: Option<Arc<Caster>>,
}

/// Rays that a CPU follows before it is heard of them: enough for all of its threads, in some hundred megabytes at most.
const MOST_RAYS: usize = 1 << 20;

/// Who hears how many rays are answered, in the thread that asks, and may end it by an error.
pub type Heard<'h, E> = dyn FnMut(usize) -> std::result::Result<(), E> + 'h;

impl Queries {
    /// Of all surfaces of a scene, whatever they are made of and whoever sees them, on the CPU, with `threads` threads (0: one a core).
    ///
    /// # Errors
    /// As [`Job::new`], or the threads can't be had.
    pub fn new(scene: &Scene, quality: Bvh, threads: usize) -> Result<Queries> {
        let threads = cpu::pool(threads)?;
        let bare = bare(scene);
        let job = threads.install(|| Job::new(&bare, Settings::default(), quality.quality()))?;
        let surfaces = Surfaces::new(job, ObjectNumbers::of(scene), threads);
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

    /// The most rays, or points, that are worth giving to [`Queries::crossings`] or [`Queries::nearest`] at once.
    pub fn most_rays(&self) -> usize {
        MOST_RAYS
    }

    /// What each of `count` rays meets first.
    ///
    /// # Errors
    /// What a GPU reports.
    pub fn closest(&self, count: usize, ray: impl Fn(usize) -> Ray + Sync) -> Result<Vec<Option<Hit>>> {
        let mut hits = vec![None; count];
        self.closest_into(count, &ray, &mut hits[..], &mut |_| Ok::<_, Error>(()))?;
        Ok(hits)
    }

    /// The same, told to a sink, which has a part for each ray. Of a call that fails it has some answers.
    ///
    /// # Errors
    /// What a GPU reports, or who hears.
    ///
    /// # Panics
    /// If a slice is the sink and has another length.
    pub fn closest_into<E: From<Error>>(
        &self,
        count: usize,
        rays: &impl Rays,
        sink: impl Sink<Option<Hit>>,
        heard: &mut Heard<'_, E>,
    ) -> std::result::Result<(), E> {
        let surfaces = &*self.surfaces;
        let tell = |chunk: &Chunk<'_>, rays: Range<usize>| {
            let records = bytemuck::cast_slice(chunk.bytes);
            rays.map(|ray| surfaces.hit(&chunk.measures[ray], &found(records, ray, chunk.row))).collect()
        };
        let ask = |follower: &Follower, rays: &Ordered<'_, _>, range: Range<usize>, hits: &mut [Option<Hit>]| {
            follower.closest(rays, range, |measures, found| {
                let both = measures.iter().zip(found);
                hits.iter_mut().zip(both).for_each(|(hit, (measure, found))| *hit = surfaces.hit(measure, found));
            });
        };
        match self.gpu(count) {
            Some(caster) => on_gpu(surfaces, (caster, Question::Closest), (count, rays), tell, sink, heard),
            None => on_cpu(surfaces, (count, rays), (None, ask), sink, heard),
        }
    }

    /// The object of a hit by its place in [`Scene::objects`](crate::scene::Scene::objects), and which of the object's primitives it is. A scene
    /// whose objects were left out has none.
    pub fn surface(&self, hit: &Hit) -> Option<(u32, u32)> {
        self.surfaces.surface(hit)
    }

    /// Where a hit is that these surfaces have told, or others of the same scene and quality: others' records lie elsewhere.
    pub fn place(&self, hit: &Hit) -> Option<Place> {
        self.surfaces.place(hit)
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
        let mut met = vec![false; count];
        self.any_into(count, &ray, &mut met[..], &mut |_| Ok::<_, Error>(()))?;
        Ok(met)
    }

    /// The same, told to a sink.
    ///
    /// # Errors
    /// As [`Queries::closest_into`].
    ///
    /// # Panics
    /// As that.
    pub fn any_into<E: From<Error>>(
        &self,
        count: usize,
        rays: &impl Rays,
        sink: impl Sink<bool>,
        heard: &mut Heard<'_, E>,
    ) -> std::result::Result<(), E> {
        let tell = |chunk: &Chunk<'_>, rays: Range<usize>| {
            let shadows: &[u32] = bytemuck::cast_slice(chunk.bytes);
            shadows[rays].iter().map(|&shadow| shadow == SHADOWED).collect()
        };
        let ask = |follower: &Follower, rays: &Ordered<'_, _>, range: Range<usize>, met: &mut [bool]| {
            follower.any(rays, range, |shadows| {
                met.iter_mut().zip(shadows).for_each(|(met, &shadow)| *met = shadow == SHADOWED);
            });
        };
        match self.gpu(count) {
            Some(caster) => on_gpu(&self.surfaces, (caster, Question::Occlusion), (count, rays), tell, sink, heard),
            None => on_cpu(&self.surfaces, (count, rays), (false, ask), sink, heard),
        }
    }

    /// All triangles that each ray of a range crosses before its end, the nearest first; of several that are equally far, those of lower
    /// numbers first. A ray through an edge or a vertex crosses one of the triangles there where the surface goes through it, and two or
    /// none where it is only touched, so that it crosses a closed mesh an even number of times from outside. Spheres and disks are crossed by none.
    ///
    /// # Errors
    /// What a GPU reports.
    pub fn crossings(&self, range: Range<usize>, rays: &impl Rays) -> Result<Crossings> {
        Crossings::found(self, range, rays)
    }

    /// Where triangles come nearest to each of `count` points. One that is nowhere is near to none. A hit's distance is that of the point in the
    /// scene's units, and the error of its place bounds how much nearer any other triangle is. Which of several it is that are equally near but
    /// for rounding is left to that; what is told of it is in double precision.
    ///
    /// # Errors
    /// What a GPU reports.
    pub fn nearest(&self, count: usize, point: impl Fn(usize) -> DVec3 + Sync) -> Result<Vec<Option<(Hit, Place)>>> {
        nearest::nearest(self, count, &point)
    }

    /// What the distance between neighbouring numbers of single precision is in the scene, at its farthest from its middle: a roundoff of
    /// places, in the scene's units.
    pub fn roundoff(&self) -> f64 {
        f64::from(f32::EPSILON) / 2.0 / self.surfaces.job.normalisation().scale
    }

    /// The GPU, if there is one and something to ask.
    fn gpu(&self, count: usize) -> Option<&Caster> {
        self.caster.as_deref().filter(|_| count > 0)
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
