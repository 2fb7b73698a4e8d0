//! Keeps the steps of one ray.

use super::step::{Outcome, Place, Step, Target, Test, Visit};
use super::tape::Event;
use super::walk::{Trial, Witness};
use crate::pick::Names;

/// From the kernels' lengths to those of the scene.
#[derive(Clone, Copy)]
pub(crate) struct Ruler {
    /// Where rays start that the kernels follow, from where the camera's start.
    pub start: f64,
    /// What the scene's lengths are multiplied by.
    pub scale: f64,
}

impl Ruler {
    /// A distance in the scene's units.
    pub fn distance(&self, t: f64) -> f64 {
        self.start + t / self.scale
    }
}

/// The steps of the ray of a lane, and what a kernel does meanwhile.
pub(super) struct Record<'n> {
    lane: usize,
    names: &'n Names<'n>,
    ruler: Ruler,
    pub steps: Vec<Step>,
    pub events: Vec<Event>,
}

impl<'n> Record<'n> {
    pub fn new(lane: usize, names: &'n Names<'n>, ruler: Ruler) -> Self {
        Record { lane, names, ruler, steps: Vec::new(), events: Vec::new() }
    }

    fn is_of(&self, lanes: u32) -> bool {
        lanes >> self.lane & 1 == 1
    }
}

impl Witness for Record<'_> {
    fn event(&mut self, event: Event) {
        self.events.push(event);
    }

    fn visit(&mut self, lanes: u32, _: u32, tell: impl Fn(usize) -> Visit) {
        if !self.is_of(lanes) {
            return;
        }
        let mut visit = tell(self.lane);
        for child in &mut visit.children {
            (child.near, child.far) = (self.ruler.distance(child.near), self.ruler.distance(child.far));
        }
        self.steps.push(Step::Visit(visit));
    }

    fn test(&mut self, lanes: u32, tell: impl Fn(usize) -> Trial) {
        if !self.is_of(lanes) {
            return;
        }
        let Trial { primitive, met, is_closest } = tell(self.lane);
        let contact = self.ruler.place(&met);
        let outcome = match (contact.is_some(), is_closest) {
            (false, _) => Outcome::Miss,
            (true, true) => Outcome::Closest,
            (true, false) => Outcome::Farther,
        };
        let surface = self.names.surface(primitive as usize);
        self.steps.push(Step::Test(Test { surface, rays: lanes.count_ones(), outcome, contact }));
    }

    fn drop(&mut self, lanes: u32, child: Target, near: f32) {
        if self.is_of(lanes) {
            self.steps.push(Step::Drop { child, near: self.ruler.distance(near.into()) });
        }
    }
}

impl Ruler {
    /// Where a ray has hit something, if it has.
    pub fn place(&self, hit: &eyerays_shader::ray::Hit<f32>) -> Option<Place> {
        let (u, v) = hit.coordinates();
        let is_hit = hit.primitive_index != eyerays_shader::ray::Hit::<f32>::NOTHING;
        is_hit.then(|| Place { t: self.distance(hit.t.into()), u, v })
    }
}
