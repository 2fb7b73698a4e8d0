//! What can be met, where that is, and of which object.

use eyerays_shader::data::{Frame, Primitive, Specialisation};
use eyerays_shader::geometry::SurfaceInteraction;
use eyerays_shader::real::V3;
use eyerays_shader::scene::LaunchContext;
use eyerays_shader::stage::Found;
use glam::{DVec3, Vec3};

use crate::batch::{Hit, Measure};
use crate::job::Job;
use crate::method::Traversal;
use crate::scene::ObjectNumbers;

/// A scene that is ready for rays.
pub(super) struct Surfaces {
    pub job: Job,
    pub objects: ObjectNumbers,
    pub threads: rayon::ThreadPool,
    /// The numbers of the job's primitives: many more of them are in a core's caches than of the records that have them, too.
    numbers: Vec<u32>,
    /// Of a launch, for [`Surfaces::primitive`].
    frame: Frame,
    spec: Specialisation,
}

impl Surfaces {
    pub fn new(job: Job, objects: ObjectNumbers, threads: rayon::ThreadPool) -> Self {
        let (frame, spec) = (job.stream_frame(0), job.specialisation(&Traversal::default()));
        let numbers = job.primitives().iter().map(Primitive::number).collect();
        Surfaces { job, objects, threads, numbers, frame, spec }
    }

    /// What is told of something that was found, if it is anything.
    #[inline]
    pub fn hit(&self, measure: &Measure, found: &Found<f32>) -> Option<Hit> {
        let number = *self.numbers.get(found.index as usize)?;
        Some(Hit::of(&self.job, number, measure, found))
    }

    /// See [`Queries::surface`](super::Queries::surface).
    #[inline]
    pub fn surface(&self, hit: &Hit) -> Option<(u32, u32)> {
        let (object, within) = self.objects.within(hit.primitive as usize)?;
        Some((object, within as u32))
    }

    /// See [`Queries::place`](super::Queries::place).
    pub fn place(&self, hit: &Hit) -> Option<Place> {
        Some(self.place_on(&self.primitive(hit.slot)?, hit.coordinates))
    }

    /// A primitive by its place among all and the copy of a mesh that it is in, where that has it.
    pub fn primitive(&self, (index, instance): (u32, u32)) -> Option<Primitive> {
        self.job.primitives().get(index as usize)?;
        let primitives = bytemuck::cast_slice(self.job.primitives());
        let launch = LaunchContext::new(&self.frame, self.spec, primitives, self.job.instances());
        Some(launch.placed(index, instance, 0.0))
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
