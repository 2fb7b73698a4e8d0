//! Trees, no two alike.

use glam::DVec3;

use super::{blade, bush};
use crate::generate::circle::turn;
use crate::generate::frame::Frame;
use crate::generate::model::Model;
use crate::generate::patch::{Leaves, Patch};
use crate::generate::random::{Random, rough};
use crate::generate::shape::{at, blend, rod, through};

/// A fir or a tree of leaves.
pub fn build(forest: &mut Model, frame: Frame, random: &mut Random) {
    let frame = frame.turned(random.unit());
    if random.unit() < 0.35 { fir(forest, frame, random) } else { broad(forest, frame, random) }
}

/// A trunk with bark and roots through `bends`.
fn trunk(bends: [DVec3; 4], frame: Frame, thick: f64, seed: u64) -> Patch {
    let surface = move |u, v: f64| {
        let (x, z) = turn(u);
        let flare = (1.0 - 6.0 * v).max(0.0);
        let roots = 1.0 + flare * flare * (0.9 + 0.5 * turn(u * 5.0).0);
        let bark = 1.0 + 0.22 * rough(seed, at(x * 2.5, v * 5.0, z * 2.5));
        let radius = thick * blend(1.0, 0.25, v) * roots * bark;
        frame.point(through(&bends, v) + at(x, 0.0, -z) * radius)
    };
    Patch::tube(surface).least(4, 6)
}

fn broad(forest: &mut Model, frame: Frame, random: &mut Random) {
    let height = random.within(4.5, 7.5);
    let mut bend = |y: f64, sway: f64| at(random.within(-sway, sway), y * height, random.within(-sway, sway));
    let bends = [bend(-0.05, 0.0), bend(0.3, 0.3), bend(0.65, 0.5), bend(1.0, 0.7)];
    forest.add("trees", "bark", 1.0, trunk(bends, frame, random.within(0.22, 0.4), random.bits()));
    for i in 0..5 {
        let from = through(&bends, 0.5 + 0.1 * f64::from(i));
        let (x, z) = turn(f64::from(i) * 0.38 + random.within(0.0, 0.2));
        let reach = random.within(1.2, 2.2);
        let to = from + at(x * reach, random.within(0.6, 1.5), z * reach);
        let middle = from.lerp(to, 0.5) - DVec3::Y * 0.2;
        let limb = [from, middle, to].map(|p| frame.point(p));
        forest.add("trees", "bark", 1.0, rod(move |v| through(&limb, v), |v| blend(0.1, 0.025, v)).least(1, 3));
        let radii = at(1.0, 0.75, 1.0) * random.within(0.9, 1.5);
        forest.scatter("trees", "leaf", 0.6, bush(random.bits(), limb[2], radii, 9.0));
    }
    forest.scatter("trees", "leaf", 0.6, bush(random.bits(), frame.point(bends[3]), at(1.5, 1.1, 1.5), 14.0));
}

fn fir(forest: &mut Model, frame: Frame, random: &mut Random) {
    let height = random.within(6.0, 9.5);
    let bends = [-0.05, 0.3, 0.6, 1.0].map(|y| at(0.0, y * height, 0.0));
    forest.add("trees", "bark", 1.0, trunk(bends, frame, random.within(0.16, 0.26), random.bits()));
    for tier in 0..6 {
        let share = f64::from(tier) / 6.0;
        let (seed, wide) = (random.bits(), blend(2.0, 0.7, share));
        let (low, high) = (height * blend(0.16, 0.86, share), height * blend(0.42, 1.04, share));
        let skirt = move |u: f64, v: f64| {
            let (x, z) = turn(u);
            let ragged = 1.0 + 0.25 * rough(seed, at(x * 4.0, v * 3.0, z * 4.0)) * (1.0 - v);
            let radius = 0.92 * wide * (1.0 - v) * ragged;
            frame.point(at(x * radius, blend(low, high, v) - 0.25 * (1.0 - v) * turn(u * 9.0).0, -z * radius))
        };
        forest.add("trees", "needle", 0.5, Patch::tube(skirt).least(1, 9));
        let needles = move |random: &mut Random, edge: f64| {
            let (x, z) = turn(random.unit());
            let up = 1.0 - random.unit().sqrt();
            let base = at(x * wide * (1.0 - up), blend(low, high, up), -z * wide * (1.0 - up));
            let tip = (at(x, -0.5, -z) + 0.5 * random.direction()).normalize_or(DVec3::X);
            blade(frame.point(base), frame.vector(tip), random.direction(), edge)
        };
        forest.scatter("trees", "needle", 0.6, Leaves::new(random.bits(), 4.0 * wide, needles));
    }
}
