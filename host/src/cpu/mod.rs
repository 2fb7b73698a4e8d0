//! The kernels on the CPU: tiles in parallel, each with the memory of a small launch.

mod cast;

use std::sync::Mutex;

use eyerays_shader::camera;
use eyerays_shader::data::Features;
use eyerays_shader::real::{Scalar, V3};
use eyerays_shader::scene::{Geometry, Looks};
use eyerays_shader::stage::{self, Asking, NON_FINITE, RECORDS, Wave};
use eyerays_shader::traverse::{
    self, Cut, Hybrid, IfIf, Interleaved, Packet, Sequential, Speculative, StackMax, WhileWhile, WideNodes,
};
use eyerays_shader::warp::Alone;
use rayon::prelude::*;

pub use cast::cast;

use crate::error::{Error, Result};
use crate::film::Film;
use crate::method::{Method, Traversal};
use crate::pack::{Packed, Region, TriangleWords};
use crate::rays::Rays;

/// Memory for the waiting rays of a tile, in bytes, that makes a tile smaller than [`TILE`].
const PATH_MEMORY: u64 = 64 << 20;
/// A tile's edge in pixels.
const TILE: u32 = 32;

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

/// Renders with `threads` threads (0: one a core) in the arithmetic `R`. `done` hears of every
/// finished share of the pixels.
///
/// # Errors
/// If the film or the threads can't be had.
pub fn render<R>(
    packed: &Packed,
    traversal: impl Into<Traversal>,
    threads: usize,
    done: &(dyn Fn(u64) + Sync),
) -> Result<(Film, Rays)>
where
    R: Scalar<Record: Send + Sync>,
{
    observe::<R>(packed, traversal, threads, done, &())
}

/// [`render`], with somebody who looks on.
///
/// # Errors
/// As [`render`].
pub fn observe<R>(
    packed: &Packed,
    traversal: impl Into<Traversal>,
    threads: usize,
    done: &(dyn Fn(u64) + Sync),
    observer: &dyn Observer<R>,
) -> Result<(Film, Rays)>
where
    R: Scalar<Record: Send + Sync>,
{
    let traversal = traversal.into();
    let (width, height) = packed.settings.size;
    let result = Mutex::new((Film::new(width, height)?, Rays::default()));
    pool(threads)?.install(|| {
        // A tile a task: coarser splitting leaves threads idle at the end.
        tiles(packed).into_par_iter().with_max_len(1).for_each(|region| {
            let (film, secondary) = render_tile(packed, traversal, region, observer);
            let (image, rays) = &mut *result.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            keep::<R>(region, &film, image, rays);
            rays.secondary += secondary;
            rays.primary += u64::from(region.width * region.height) * u64::from(packed.samples());
            done(u64::from(region.width * region.height));
        });
    });
    Ok(result.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner))
}

/// Threads to install work in; 0 is one a core.
fn pool(threads: usize) -> Result<rayon::ThreadPool> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|e| Error::new(format!("can't start {threads} threads ({e}): ask for fewer")))
}

fn tiles(packed: &Packed) -> Vec<Region> {
    let (width, height) = packed.settings.size;
    let slot = u64::from(packed.levels()) * u64::from(RECORDS) * 32;
    let mut edge = TILE;
    while edge > 8 && u64::from(edge * edge) * slot > PATH_MEMORY {
        edge /= 2;
    }
    let edge = edge as usize;
    let rows = (0..height).step_by(edge);
    rows.flat_map(|y| (0..width).step_by(edge).map(move |x| (x, y)))
        .map(|(x, y)| Region { x, y, width: (width - x).min(edge as u32), height: (height - y).min(edge as u32) })
        .collect()
}

/// Every sample of a region, wherever its edges are: its film (row-major; the integers count shadow rays) and
/// how many secondary rays it took.
pub fn render_tile<R: Scalar>(
    packed: &Packed,
    traversal: impl Into<Traversal>,
    region: Region,
    observer: &dyn Observer<R>,
) -> (Vec<R::Record>, u64) {
    let traversal = traversal.into();
    let features = Features(packed.features.0 | traversal.features().0);
    let slots = packed.frame(region, 0, features).limits.z as usize;
    let words = TriangleWords::of(packed, traversal.layout);
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
        let mut geometry = Geometry {
            frame: &frame,
            features,
            tuning: traversal.tuning,
            nodes: &packed.nodes,
            wide: &packed.wide,
            triangles: &words.0,
            bounds: &packed.bounds,
        };
        let mut queue: Vec<u32> = (0..slots as u32).filter(|&s| camera::pixel(&frame, features, s).inside).collect();
        loop {
            trace::<R>(traversal.method, &geometry, &looks, &queue, &mut records);
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

/// [`trace_by`] the method of this name.
fn trace<R: Scalar>(
    method: Method,
    geometry: &Geometry<'_>,
    looks: &Looks<'_>,
    queue: &[u32],
    records: &mut Records<R>,
) {
    let trace = match method {
        Method::Auto | Method::IfIf => trace_by::<R, IfIf>,
        Method::Wide => trace_by::<R, WideNodes>,
        Method::WhileWhile => trace_by::<R, WhileWhile>,
        Method::Speculative => trace_by::<R, Speculative<Alone>>,
        Method::Packet => trace_by::<R, Packet<Alone>>,
        Method::SequentialStack => trace_by::<R, Hybrid<Alone, StackMax, Sequential>>,
        Method::SequentialCut => trace_by::<R, Hybrid<Alone, Cut, Sequential>>,
        Method::InterleavedStack => trace_by::<R, Hybrid<Alone, StackMax, Interleaved>>,
        Method::InterleavedCut => trace_by::<R, Hybrid<Alone, Cut, Interleaved>>,
    };
    trace(geometry, looks, queue, records);
}

/// The stages of a wave that follow rays.
fn trace_by<R: Scalar, M: traverse::Method<R>>(
    geometry: &Geometry<'_>,
    looks: &Looks<'_>,
    queue: &[u32],
    records: &mut Records<R>,
) {
    for &slot in queue {
        records.hits[slot as usize] = stage::trace::<R, M>(geometry, slot, &records.paths);
    }
    for light in 0..geometry.light_count() {
        for &slot in queue {
            let answer = stage::shadow::<R, M>(
                geometry,
                Asking { lights: looks.lights, paths: &records.paths, hits: &records.hits },
                slot,
                light,
            );
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

/// Copies a tile's film into the image and counts.
fn keep<R: Scalar>(region: Region, film: &[R::Record], image: &mut Film, rays: &mut Rays) {
    for (row, line) in film.chunks_exact(region.width as usize).enumerate() {
        let start = (region.y as usize + row) * image.width as usize + region.x as usize;
        for (pixel, &record) in image.pixels[start..].iter_mut().zip(line) {
            let (colour, word) = R::load(record);
            *pixel = [colour.x.to_f32(), colour.y.to_f32(), colour.z.to_f32()];
            rays.shadow += u64::from(word & !NON_FINITE);
            rays.non_finite += u64::from(word & NON_FINITE != 0);
        }
    }
}
