//! Rays and points of one's own, asked of the surfaces of a scene on the device that is asked for: many at once, in the scene's units.

mod coherence;
mod crossings;
mod hits;
mod nearest;

use std::ops::Range;
use std::sync::Arc;

use eyerays_shader::stage::{Found, SHADOWED};
use glam::DVec3;

pub use self::crossings::Crossings;
pub use self::hits::{Hits, Place};
use self::hits::{Met, Surfaces};
pub use self::nearest::Nearest;
use crate::batch::{Measure, Ray, placed};
use crate::cpu;
use crate::error::{Error, Result};
use crate::gpu::{Caster, Chunk, Gpu};
use crate::job::Job;
use crate::method::{Layout, Method};
use crate::quality::Bvh;
use crate::scene::{Material, Mesh, ObjectNumbers, Scene, Settings};
use crate::stream::{Question, StreamRay, found};

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
/// assert!(hits.hit(9).is_some_and(|hit| hit.t < 1.0));
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct Queries {
    surfaces: Arc<Surfaces>,
    caster: Option<Arc<Caster>>,
}

/// Rays that are followed at once: enough for all of a GPU, and for neighbours that share what a CPU has in its caches, in some hundred
/// megabytes at most.
const MOST_RAYS: usize = 1 << 20;

/// Who is told `T` of a block of rays.
pub type Tell<'t, T, E> = dyn FnMut(Range<usize>, &T) -> std::result::Result<(), E> + Send + 't;

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

    /// The most rays that are worth asking for at once.
    pub fn most_rays(&self) -> usize {
        MOST_RAYS
    }

    /// What each of `count` rays meets first.
    ///
    /// # Errors
    /// What a GPU reports.
    pub fn closest(&self, count: usize, ray: impl Fn(usize) -> Ray + Sync) -> Result<Hits> {
        let mut all = Vec::with_capacity(count);
        self.closest_each(count, &ray, &mut |_, hits| {
            all.extend_from_slice(hits.met());
            Ok(())
        })?;
        Ok(Hits::new(self.surfaces.clone(), all))
    }

    /// The same in blocks of neighbours, told of one after the other: a GPU traces the next meanwhile. Hits are numbered from the first ray of
    /// their block.
    ///
    /// # Errors
    /// What a GPU reports, or who is told, which ends it.
    pub fn closest_each<E: From<Error> + Send>(
        &self,
        count: usize,
        ray: &(impl Fn(usize) -> Ray + Sync),
        tell: &mut Tell<'_, Hits, E>,
    ) -> std::result::Result<(), E> {
        let Surfaces { job, threads, .. } = &*self.surfaces;
        let placed = |i| placed(job.normalisation(), &ray(i));
        let mut hits = Hits::new(self.surfaces.clone(), Vec::new());
        threads.install(|| match self.caster(count) {
            Some(caster) => {
                caster.ask(Question::Closest, count, &placed, &mut |Chunk { rays, measures, bytes, row }| {
                    let records = bytemuck::cast_slice(bytes);
                    let met = |i: usize| self.surfaces.met(&measures[i], &found(records, i, row));
                    hits.fill(rays.len(), met);
                    tell(rays, &hits)
                })
            }
            None => blocks(count).try_for_each(|block| {
                let placed = |i| placed(block.start + i);
                let method = method(block.len(), |i| placed(i).0);
                hits.fill(block.len(), |_| Met::NOTHING);
                let keep = |measure: &Measure, found: &Found<f32>| self.surfaces.met(measure, found);
                cpu::closest_here(job, method, placed, hits.met_mut(), keep);
                tell(block, &hits)
            }),
        })
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
        let mut all = Vec::with_capacity(count);
        self.any_each(count, &ray, &mut |_, met| {
            all.extend_from_slice(met);
            Ok::<_, Error>(())
        })?;
        Ok(all)
    }

    /// The same in blocks of neighbours, as [`Queries::closest_each`].
    ///
    /// # Errors
    /// As [`Queries::closest_each`].
    pub fn any_each<E: From<Error> + Send>(
        &self,
        count: usize,
        ray: &(impl Fn(usize) -> Ray + Sync),
        tell: &mut Tell<'_, [bool], E>,
    ) -> std::result::Result<(), E> {
        let Surfaces { job, threads, .. } = &*self.surfaces;
        let placed = |i| placed(job.normalisation(), &ray(i));
        let mut met = Vec::new();
        threads.install(|| match self.caster(count) {
            Some(caster) => caster.ask(Question::Occlusion, count, &placed, &mut |Chunk { rays, bytes, .. }| {
                met.clear();
                let shadows: &[u32] = bytemuck::cast_slice(bytes);
                met.extend(shadows[..rays.len()].iter().map(|&shadow| shadow == SHADOWED));
                tell(rays, &met)
            }),
            None => blocks(count).try_for_each(|block| {
                let placed = |i| placed(block.start + i).0;
                met.resize(block.len(), false);
                cpu::any_here(job, method(block.len(), placed), placed, &mut met);
                tell(block, &met)
            }),
        })
    }

    /// All triangles that each of `count` rays crosses before its end, the nearest first; of several that are equally far, those of lower
    /// numbers first. A ray through an edge or a vertex crosses one of the triangles there where the surface goes through it, and two or
    /// none where it is only touched, so that it crosses a closed mesh an even number of times from outside. Spheres and disks are crossed by none.
    ///
    /// # Errors
    /// What a GPU reports.
    pub fn crossings(&self, count: usize, ray: impl Fn(usize) -> Ray + Sync) -> Result<Crossings> {
        Crossings::found(self, count, &ray)
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
    fn caster(&self, count: usize) -> Option<&Caster> {
        self.caster.as_deref().filter(|_| count > 0)
    }
}

/// Rays in blocks of [`MOST_RAYS`].
fn blocks(count: usize) -> impl Iterator<Item = Range<usize>> {
    (0..count).step_by(MOST_RAYS).map(move |start| start..count.min(start + MOST_RAYS))
}

/// How a CPU follows rays fastest.
fn method(count: usize, ray: impl Fn(usize) -> StreamRay) -> Method {
    if coherence::are_coherent(count, ray) { Method::Packet } else { Method::Wide }
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
