//! Rays and points of one's own, asked of the surfaces of a scene on the device that is asked for: many at once, in the scene's units.

mod coherence;
mod crossings;
mod hits;
mod nearest;
mod sink;

use std::ops::Range;
use std::sync::Arc;

use eyerays_shader::data::Primitive;
use eyerays_shader::stage::SHADOWED;
use glam::DVec3;

pub use self::crossings::Crossings;
pub use self::hits::{Answered, Hits, Place};
use self::hits::{Numbers, Surfaces};
pub use self::nearest::Nearest;
use self::sink::{Parts, divided};
pub use self::sink::{Sink, Split};
use crate::batch::{Hit, Ray, Rays};
use crate::cpu::{self, Follower};
use crate::error::{Error, Result};
use crate::gpu::{Caster, Chunk, Gpu};
use crate::job::Job;
use crate::method::{Layout, Method};
use crate::quality::Bvh;
use crate::scene::{Material, Mesh, ObjectNumbers, Scene, Settings};
use crate::stream::Question;

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
    gpu: Option<Arc<OnGpu>>,
}

/// What there is of a scene on a GPU, and the numbers of its primitives.
struct OnGpu {
    caster: Caster,
    numbers: Vec<u32>,
}

/// Rays that are followed at once: enough for all of a GPU, and for neighbours that share what a CPU has in its caches, in some hundred
/// megabytes at most.
const MOST_RAYS: usize = 1 << 20;

/// Who hears how many rays are answered, and may end it by an error.
pub type Heard<'h, E> = dyn FnMut(usize) -> std::result::Result<(), E> + Send + 'h;

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
        Ok(Queries { surfaces: Arc::new(surfaces), gpu: None })
    }

    /// The same on a GPU that is exact: the answers have the same bits.
    ///
    /// # Errors
    /// What does not fit the GPU, or what its driver reports.
    pub fn on(&self, gpu: &Gpu) -> Result<Queries> {
        let caster = Caster::new(gpu, &self.surfaces.job, Layout::Gathered)?;
        let numbers = self.surfaces.job.primitives().iter().map(Primitive::number).collect();
        Ok(Queries { surfaces: self.surfaces.clone(), gpu: Some(Arc::new(OnGpu { caster, numbers })) })
    }

    /// The most rays that are worth asking for at once.
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

    /// The same, told to a sink.
    ///
    /// # Errors
    /// What a GPU reports, or who hears.
    pub fn closest_into<E: From<Error> + Send>(
        &self,
        count: usize,
        rays: &impl Rays,
        sink: impl for<'a> Sink<Hits<'a>>,
        heard: &mut Heard<'_, E>,
    ) -> std::result::Result<(), E> {
        let (surfaces, of_records) = (&*self.surfaces, Numbers::Records(self.surfaces.job.primitives()));
        surfaces.threads.install(|| match self.gpu(count) {
            Some(OnGpu { caster, numbers }) => {
                let ask = (caster, Question::Closest);
                in_chunks(ask, (count, rays), sink, heard, |chunk, rays, sink| {
                    let (records, copies) = bytemuck::cast_slice(chunk.bytes).split_at(chunk.row);
                    let copies = copies.get(rays.clone()).unwrap_or_default();
                    let (numbers, measures) = (Numbers::Table(numbers), &chunk.measures[rays.clone()]);
                    sink.take(&Hits { surfaces, numbers, measures, records: &records[rays], copies });
                })
            }
            None => self.in_blocks((count, rays), sink, heard, |follower, block, sink| {
                follower.closest(rays, block, |measures, (records, copies)| {
                    sink.take(&Hits { surfaces, numbers: of_records, measures, records, copies });
                });
            }),
        })
    }

    /// The object of a hit by its place in [`Scene::objects`](crate::scene::Scene::objects), and which of the object's primitives it is. A scene
    /// whose objects were left out has none.
    pub fn surface(&self, hit: &Hit) -> Option<(u32, u32)> {
        self.surfaces.surface(hit)
    }

    /// Where a hit of these surfaces is.
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
    pub fn any_into<E: From<Error> + Send>(
        &self,
        count: usize,
        rays: &impl Rays,
        sink: impl Sink<[bool]>,
        heard: &mut Heard<'_, E>,
    ) -> std::result::Result<(), E> {
        self.surfaces.threads.install(|| match self.gpu(count) {
            Some(OnGpu { caster, .. }) => {
                let ask = (caster, Question::Occlusion);
                in_chunks(ask, (count, rays), sink, heard, |chunk, rays, sink| {
                    let shadows: &[u32] = bytemuck::cast_slice(chunk.bytes);
                    sink.take(&are_shadowed(&shadows[rays]));
                })
            }
            None => self.in_blocks((count, rays), sink, heard, |follower, block, sink| {
                follower.any(rays, block, |shadows| sink.take(&are_shadowed(shadows)));
            }),
        })
    }

    /// All triangles that each of some rays crosses before its end, the nearest first; of several that are equally far, those of lower
    /// numbers first. A ray through an edge or a vertex crosses one of the triangles there where the surface goes through it, and two or
    /// none where it is only touched, so that it crosses a closed mesh an even number of times from outside. Spheres and disks are crossed by none.
    ///
    /// # Errors
    /// What a GPU reports.
    pub fn crossings(&self, range: Range<usize>, rays: &impl Rays) -> Result<Crossings> {
        Crossings::found(self, range, rays)
    }

    /// Where triangles come nearest to each of `count` points. One that is nowhere is near to none.
    ///
    /// # Errors
    /// What a GPU reports.
    pub fn nearest(&self, count: usize, point: impl Fn(usize) -> DVec3 + Sync) -> Result<Nearest> {
        Nearest::found(self, count, &point)
    }

    /// What the distance between neighbouring numbers of single precision is in the scene, at its farthest from its middle: a roundoff of
    /// places, in the scene's units.
    pub fn roundoff(&self) -> f64 {
        f64::from(f32::EPSILON) / 2.0 / self.surfaces.job.normalisation().scale
    }

    /// The GPU, if there is one and something to ask.
    fn gpu(&self, count: usize) -> Option<&OnGpu> {
        self.gpu.as_deref().filter(|_| count > 0)
    }

    /// Works on a CPU, with its threads.
    fn in_blocks<S: Split, E>(
        &self,
        (count, rays): (usize, &impl Rays),
        sink: S,
        heard: &mut Heard<'_, E>,
        work: impl Fn(&Follower, Range<usize>, S) + Sync,
    ) -> std::result::Result<(), E> {
        let (mut parts, job) = (Parts::of(sink), &self.surfaces.job);
        for start in (0..count).step_by(MOST_RAYS) {
            let block = start..count.min(start + MOST_RAYS);
            // How a CPU follows rays fastest.
            let is_coherent = coherence::are_coherent(rays, block.clone(), job.normalisation().scale);
            let method = if is_coherent { Method::Packet } else { Method::Wide };
            let follower = Follower::new(job, method);
            divided(block.clone(), parts.next(block.len()), &|rays, sink| work(&follower, rays, sink));
            heard(block.end)?;
        }
        Ok(())
    }
}

/// Works on what a GPU has answered, with the threads that it is called in.
fn in_chunks<S: Split, E: From<Error> + Send>(
    (caster, question): (&Caster, Question),
    (count, rays): (usize, &impl Rays),
    sink: S,
    heard: &mut Heard<'_, E>,
    work: impl Fn(&Chunk<'_>, Range<usize>, S) + Sync,
) -> std::result::Result<(), E> {
    let mut parts = Parts::of(sink);
    caster.ask(question, (count, rays), &mut |chunk| {
        let rays = chunk.rays.len();
        divided(0..rays, parts.next(rays), &|rays, sink| work(&chunk, rays, sink));
        heard(chunk.rays.end)
    })
}

fn are_shadowed(shadows: &[u32]) -> Vec<bool> {
    shadows.iter().map(|&shadow| shadow == SHADOWED).collect()
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
