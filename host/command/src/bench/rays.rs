//! The rays that are measured: made once a view, on the CPU, in exact arithmetic by the kernels' own code, so
//! that every device, method and other program traces the same.

use std::borrow::Cow;

use eyerays_shader::camera::{self, CameraRay, Pixel};
use eyerays_shader::data::{BOX_PADDING, Frame, Launch, Order as OrderBits, Primitive};
use eyerays_shader::geometry::SurfaceInteraction;
use eyerays_shader::light::ray_to_light;
use eyerays_shader::material::{reflect, refract};
use eyerays_shader::ray::Ray;
use eyerays_shader::real::V3;
use glam::{UVec4, Vec3};
use rayon::prelude::*;

use super::{Kind, sample};
use crate::error::Result;
use eyerays::cpu;
use eyerays::job::Job;
use eyerays::method::{Coherence, Order, Processor, Traversal};
use eyerays::stream::{Answers, Question, Stream, StreamRay};
use eyerays::view::View;

/// Ambient occlusion rays a hit.
pub const AO_RAYS: u32 = 4;
/// The index of refraction of every surface that rays of [`Kind::Refraction`] pass.
pub const IOR: f32 = 1.5;
/// The most rays of a kind: 2 GiB of them.
pub const MOST_RAYS: usize = 1 << 26;
/// Length of ambient occlusion rays as a share of the scene's diagonal, where none is given.
pub const AO_SHARE: f64 = 0.2;

/// Hits whose rays a task makes.
const TASK: usize = 4096;

/// A camera's rays, one a pixel, in an order of the pixels.
#[derive(Clone, Copy)]
pub struct CameraRays {
    frame: Frame,
    order: OrderBits,
}

impl CameraRays {
    /// Those of a view with one sample a pixel.
    pub fn of(scene: &Job, view: &View, order: Order) -> CameraRays {
        CameraRays { frame: view.launch(scene, view.region(), 0, 1, order.bits()), order: order.bits() }
    }

    /// The pixels of its slots in order.
    fn pixels(&self) -> impl Iterator<Item = Pixel> + '_ {
        let slots = 0..self.frame.slots;
        slots.map(|slot| camera::pixel(&self.frame, self.order, slot)).filter(|pixel| pixel.inside)
    }
}

/// The diagonal of the box around a scene's primitives, in the normalised scene.
pub fn diagonal(packed: &Job) -> f64 {
    let extent = |p: &Primitive| match p.is_triangle() {
        true => p.vertices().into_iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, g), v| (l.min(v), g.max(v))),
        false => (p.bounds().0 + Vec3::splat(BOX_PADDING), p.bounds().1 - Vec3::splat(BOX_PADDING)),
    };
    let nowhere = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let all = packed.primitives().iter().map(extent);
    let (least, greatest) = all.fold(nowhere, |(l, g), (least, greatest)| (l.min(least), g.max(greatest)));
    (greatest.as_dvec3() - least.as_dvec3()).length()
}

/// What a view sees: its primary rays and their hits, where rays of every other kind start.
pub struct PrimaryHits<'a> {
    packed: &'a Job,
    primary: Stream,
    /// By primary ray: where its pixel lies in the image.
    pixels: Vec<u32>,
    /// By primary ray, as [`Answers::Closest`].
    hits: Vec<UVec4>,
    threads: usize,
}

/// A hit that rays go on from.
struct Place {
    pixel: u32,
    direction: V3<f32>,
    contact: SurfaceInteraction<f32>,
}

impl Place {
    fn ray(&self, origin: V3<f32>, direction: V3<f32>, limit: f32) -> StreamRay {
        StreamRay {
            origin: vector(origin),
            direction: vector(direction),
            limit,
            source_primitive: self.contact.source_primitive(direction),
        }
    }

    fn reflected(&self) -> StreamRay {
        let mirrored = reflect(self.direction, self.contact.normal);
        self.ray(self.contact.offset_ray_origin(mirrored), mirrored, f32::MAX)
    }

    fn refracted(&self) -> Option<StreamRay> {
        let eta = self.contact.relative_ior(IOR);
        let passed = refract(self.direction, self.contact.normal, eta);
        let inwards = passed.direction.normalised().0;
        (!passed.total).then(|| self.ray(self.contact.offset_ray_origin_along(inwards), inwards, f32::MAX))
    }

    /// A sample by the cosine; the kinds that take some differ in their seed.
    fn sampled(&self, sample: u32, kind: Kind, limit: f32) -> StreamRay {
        let direction = sample::about(self.contact.normal, sample::cosine(self.pixel, sample, kind as u32));
        self.ray(self.contact.offset_ray_origin(direction), direction, limit)
    }
}

fn vector(v: V3<f32>) -> Vec3 {
    Vec3::new(v.x, v.y, v.z)
}

impl<'a> PrimaryHits<'a> {
    /// Makes the primary rays and traces them, with `threads` threads (0: one a core).
    ///
    /// # Errors
    /// If the threads can't be had.
    pub fn new(packed: &'a Job, view: &CameraRays, threads: usize) -> Result<Self> {
        let pixels: Vec<Pixel> = view.pixels().collect();
        let rays: Vec<StreamRay> = pixels
            .par_iter()
            .map(|&pixel| {
                // Through the middles of pixels and lenses.
                let launch = Launch(Launch::PARALLEL | Launch::ROUND);
                let CameraRay { origin, direction, .. } = camera::ray::<f32>(&view.frame, launch, &[], pixel);
                let (origin, direction) = (vector(Ray::from_afar(origin, direction).origin), vector(direction));
                StreamRay { origin, direction, limit: f32::MAX, source_primitive: StreamRay::NOWHERE }
            })
            .collect();
        let primary = Stream::new(rays.into_iter());
        let traversal = Traversal::default().resolved(Processor::Cpu, Coherence::Primary);
        let (answers, _) = cpu::cast(packed, traversal, threads, &primary, Question::Closest)?;
        let Answers::Closest(hits) = answers else { unreachable!("this was asked for the closest hits") };
        Ok(PrimaryHits { packed, primary, pixels: pixels.iter().map(|p| p.index).collect(), hits, threads })
    }

    /// How many primary rays hit something.
    pub fn hits(&self) -> usize {
        self.hits.iter().filter(|hit| hit.w != StreamRay::NOWHERE).count()
    }

    /// How many lights rays of [`Kind::Shadow`] go to: all, unless there are so many that these would be more
    /// than [`MOST_RAYS`].
    pub fn lights(&self) -> usize {
        self.packed.lights().len().min(MOST_RAYS / self.hits().max(1))
    }

    /// The rays of a kind in the order of slots, those of a hit beside each other; but shadow rays go to one
    /// light after the other, as launches ask. `ao_length` is in the normalised scene.
    ///
    /// # Errors
    /// If the threads can't be had.
    pub fn rays(&self, kind: Kind, ao_length: f32) -> Result<Cow<'_, Stream>> {
        let parts = match kind {
            Kind::Primary => return Ok(Cow::Borrowed(&self.primary)),
            Kind::Shadow => self.shadows()?,
            Kind::Reflection => self.spawned(|place, rays| rays.push(place.reflected()))?,
            Kind::Refraction => self.spawned(|place, rays| rays.extend(place.refracted()))?,
            Kind::Ao => self.spawned(|place, rays| {
                rays.extend((0..AO_RAYS).map(|sample| place.sampled(sample, kind, ao_length)));
            })?,
            Kind::Diffuse => self.spawned(|place, rays| rays.push(place.sampled(0, kind, f32::MAX)))?,
        };
        Ok(Cow::Owned(Stream::of_parts(&parts)))
    }

    fn shadows(&self) -> Result<Vec<Vec<StreamRay>>> {
        let mut parts = Vec::new();
        for light in &self.packed.lights()[..self.lights()] {
            parts.extend(self.spawned(|place, rays| {
                let (origin, direction, limit) = ray_to_light(self.packed.effects(), light, &place.contact);
                if place.contact.faces(direction) {
                    rays.push(place.ray(origin, direction, limit));
                }
            })?);
        }
        Ok(parts)
    }

    /// What `make` adds for each hit, in order.
    fn spawned(&self, make: impl Fn(&Place, &mut Vec<StreamRay>) + Sync) -> Result<Vec<Vec<StreamRay>>> {
        let tasks = self.hits.par_chunks(TASK).enumerate().map(|(task, hits)| {
            let mut rays = Vec::new();
            for (i, hit) in hits.iter().enumerate().filter(|(_, hit)| hit.w != StreamRay::NOWHERE) {
                make(&self.place(task * TASK + i, *hit), &mut rays);
            }
            rays
        });
        Ok(cpu::pool(self.threads)?.install(|| tasks.collect()))
    }

    fn place(&self, i: usize, hit: UVec4) -> Place {
        let primitive = &self.packed.primitives()[hit.w as usize];
        let direction = V3::splat(self.primary.ray(i).direction);
        let contact = SurfaceInteraction::new(
            self.packed.effects(),
            primitive,
            (f32::from_bits(hit.y), f32::from_bits(hit.z)),
            direction,
        );
        Place { pixel: self.pixels[i], direction, contact }
    }
}
