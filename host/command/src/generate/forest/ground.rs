//! The ground, and what lies and grows on it.

use glam::DVec3;

use super::views;
use crate::generate::circle::turn;
use crate::generate::frame::Frame;
use crate::generate::model::Model;
use crate::generate::patch::{Leaves, Patch};
use crate::generate::random::{Random, noise, rough};
use crate::generate::shape::{at, ball, lathe};

/// How far the ground goes.
const EDGE: f64 = 36.0;
/// The middle of the pond and the square of its radius.
const POND: (DVec3, f64) = (DVec3::new(-3.4, -0.14, 2.9), 3.2);

/// Gentle hills that rise towards the edge, and a hollow for the pond.
#[derive(Clone, Copy)]
pub struct Ground {
    seed: u64,
}

impl Ground {
    /// Ground of its own.
    pub fn new(random: &mut Random) -> Self {
        Ground { seed: random.bits() }
    }

    fn height(self, x: f64, z: f64) -> f64 {
        let away = (x * x + z * z) / (EDGE * EDGE);
        let wet = (1.0 - at(x - POND.0.x, 0.0, z - POND.0.z).length_squared() / (1.6 * POND.1)).max(0.0);
        let near = (8.0 * away).min(1.0);
        let bumps = 0.12 * rough(self.seed, at(x * 0.6, 0.0, z * 0.6))
            + 0.9 * near * noise(self.seed, at(x * 0.15, 3.0, z * 0.15));
        bumps * (1.0 - wet) + 5.0 * away * away - 0.7 * wet
    }

    /// Upright on the ground.
    pub fn on(self, place: DVec3) -> Frame {
        Frame::at(place.x, self.height(place.x, place.z), place.z)
    }

    /// The ground itself, the pond and the grass.
    pub fn build(self, forest: &mut Model) {
        let sheet = move |u, v: f64| {
            let (x, z) = turn(u);
            let radius = EDGE * v * (0.25 + 0.75 * v);
            let (x, z) = (x * radius, z * radius);
            at(x, self.height(x, z), z)
        };
        forest.add("ground", "soil", 1.0, Patch::tube(sheet).least(7, 12));
        let radius = (1.5 * POND.1).sqrt();
        let water = move |u, v: f64| {
            let (x, z) = turn(u);
            POND.0 + at(x, 0.0, z) * (radius * v)
        };
        forest.add("ground", "water", 0.2, Patch::tube(water).least(1, 16).faceted());
        let blades = move |random: &mut Random, edge: f64| {
            let place = loop {
                let (x, z) = turn(random.unit());
                let place = at(x, 0.0, z) * (0.8 + 14.0 * random.unit().sqrt());
                if !is_wet(place) {
                    break self.on(place).origin;
                }
            };
            let lean = at(random.within(-0.4, 0.4), 1.0, random.within(-0.4, 0.4));
            let long = 1.0 + random.unit();
            super::blade(place - DVec3::Y * (0.2 * edge), lean * long, random.direction(), edge.min(0.16))
        };
        forest.scatter("ground", "blade", 2.0, Leaves::new(self.seed, 26.0, blades));
    }

    /// Mushrooms and rocks, out of the views' way.
    pub fn strew(self, forest: &mut Model, random: &mut Random) {
        for _ in 0..20 {
            let middle = self.free(random);
            mushroom(forest, self.on(middle).turned(random.unit()).scaled(random.within(0.35, 1.1)), random);
        }
        for _ in 0..16 {
            let frame = self.on(self.free(random)).turned(random.unit());
            let (seed, size) = (random.bits(), random.within(0.15, 0.5));
            let rock = move |p: DVec3| {
                let bulge = 1.0 + 0.45 * rough(seed, p * 1.6);
                frame.point(p * at(1.3, 0.7, 1.0) * (size * bulge))
            };
            forest.add("rocks", "stone", 1.0, ball(rock).least(3, 5));
        }
    }

    /// A place that is dry, beside the figure and not before a camera.
    fn free(self, random: &mut Random) -> DVec3 {
        loop {
            let place = at(random.within(-10.0, 10.0), 0.0, random.within(-10.0, 10.0));
            let far = views().iter().all(|view| (view.eye * at(1.0, 0.0, 1.0)).distance(place) > 1.4);
            if far && (1.9..10.0).contains(&place.length()) && !is_wet(place) {
                return place;
            }
        }
    }
}

fn is_wet(place: DVec3) -> bool {
    (place - POND.0).length_squared() < 1.7 * POND.1
}

fn mushroom(forest: &mut Model, frame: Frame, random: &mut Random) {
    let lean = random.within(-0.12, 0.12);
    let material = if random.unit() < 0.65 { "cap" } else { "skin" };
    let stem = [(0.11, -0.1), (0.09, 0.1), (0.06, 0.35), (0.07, 0.62)];
    let frame = frame.leaning(lean * 0.3);
    forest.add("mushrooms", "stem", 1.5, lathe(frame, &stem).least(1, 5));
    let seed = random.bits();
    let cap = ball(move |p| {
        let brim = if p.y < 0.0 { -0.25 } else { 1.0 };
        let wave = 1.0 + 0.06 * noise(seed, p * 3.0);
        frame.point(at(0.0, 0.55, 0.0) + p * at(0.36, 0.27 * brim, 0.36) * wave + DVec3::Y * (0.05 * p.y))
    });
    forest.add("mushrooms", material, 1.5, cap.least(4, 6));
}
