//! Which media a place is in: by the surfaces around it.

use eyerays_kernels_cpu::{Isa, Number, Query};
use eyerays_shader::data::{Frame, Media};
use eyerays_shader::geometry::SurfaceInteraction;
use eyerays_shader::medium::Inside;
use eyerays_shader::ray::Ray;
use eyerays_shader::real::V3;
use eyerays_shader::scene::TraceContext;
use eyerays_shader::stage::{Found, Segment};
use glam::Vec3;

use crate::device_scene::SceneView;
use crate::job::Job;
use crate::method::Method;

/// Ways out that no axis and hardly any edge of a model has. Most of them decide, should one go along an edge.
const WAYS: [Vec3; 3] = [Vec3::new(0.36, 0.48, 0.8), Vec3::new(-0.64, 0.6, 0.48), Vec3::new(0.48, -0.8, -0.36)];

/// A method that walks what every scene has.
const METHOD: Method = Method::WhileWhile;

/// Surfaces that a way out meets at most.
const MOST: u32 = 4096;

/// The media that a place of the normalised scene is in, as the shutter opens.
pub(crate) fn enclosing(job: &Job, place: Vec3) -> Inside {
    let is_among_surfaces = place.abs().max_element() <= 1.0;
    let is_filled = job.fillings().iter().any(|filling| filling.medium() != 0);
    if job.media_bits() == Media::default() || !is_filled || !is_among_surfaces {
        return Inside::default();
    }
    let laid = SceneView::new(job, METHOD.into());
    let frame = Frame { steps: 0, ..job.stream_frame(1) };
    let context = laid.stream_through_media(&frame);
    let found = WAYS.map(|way| along(job, &context, place, way));
    if found[1] == found[2] { found[1] } else { found[0] }
}

/// By one way out: what it leaves and did not enter, it began in.
fn along(job: &Job, context: &TraceContext<'_>, place: Vec3, way: Vec3) -> Inside {
    let (direction, effects) = (V3::<f64>::splat(way), context.base.spec.effects);
    let mut segment = Segment {
        origin: V3::splat(place),
        direction,
        limit: f64::from(f32::MAX),
        source_primitive: Ray::<f64>::OF_SURFACE,
    };
    let (mut entered, mut left) = (Vec::new(), Vec::new());
    for _ in 0..MOST {
        let mut stream = [Default::default(); 2];
        segment.store(1, 0, &mut stream);
        let mut hits = [Found::<f64>::nothing()];
        f64::follow(Isa::best(), METHOD.way(), context, &[0], Query::Trace(&stream, &mut hits));
        let [found] = hits;
        if found.is_nothing() {
            break;
        }
        let primitive = context.base.placed(found.index, found.instance, found.time);
        let interaction = SurfaceInteraction::new(effects, &primitive, found.coordinates, direction);
        let medium = job.fillings()[primitive.material() as usize].medium();
        if medium != 0 && interaction.front {
            entered.push(medium);
        } else if medium != 0 {
            match entered.iter().rposition(|&other| other == medium) {
                Some(place) => drop(entered.remove(place)),
                None => left.push(medium),
            }
        }
        segment.origin = interaction.offset_ray_origin(direction);
        segment.source_primitive = interaction.source_primitive(direction);
    }
    // What is left last was entered first.
    left.into_iter().rev().fold(Inside::default(), |inside, medium| inside.across(true, medium))
}
