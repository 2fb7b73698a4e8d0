//! A tile of the picture: the waves of a small launch.

use eyerays_shader::camera;
use eyerays_shader::data::{Features, Light};
use eyerays_shader::real::{Scalar, V3};
use eyerays_shader::scene::{Geometry, Looks};
use eyerays_shader::stage::{self, Asking, RECORDS, Wave};

use super::follow::{Job, follow};
use super::isa::Isa;
use crate::method::{Coherence, Method, Processor, Traversal};
use crate::pack::{Laid, Packed, Region};

/// Where a launch's rays are after a wave; tests read it to see why two pictures differ.
pub trait Observer<R: Scalar>: Sync {
    /// Is called when a wave has been traced and before it is shaded.
    fn wave(&self, geometry: &Geometry<'_>, slots: &[u32], records: &Records<R>);
}

/// Looks at nothing.
impl<R: Scalar> Observer<R> for () {
    fn wave(&self, _: &Geometry<'_>, _: &[u32], _: &Records<R>) {}
}

/// The memory that the stages of a tile exchange.
pub struct Records<R: Scalar> {
    /// Paths by level, record and slot; empty without secondary rays.
    pub paths: Vec<R::Record>,
    /// (t, u, v) and triangle by slot.
    pub hits: Vec<R::Record>,
    /// Answers of the shadow stage by light and slot.
    pub shadows: Vec<u32>,
    /// Colour and counts by pixel.
    pub film: Vec<R::Record>,
}

/// Every sample of a region, wherever its edges are: its film (row-major; the integers count shadow rays) and
/// how many secondary rays it took.
pub fn render_tile<R: Scalar>(
    packed: &Packed,
    traversal: impl Into<Traversal>,
    region: Region,
    observer: &dyn Observer<R>,
) -> (Vec<R::Record>, u64) {
    render_tile_by(Isa::best(), &Laid::new(packed, traversal.into()), region, observer)
}

/// The method for the rays of a wave and for their shadow rays.
fn methods(traversal: Traversal, features: Features) -> (Method, Method) {
    let of = |coherence| traversal.resolved(Processor::Cpu, coherence).method;
    if features.has(Features::SECONDARY) {
        (of(Coherence::Secondary), of(Coherence::Secondary))
    } else {
        (of(Coherence::Primary), of(Coherence::Shadow))
    }
}

/// [`render_tile`] with the instructions of an ISA.
pub fn render_tile_by<R: Scalar>(
    isa: Isa,
    laid: &Laid<'_>,
    region: Region,
    observer: &dyn Observer<R>,
) -> (Vec<R::Record>, u64) {
    let (packed, features) = (laid.packed, laid.features());
    let slots = packed.frame(region, 0, features).limits.z as usize;
    let black = R::store(V3::zero(), 0);
    let mut records = Records::<R> {
        paths: vec![black; slots * (packed.levels() * RECORDS) as usize],
        hits: vec![black; slots],
        shadows: vec![0; slots * packed.lights.len()],
        film: vec![black; (region.width * region.height) as usize],
    };
    let looks = Looks { normals: &packed.normals, materials: &packed.materials, lights: &packed.lights };
    let mut secondary = 0;
    for sample in 0..packed.samples() {
        let frame = packed.frame(region, sample, features);
        let mut geometry = laid.geometry(&frame);
        let mut queue: Vec<u32> = (0..slots as u32).filter(|&s| camera::pixel(&frame, features, s).inside).collect();
        loop {
            trace::<R>(isa, methods(laid.traversal, geometry.features), &geometry, looks.lights, &queue, &mut records);
            observer.wave(&geometry, &queue, &records);
            shade(&geometry, &looks, &mut queue, &mut records);
            if queue.is_empty() {
                break;
            }
            secondary += queue.len() as u64;
            geometry.features = Features(features.0 | Features::SECONDARY);
        }
    }
    (records.film, secondary)
}

/// The stages of a wave that follow rays.
fn trace<R: Scalar>(
    isa: Isa,
    (traced, asked): (Method, Method),
    geometry: &Geometry<'_>,
    lights: &[Light],
    queue: &[u32],
    records: &mut Records<R>,
) {
    let mut hits = vec![R::store(V3::zero(), 0); queue.len()];
    follow::<R>(isa, traced, geometry, queue, Job::Trace(&records.paths, &mut hits));
    for (&slot, hit) in queue.iter().zip(hits) {
        records.hits[slot as usize] = hit;
    }
    let mut answers = vec![0; queue.len()];
    for light in 0..geometry.light_count() {
        let asking = Asking { lights, paths: &records.paths, hits: &records.hits };
        follow::<R>(isa, asked, geometry, queue, Job::Shadow(asking, light, &mut answers));
        for (&slot, &answer) in queue.iter().zip(&answers) {
            records.shadows[(light * geometry.slots() + slot) as usize] = answer;
        }
    }
}

/// The last stage of a wave; leaves the slots of the next one in the queue.
fn shade<R: Scalar>(geometry: &Geometry<'_>, looks: &Looks<'_>, queue: &mut Vec<u32>, records: &mut Records<R>) {
    let Records { paths, hits, shadows, film } = records;
    queue.retain(|&slot| {
        stage::shade(geometry, looks, slot, Wave::<R> { paths: &mut *paths, hits, shadows, film: &mut *film })
    });
}
