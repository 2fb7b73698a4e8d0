//! How much work the rays of a picture are: their steps, counted.

use std::sync::Mutex;

use eyerays_kernels_cpu::Records;
use eyerays_shader::camera;
use eyerays_shader::scene::TraceContext;

use super::block::{Block, LANES, ORDER};
use super::is_packet;
use super::step::Visit;
use super::walk::{Trial, Walk, Witness};
use crate::cpu::{Observer, Renderer};
use crate::error::Result;
use crate::job::Job;
use crate::method::{Method, Traversal};
use crate::view::View;

/// The work of a ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Nodes that it visits: pairs of boxes, or nodes of eight.
    pub visits: u32,
    /// Primitives that it is tested against.
    pub tests: u32,
    /// How many nodes are above the deepest that it visits.
    pub deepest: u32,
    /// How many steps more the longest ray of its block takes: the lanes of a GPU's subgroup wait for the last of them.
    pub idle: u32,
}

impl Counts {
    fn steps(&self) -> u32 {
        self.visits + self.tests
    }
}

/// The work of the ray of each pixel of a view of a job, by a method with `threads` threads (0: one a core): what
/// [`follow`](super::follow) has steps of. A packet's work is that of each of its rays.
///
/// # Errors
/// As [`Renderer::new`] and [`Renderer::render`].
pub(crate) fn counts(job: &Job, view: &View, traversal: Traversal, threads: usize) -> Result<Vec<Counts>> {
    let traversal = Traversal { order: Default::default(), ..super::resolved(job, traversal) };
    let region = view.region();
    let all = Mutex::new(vec![Counts::default(); region.pixels() as usize]);
    let counter = Counter { method: traversal.method, left: region.x, top: region.y, width: region.width, all: &all };
    Renderer::new(job, traversal, threads)?.render::<f32>(view, &|_| (), &counter)?;
    Ok(all.into_inner().expect("no thread has panicked"))
}

/// Counts the work of the rays of a tile.
struct Counter<'a> {
    method: Method,
    left: u32,
    top: u32,
    width: u32,
    all: &'a Mutex<Vec<Counts>>,
}

impl Observer<f32> for Counter<'_> {
    fn wave(&self, scene: &TraceContext<'_>, slots: &[u32], records: &Records<f32>) {
        let blocks = slots.chunk_by(|a, b| *a as usize / LANES == *b as usize / LANES);
        let counted: Vec<[Counts; LANES]> = blocks.clone().map(|slots| self.block(scene, slots, records)).collect();
        let frame = scene.base.frame;
        let mut all = self.all.lock().expect("no thread has panicked");
        for (slots, counts) in blocks.zip(counted) {
            for &slot in slots {
                let pixel = camera::pixel(frame, ORDER, slot);
                let (x, y) = (frame.left + pixel.x - self.left, frame.top + pixel.y - self.top);
                all[(y * self.width + x) as usize] = counts[slot as usize % LANES];
            }
        }
    }
}

impl Counter<'_> {
    fn block(&self, scene: &TraceContext<'_>, slots: &[u32], records: &Records<f32>) -> [Counts; LANES] {
        let block = Block::of(scene, slots, records);
        let mut tally = Tally([Counts::default(); LANES]);
        let mut walk = Walk::new(scene, &block, &mut tally);
        if is_packet(self.method) {
            walk.follow(self.method, 0);
        } else {
            for lane in block.each() {
                walk.follow(self.method, lane);
            }
        }
        let longest = tally.0.iter().map(Counts::steps).max().unwrap_or(0);
        tally.0.map(|counts| Counts { idle: longest - counts.steps(), ..counts })
    }
}

/// What the lanes of a block have done.
struct Tally([Counts; LANES]);

impl Tally {
    fn each(&mut self, lanes: u32, mut add: impl FnMut(&mut Counts)) {
        let mut open = lanes;
        while open != 0 {
            add(&mut self.0[open.trailing_zeros() as usize]);
            open &= open - 1;
        }
    }
}

impl Witness for Tally {
    fn visit(&mut self, lanes: u32, depth: u32, _: impl Fn(usize) -> Visit) {
        self.each(lanes, |counts| {
            counts.visits += 1;
            counts.deepest = counts.deepest.max(depth);
        });
    }

    fn test(&mut self, lanes: u32, _: impl Fn(usize) -> Trial) {
        self.each(lanes, |counts| counts.tests += 1);
    }
}
