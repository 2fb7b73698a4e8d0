//! The figure: a winged one in a gown on a stone, an orb of glass in her raised hand.

use glam::DVec3;

use crate::generate::circle::turn;
use crate::generate::frame::Frame;
use crate::generate::model::Model;
use crate::generate::patch::Patch;
use crate::generate::random::{Random, noise, rough};
use crate::generate::shape::{at, ball, lathe, rod, through};

const GROUP: &str = "figure";

/// Builds her in the middle, turned a little by the seed.
pub fn build(forest: &mut Model, random: &mut Random) {
    let frame = Frame::at(0.0, 0.75, 0.0).turned(random.within(-0.06, 0.06)).scaled(1.45);
    stone(forest, random.bits());
    forest.add(GROUP, "gown", 1.0, gown(frame, random.bits(), 9.0 + (random.bits() & 3) as f64));
    head(forest, frame, random.bits());
    arms(forest, frame, random);
    let droop = random.within(0.0, 0.1);
    for side in [-1.0, 1.0] {
        forest.add(GROUP, "wing", 1.2, wing(frame, side, at(0.62, 0.46, 0.9), 0.12 + droop));
        forest.add(GROUP, "wing", 1.2, wing(frame, side, at(0.42, -0.16, 0.5), -0.06 + droop));
    }
}

fn stone(forest: &mut Model, seed: u64) {
    let form = move |p: DVec3| {
        let flat = at(p.x, if p.y > 0.0 { 0.75 * p.y.sqrt() } else { p.y }, p.z);
        let bulge = 1.0 + 0.2 * rough(seed, p * 2.0) * (1.0 - p.y.max(0.0));
        at(0.0, 0.05, 0.0) + flat * at(1.25, 0.95, 1.25) * bulge
    };
    forest.add(GROUP, "stone", 0.4, ball(form).least(6, 10));
}

/// From the hem up to the neck; folds die out towards the waist.
fn gown(frame: Frame, seed: u64, folds: f64) -> Patch {
    let outline = [
        (0.52, 0.0),
        (0.43, 0.2),
        (0.33, 0.5),
        (0.24, 0.8),
        (0.145, 1.05),
        (0.17, 1.2),
        (0.185, 1.3),
        (0.15, 1.42),
        (0.055, 1.48),
    ];
    let outline = outline.map(|(radius, y)| at(radius, y, 0.0));
    Patch::tube(move |u, v| {
        let line = through(&outline, v);
        let loose = (1.0 - v / 0.55).max(0.0);
        let (x, z) = turn(u);
        let sway = 0.3 * noise(seed, at(x * 1.5, v * 2.0, z * 1.5));
        let fold = 1.0 + 0.2 * loose * turn(u * folds + sway + 0.3 * v).0;
        let train = 0.22 * loose * loose * z.max(0.0);
        frame.point(at(x * line.x * fold, line.y, -z * line.x * fold * 0.78 - train))
    })
    .least(9, 14)
}

fn head(forest: &mut Model, frame: Frame, seed: u64) {
    let neck = [(0.07, 1.4), (0.048, 1.5), (0.05, 1.6)];
    forest.add(GROUP, "skin", 1.0, lathe(frame, &neck).least(2, 6));
    let face = move |p: DVec3| {
        let bump =
            |middle: DVec3, size: f64| (1.0 - (p - middle.normalize()).length_squared() / (size * size)).max(0.0);
        let nose = 0.13 * bump(at(0.0, -0.12, 1.0), 0.22);
        let eyes = bump(at(0.38, 0.15, 1.0), 0.2) + bump(at(-0.38, 0.15, 1.0), 0.2);
        let lips = 0.05 * bump(at(0.0, -0.45, 1.0), 0.2);
        let chin = at(1.0 - 0.2 * (-p.y).max(0.0), 1.0, 1.0);
        frame.point(at(0.0, 1.68, 0.02) + p * chin * at(0.1, 0.135, 0.115) * (1.0 + nose + lips - 0.045 * eyes))
    };
    forest.add(GROUP, "skin", 3.0, ball(face).least(8, 10));
    let hair = move |p: DVec3| {
        let strand = 1.0 + 0.03 * turn(p.x * 7.0 + 0.4 * noise(seed, p * 3.0)).0;
        let fall = (-p.y).max(0.0);
        let shape = p * at(0.125 + 0.05 * fall, 0.13 + 0.33 * fall, 0.115 + 0.03 * fall) * strand;
        frame.point(at(0.0, 1.725, -0.055 - 0.1 * fall) + shape)
    };
    forest.add(GROUP, "hair", 2.0, ball(hair).least(8, 12));
    for i in 0..10 {
        let (x, z) = turn(f64::from(i) / 10.0);
        let bloom = frame.moved(0.128 * x, 1.765 + 0.02 * z, -0.045 + 0.12 * z);
        let petals = move |p: DVec3| {
            let ruffle = 1.0 + 0.3 * turn(5.0 * p.x).0 * turn(5.0 * p.z).0;
            bloom.point(p * (0.028 * ruffle))
        };
        forest.add(GROUP, "cap", 2.0, ball(petals));
    }
}

fn arms(forest: &mut Model, frame: Frame, random: &mut Random) {
    let lift = random.within(-0.05, 0.08);
    let raised = [at(-0.13, 1.4, 0.0), at(-0.3, 1.27, 0.08), at(-0.42, 1.5 + lift, 0.22), at(-0.43, 1.62 + lift, 0.27)];
    let lowered = [at(0.13, 1.4, 0.0), at(0.29, 1.2, 0.0), at(0.36, 0.98, 0.18), at(0.37, 0.94, 0.26)];
    for bends in [raised, lowered] {
        let path = bends.map(|p| frame.point(p));
        let thick = |v: f64| 1.45 * (0.052 - 0.028 * v + 0.012 * (1.0 - (4.0 * v - 2.0) * (4.0 * v - 2.0)).max(0.0));
        forest.add(GROUP, "skin", 2.0, rod(move |v| through(&path, v), thick).least(6, 7));
        let hand = bends[3];
        forest.add(GROUP, "skin", 2.0, ball(move |p| frame.point(hand + p * at(0.035, 0.028, 0.05))));
        let cuff = (bends[1], bends[2]);
        let sleeve = move |v: f64| frame.point(bends[0].lerp(cuff.0, v).lerp(cuff.0.lerp(cuff.1, v), v * 0.6));
        forest.add(GROUP, "gown", 1.0, rod(sleeve, |v| 1.45 * (0.062 + 0.05 * v * v)).least(4, 9));
    }
    let orb = raised[3] + at(0.0, 0.13, 0.03);
    forest.add(GROUP, "orb", 1.0, ball(move |p| frame.point(orb + p * 0.105)).least(8, 12));
    let wand = [at(0.37, 0.72, 0.2), at(0.37, 1.32, 0.4)];
    let [low, high] = wand.map(|p| frame.point(p));
    forest.add(GROUP, "silver", 1.0, rod(move |v| low.lerp(high, v), |_| 0.013).least(2, 6));
    forest.add(GROUP, "silver", 1.0, ball(move |p| frame.point(wand[1] + p * 0.07)).least(8, 10));
}

/// A thin lens of glass between veins; `size` is its span, the height of its middle over its root, and its width.
fn wing(frame: Frame, side: f64, size: DVec3, sweep: f64) -> Patch {
    let root = frame.moved(side * 0.04, 1.3, -0.15).turned(side * sweep);
    ball(move |p| {
        // The ball's pole becomes the tip, so that cuts run along the veins.
        let along = (1.0 - p.y) * 0.5;
        let broad = size.z * 0.5 * (0.35 + 0.65 * along);
        let vein = 1.0 + 0.35 * turn(p.x * 3.0 + along * 2.0).0;
        let x = side * size.x * 1.7 * along;
        let y = size.y * 1.5 * along + p.x * side * broad;
        root.point(at(x, y, p.z * 0.014 * vein - 0.25 * along * along))
    })
    .least(6, 8)
}
