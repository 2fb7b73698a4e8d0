//! What rays have met, where that is, and of which object.

use std::sync::Arc;

use eyerays_shader::data::{Frame, Primitive, Specialisation};
use eyerays_shader::geometry::SurfaceInteraction;
use eyerays_shader::real::V3;
use eyerays_shader::scene::LaunchContext;
use eyerays_shader::stage::Found;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::batch::{Hit, Measure};
use crate::job::Job;
use crate::method::Traversal;
use crate::scene::ObjectNumbers;
use crate::stream::StreamRay;

/// A scene that is ready for rays.
pub(super) struct Surfaces {
    pub job: Job,
    pub objects: ObjectNumbers,
    pub threads: rayon::ThreadPool,
    /// Of a launch, for [`Surfaces::primitive`].
    frame: Frame,
    spec: Specialisation,
}

impl Surfaces {
    pub fn new(job: Job, objects: ObjectNumbers, threads: rayon::ThreadPool) -> Self {
        let (frame, spec) = (job.stream_frame(0), job.specialisation(&Traversal::default()));
        Surfaces { job, objects, threads, frame, spec }
    }

    /// The object of a primitive by its place in [`Scene::objects`](crate::scene::Scene::objects), and which of the object's it is.
    pub fn surface(&self, primitive: u32) -> Option<(u32, u32)> {
        let (object, within) = self.objects.within(primitive as usize)?;
        Some((object, within as u32))
    }

    /// What a ray has met, by what a kernel has found.
    pub fn met(&self, measure: &Measure, found: &Found<f32>) -> Met {
        let Found { coordinates: (u, v), index, instance, .. } = *found;
        let number = self.job.primitives().get(index as usize).map_or(StreamRay::NOWHERE, Primitive::number);
        let copy = self.job.instances().get(instance as usize);
        let primitive = copy.map_or(number, |copy| copy.number(number));
        Met { t: measure.t(found.t), coordinates: [u, v], index, instance, primitive }
    }

    /// A primitive by its place among all and the copy of a mesh that it is in, where that has it.
    pub fn primitive(&self, (index, instance): (u32, u32)) -> Option<Primitive> {
        self.job.primitives().get(index as usize)?;
        let primitives = bytemuck::cast_slice(self.job.primitives());
        let launch = LaunchContext::new(&self.frame, self.spec, primitives, self.job.instances());
        Some(launch.placed(index, instance, 0.0))
    }

    /// Where something was met.
    pub fn place(&self, met: &Met) -> Option<Place> {
        let primitive = self.primitive((met.index, met.instance))?;
        Some(self.place_on(&primitive, met.coordinates))
    }

    /// A place on a primitive.
    pub fn place_on(&self, primitive: &Primitive, [u, v]: [f32; 2]) -> Place {
        let at = SurfaceInteraction::<f32>::new(self.spec.effects, primitive, (u, v), V3::splat(LOOK));
        let vector = |v: V3<f32>| Vec3::new(v.x, v.y, v.z);
        let normalisation = self.job.normalisation();
        let normal = vector(at.normal);
        Place {
            point: normalisation.inverse().transform_point3(vector(at.position).as_dvec3()),
            normal: if at.front { normal } else { -normal },
            error: f64::from(at.error_offset) / normalisation.scale,
        }
    }
}

/// Any direction will do: which side of a primitive is its front does not depend on who looks.
const LOOK: Vec3 = Vec3::new(0.48, 0.6, 0.64);

/// What a ray has met: nothing where the index is that of nothing.
#[derive(Clone, Copy)]
pub(super) struct Met {
    t: f64,
    coordinates: [f32; 2],
    index: u32,
    instance: u32,
    /// Its number, which is asked for while its record is in a cache.
    primitive: u32,
}

impl Met {
    /// Nothing.
    pub const NOTHING: Met = Met {
        t: f64::INFINITY,
        coordinates: [0.0; 2],
        index: StreamRay::NOWHERE,
        instance: StreamRay::NOWHERE,
        primitive: StreamRay::NOWHERE,
    };

    /// What it is, if it is anything.
    pub fn hit(&self) -> Option<Hit> {
        let Met { t, coordinates, primitive, .. } = *self;
        (self.index != StreamRay::NOWHERE).then_some(Hit { t, primitive, coordinates })
    }
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

/// What rays have met, by their numbers.
pub struct Hits {
    surfaces: Arc<Surfaces>,
    met: Vec<Met>,
}

impl Hits {
    pub(super) fn new(surfaces: Arc<Surfaces>, met: Vec<Met>) -> Self {
        Hits { surfaces, met }
    }

    /// Other hits in their place, made by many threads in memory that is there.
    pub(super) fn fill(&mut self, count: usize, met: impl Fn(usize) -> Met + Sync) {
        self.met.resize(count, Met::NOTHING);
        self.met.par_iter_mut().enumerate().for_each(|(i, to)| *to = met(i));
    }

    pub(super) fn met(&self) -> &[Met] {
        &self.met
    }

    pub(super) fn met_mut(&mut self) -> &mut [Met] {
        &mut self.met
    }

    /// What a ray has met first.
    pub fn hit(&self, ray: usize) -> Option<Hit> {
        self.met.get(ray)?.hit()
    }

    /// The object of a hit by its place in [`Scene::objects`](crate::scene::Scene::objects), and which of the object's primitives it is. A scene
    /// whose objects were left out has none.
    pub fn surface(&self, hit: &Hit) -> Option<(u32, u32)> {
        self.surfaces.surface(hit.primitive)
    }

    /// Where a ray has met something.
    pub fn place(&self, ray: usize) -> Option<Place> {
        self.surfaces.place(self.met.get(ray)?)
    }
}
