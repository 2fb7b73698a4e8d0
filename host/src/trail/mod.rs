//! The way of a single ray of the camera through the hierarchy: every node that it visits and every primitive that it is tested
//! against, by any method, as on a CPU.
//!
//! Methods for packets follow the ray with those of the other pixels of its block of 8x4: the 32 lanes of a GPU's subgroup. Where things
//! move while the shutter is open, each ray has its own time and goes alone.

mod aim;
mod block;
mod counts;
mod parting;
mod record;
mod step;
mod tape;
mod text;
mod walk;
mod wide;

use std::sync::Mutex;

use eyerays_kernels_cpu::Records;
use eyerays_shader::camera;
use eyerays_shader::data::Launch;
use eyerays_shader::ray::{Hit, Ray};
use eyerays_shader::real::V3;
use eyerays_shader::scene::TraceContext;
use eyerays_shader::stage::Found;
use glam::DVec3;

pub use aim::Aim;
pub use counts::Counts;
pub(crate) use counts::counts;
pub(crate) use record::Ruler;
pub use step::{Child, Contact, Fate, Outcome, Place, Step, Target, Test, Trail, Visit};

use block::Block;
use record::Record;
use walk::Walk;

use crate::cpu::{Observer, Renderer};
use crate::device_scene::Feature;
use crate::error::{Error, Result};
use crate::job::Job;
use crate::method::{Coherence, Method, Processor, Traversal};
use crate::pick::Names;
use crate::scene::{Camera, Scene};
use crate::view::Region;

/// Follows a ray of a camera by a method, and keeps all its steps. [`Method::Auto`] is what a CPU takes for the camera's rays.
///
/// ```
/// # use eyerays::{job::Job, method::Method, quality::Bvh, scene_io, trail};
/// # fn main() -> eyerays::error::Result<()> {
/// let (scene, _) = scene_io::load("../scenes/cornell.toml".as_ref())?;
/// let job = Job::new(&scene, scene.settings, Bvh::Medium.quality())?;
/// let aim = trail::Aim::middle(256, 400);
/// let trail = trail::follow(&job, &scene, &scene.cameras[0], aim, Method::IfIf)?;
/// println!("{} nodes and {} triangles, down to depth {}", trail.visits(), trail.tests(), trail.deepest());
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// There is no such pixel or sample, or as [`View::new`](crate::view::View::new).
pub fn follow(job: &Job, scene: &Scene, camera: &Camera, aim: Aim, traversal: impl Into<Traversal>) -> Result<Trail> {
    let (job, view) = aim.sight(job, camera, Feature::Place)?;
    let traversal = Traversal { order: Default::default(), ..resolved(&job, traversal.into()) };
    let block = around(aim, job.settings().size);
    let names = Names::of(scene);
    let follower = Follower { aim, job: &job, method: traversal.method, names: &names, trail: Mutex::new(None) };
    let view = view.part(block, view.range())?;
    Renderer::new(&job, traversal, 1)?.render::<f32>(&view, &|_| (), &follower)?;
    let trail = follower.trail.into_inner().expect("no thread has panicked");
    trail
        .expect("a launch traces the rays of its pixels")
        .map(|trail| Trail { packet: is_packet(trail.method).then_some(block), ..trail })
}

/// Does a CPU follow several rays together by it?
pub(crate) fn is_packet(method: Method) -> bool {
    method.way().alone() != method.way()
}

/// The method that a CPU takes for the camera's rays of a job.
pub(crate) fn resolved(job: &Job, traversal: Traversal) -> Traversal {
    let traversal = traversal.resolved(Processor::Cpu, Coherence::Primary);
    let moves = job.specialisation(&traversal).launch.has(Launch::MOVING);
    let goes_alone = moves && is_packet(traversal.method);
    Traversal { method: if goes_alone { Method::IfIf } else { traversal.method }, ..traversal }
}

/// The block of pixels that holds one.
fn around(aim: Aim, (width, height): (u32, u32)) -> Region {
    let (columns, rows) = block::size();
    let (x, y) = (aim.x / columns * columns, aim.y / rows * rows);
    Region { x, y, width: columns.min(width - x), height: rows.min(height - y) }
}

/// Follows one of the rays that a launch has traced.
struct Follower<'a> {
    aim: Aim,
    job: &'a Job,
    method: Method,
    names: &'a Names<'a>,
    trail: Mutex<Option<Result<Trail>>>,
}

impl Observer<f32> for Follower<'_> {
    fn wave(&self, scene: &TraceContext<'_>, slots: &[u32], records: &Records<f32>) {
        let Some(slot) = slot_of(scene, slots, self.aim) else { return };
        let block = Block::of(scene, slots, records);
        let trail = self.follow(scene, &block, slot, records);
        self.trail.lock().expect("no thread has panicked").get_or_insert(trail);
    }
}

impl Follower<'_> {
    fn follow(&self, scene: &TraceContext<'_>, block: &Block, slot: u32, records: &Records<f32>) -> Result<Trail> {
        let (method, lane) = (self.method, slot as usize % block::LANES);
        let ruler = ruler(self.job, scene, slot, &block.ray(lane).0);
        let mut record = Record::new(lane, self.names, ruler);
        let hit = Walk::new(scene, block, &mut record).follow(method, lane);
        let (events, found) = tape::of(method, scene, block, lane);
        let rendered = Found::<f32>::load(&scene.base, slot, &records.hits);
        if events != record.events || !is_same(&hit, &found) || !is_rendered(scene, &hit, &rendered) {
            return Err(Error::new(format!(
                "the steps that are told of {method} are not those of its kernel: this is a fault of the program; report it with the scene"
            )));
        }
        let surface = || self.names.surface(hit.primitive as usize);
        let contact = ruler.place(&hit).map(|place| Contact { surface: surface(), place });
        Ok(Trail { method, packet: None, steps: record.steps, hit: contact })
    }
}

fn is_same(a: &Hit<f32>, b: &Hit<f32>) -> bool {
    (a.t.to_bits(), a.primitive_index, a.instance) == (b.t.to_bits(), b.primitive_index, b.instance)
}

/// Is a hit what a launch has found? That has followed the ray with as many others as its vectors hold: of a split triangle it may have met
/// another part.
fn is_rendered(scene: &TraceContext<'_>, hit: &Hit<f32>, found: &Found<f32>) -> bool {
    if found.is_nothing() {
        return hit.primitive_index == Hit::<f32>::NOTHING;
    }
    let primitive = scene.base.placed(found.index, found.instance, found.time).number();
    (hit.t.to_bits(), hit.primitive, hit.instance) == (found.t.to_bits(), primitive, found.instance)
}

/// The slot of a launch that follows the ray of a pixel.
pub(crate) fn slot_of(scene: &TraceContext<'_>, slots: &[u32], aim: Aim) -> Option<u32> {
    let frame = scene.base.frame;
    slots.iter().copied().find(|&slot| {
        let pixel = camera::pixel(frame, block::ORDER, slot);
        (frame.left + pixel.x, frame.top + pixel.y) == (aim.x, aim.y)
    })
}

/// Measures along the ray of a slot, from where the camera's ray starts: that of a camera far from the scene is followed from near it on.
pub(crate) fn ruler(job: &Job, scene: &TraceContext<'_>, slot: u32, ray: &Ray<f32>) -> Ruler {
    let (frame, launch) = (scene.base.frame, job.specialisation(&Traversal::default()).launch);
    let pixel = camera::pixel(frame, block::ORDER, slot);
    let mut own = camera::ray::<f32>(frame, launch, job.optic_tables(), pixel);
    if launch.has(Launch::PANNED) {
        own = camera::panned(frame, job.instances(), ray.time, own);
    }
    let vector = |v: V3<f32>| DVec3::new(v.x.into(), v.y.into(), v.z.into());
    let scale = job.normalisation().scale;
    Ruler { start: (vector(ray.origin) - vector(own.origin)).length() / scale, scale }
}

#[cfg(test)]
mod tests;
