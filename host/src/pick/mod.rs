//! What a pixel shows: the object, its material and the place, for those who point at a picture.

mod names;
mod text;

use std::sync::Mutex;

use eyerays_kernels_cpu::Records;
use eyerays_shader::geometry::SurfaceInteraction;
use eyerays_shader::real::V3;
use eyerays_shader::scene::TraceContext;
use eyerays_shader::stage::{Found, Segment};
use glam::Vec3;
use serde::Serialize;

pub use names::{Named, Names, Shared, Surface};

use crate::cpu::{Observer, Renderer};
use crate::device_scene::Feature;
use crate::error::Result;
use crate::job::Job;
use crate::method::Method;
use crate::scene::{Camera, Scene};
use crate::trail::{self, Aim};
use crate::view::View;

/// What a ray of the camera sees.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Pick {
    /// Which primitive it is, of which object, and of what it is made.
    pub surface: Surface,
    /// How far it is from where the ray starts, in the scene's units.
    pub distance: f64,
    /// Where on the surface, see [`trail::Place`].
    pub coordinates: (f32, f32),
    /// Where in the world.
    pub position: Vec3,
    /// The unit normal of the surface itself, on the viewer's side.
    pub normal: Vec3,
    /// That which it is shaded by, with what vertices and textures say of it, likewise.
    pub shading_normal: Vec3,
    /// Is it seen from its front?
    pub is_front: bool,
    /// A bound of how far rounding has moved the place off the surface, in the scene's units: rays that leave start so far off.
    pub error: f64,
}

/// What the middle of a pixel of a camera's picture shows, if it shows anything: as layers tell it, so with a pinhole instead of a lens,
/// and as the shutter opens. The job is of the scene; its size is that of the picture.
///
/// ```
/// # use eyerays::{job::Job, pick::pick, quality::Bvh, scene_io};
/// # fn main() -> eyerays::error::Result<()> {
/// let (scene, _) = scene_io::load("../scenes/cornell.toml".as_ref())?;
/// let job = Job::new(&scene, scene.settings, Bvh::Medium.quality())?;
/// if let Some(seen) = pick(&job, &scene, &scene.cameras[0], 256, 400)? {
///     println!("{} at {}", seen.surface.material.name, seen.position);
/// }
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// There is no such pixel, or as [`View::new`].
pub fn pick(job: &Job, scene: &Scene, camera: &Camera, x: u32, y: u32) -> Result<Option<Pick>> {
    pick_by(job, &Names::of(scene), camera, Aim::middle(x, y))
}

/// The same by any ray of the camera, and for many of them with names that are made once.
///
/// # Errors
/// As [`pick`], and there is no such sample.
pub fn pick_by(job: &Job, names: &Names<'_>, camera: &Camera, aim: Aim) -> Result<Option<Pick>> {
    let (placed, view) = aim.sight(job, camera, Feature::Place)?;
    let picker = Picker { job: &placed, aim, picked: Mutex::new(None) };
    colour(&placed, &view, aim, &picker)?;
    let Some((primitive, pick)) = picker.picked.into_inner().expect("no thread has panicked") else {
        return Ok(None);
    };
    let (shaded, view) = aim.sight(job, camera, Feature::Normal)?;
    let shading_normal = colour(&shaded, &view, aim, &())?.into();
    Ok(Some(pick(names.surface(primitive), shading_normal)))
}

/// What a picture of a job has in one pixel.
fn colour(job: &Job, view: &View, aim: Aim, observer: &dyn Observer<f32>) -> Result<[f32; 3]> {
    let view = view.part(aim.pixel(), view.range())?;
    // The method of nodes that every scene has: wide ones may take long to make.
    let renderer = Renderer::new(job, Method::IfIf, 1)?;
    Ok(renderer.render::<f32>(&view, &|_| (), observer)?.0.pixels[0])
}

/// A pick that waits for what is told elsewhere: the surface, and its shading normal.
type Waiting = Box<dyn FnOnce(Surface, Vec3) -> Pick + Send>;

/// Looks at what a launch has found for a pixel.
struct Picker<'a> {
    job: &'a Job,
    aim: Aim,
    /// With the number of the primitive.
    picked: Mutex<Option<(usize, Waiting)>>,
}

impl Observer<f32> for Picker<'_> {
    fn wave(&self, scene: &TraceContext<'_>, slots: &[u32], records: &Records<f32>) {
        let Some(slot) = trail::slot_of(scene, slots, self.aim) else { return };
        let found = Found::<f32>::load(&scene.base, slot, &records.hits);
        if !found.is_nothing() {
            let ray = Segment::<f32>::load(scene.base.frame.slots, slot, &records.paths).ray().at(found.time);
            let ruler = trail::ruler(self.job, scene, slot, &ray);
            let picked = picked(self.job, scene, &found, ray.direction, ruler.distance(found.t.into()));
            self.picked.lock().expect("no thread has panicked").get_or_insert(picked);
        }
    }
}

/// What is at a hit, and the primitive's number.
fn picked(
    job: &Job,
    scene: &TraceContext<'_>,
    found: &Found<f32>,
    direction: V3<f32>,
    distance: f64,
) -> (usize, Waiting) {
    let primitive = scene.base.placed(found.index, found.instance, found.time);
    let at = SurfaceInteraction::new(scene.base.spec.effects, &primitive, found.coordinates, direction);
    let vector = |v: V3<f32>| Vec3::new(v.x, v.y, v.z);
    let normalisation = *job.normalisation();
    let coordinates = found.coordinates;
    let of = move |surface, shading_normal| Pick {
        surface,
        distance,
        coordinates,
        position: normalisation.in_world(vector(at.position)),
        normal: vector(at.normal),
        shading_normal,
        is_front: at.front,
        error: f64::from(at.error_offset) / normalisation.scale,
    };
    (primitive.number() as usize, Box::new(of))
}
