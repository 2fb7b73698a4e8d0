//! What stands on the floor or hangs from the ceiling.

use super::{HALF, TABLE};
use crate::generate::circle::turn;
use crate::generate::frame::Frame;
use crate::generate::model::Model;
use crate::generate::patch::{Leaves, Patch};
use crate::generate::random::Random;
use crate::generate::shape::{at, ball, cushion, lathe, rod, squared, stick, through};

/// A chair whose sitter looks along the frame's z.
pub fn chair(hall: &mut Model, frame: Frame) {
    hall.add("chairs", "leather", 5.0, cushion(frame.moved(0.0, 0.46, 0.0), 0.25, 0.055, 0.25));
    let back = ball(move |p| {
        let p = squared(p) * at(0.25, 0.28, 0.035);
        frame.point(p + at(0.0, 0.84, -0.27 + 0.9 * p.x * p.x - 0.12 * p.y))
    });
    hall.add("chairs", "leather", 5.0, back);
    for (x, z) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
        let (foot, top) = (at(x * 0.25, 0.0, z * 0.26), at(x * 0.2, 0.45, z * 0.2));
        hall.add("chairs", "steel", 5.0, stick(frame.point(foot), frame.point(top), 0.017));
    }
    for x in [-1.0, 1.0] {
        let bends = [(0.2, 0.44, 0.1), (0.3, 0.5, 0.14), (0.3, 0.66, 0.16), (0.29, 0.68, -0.05), (0.25, 0.66, -0.24)];
        let bends = bends.map(|(side, y, z)| frame.point(at(x * side, y, z)));
        let arm = rod(move |v| through(&bends, v), |_| 0.018).least(4, 3);
        hall.add("chairs", "steel", 5.0, arm);
        let (low, high) = (frame.point(at(x * 0.17, 0.43, -0.2)), frame.point(at(x * 0.17, 0.7, -0.25)));
        hall.add("chairs", "steel", 5.0, stick(low, high, 0.016));
    }
}

/// The table's outline: between an ellipse and a rectangle.
fn outline(turns: f64, inset: f64) -> (f64, f64) {
    let (cosine, sine) = turn(turns);
    let p = squared(at(cosine, 0.0, sine));
    (p.x * (TABLE.0 - inset), -p.z * (TABLE.1 - inset))
}

/// The long table on three feet.
pub fn table(hall: &mut Model) {
    let rim = |u, v: f64| {
        let (x, y) = turn(v / 2.0 - 0.25);
        let (px, pz) = outline(u, 0.04 - 0.04 * x);
        at(px, TABLE.2 - 0.03 + 0.03 * y, pz)
    };
    let plane = |y: f64, up: bool| {
        move |u, v: f64| {
            let share = if up { 1.0 - v } else { v };
            let (x, z) = outline(u, 0.04);
            at(x * share, y, z * share)
        }
    };
    hall.add("table", "table", 1.0, Patch::tube(rim).least(3, 32));
    hall.add("table", "table", 0.05, Patch::tube(plane(TABLE.2, true)).least(1, 48).faceted());
    hall.add("table", "table", 0.0, Patch::tube(plane(TABLE.2 - 0.06, false)).least(1, 32).faceted());
    for x in [-4.2, 0.0, 4.2] {
        let foot = [(0.5, 0.0), (0.48, 0.05), (0.16, 0.1), (0.12, 0.3), (0.2, 0.45), (0.13, 0.6), (0.3, 0.7)];
        hall.add("table", "table", 2.0, lathe(Frame::at(x, 0.0, 0.0), &foot).least(8, 10));
    }
}

/// A row of lamps of glass under shades.
pub fn lamps(hall: &mut Model) {
    let shade = [(0.42, 0.0), (0.4, 0.1), (0.3, 0.22), (0.12, 0.3), (0.03, 0.36)];
    for i in 0..5 {
        let lamp = Frame::at((f64::from(i) - 2.0) * 2.2, 2.8, 0.0);
        let (low, high) = (lamp.point(at(0.0, 0.3, 0.0)), at(lamp.origin.x, HALF.2, 0.0));
        hall.add("lamps", "steel", 1.0, stick(low, high, 0.012));
        hall.add("lamps", "shade", 2.0, lathe(lamp, &shade).least(4, 12));
        hall.add("lamps", "glass", 2.0, ball(move |p| lamp.point(p * at(0.16, 0.16, 0.16))).least(6, 10));
    }
    for i in 0..14 {
        let (x, z) = ((f64::from(i / 2) - 3.0) * 3.0 + 1.5, if i % 2 == 0 { -3.6 } else { 3.6 });
        let rose = [(0.0, -0.06), (0.2, -0.055), (0.24, -0.03), (0.26, 0.02)];
        hall.add("lamps", "paper", 1.0, lathe(Frame::at(x, HALF.2, z), &rose).least(2, 8));
    }
}

/// A pot with a bush in every corner.
pub fn plants(hall: &mut Model, random: &mut Random) {
    let pot = [(0.22, 0.0), (0.28, 0.25), (0.34, 0.5), (0.37, 0.56), (0.33, 0.57), (0.3, 0.48), (0.0, 0.47)];
    for (x, z) in [(-9.2, -5.2), (9.2, -5.2), (9.2, 5.2)] {
        let frame = Frame::at(x, 0.0, z);
        hall.add("plants", "clay", 1.0, lathe(frame, &pot).least(6, 10));
        let top = 1.5 + random.within(0.0, 0.4);
        for _ in 0..5 {
            let lean = random.direction() * 0.35;
            let tip = frame.point(at(lean.x, top, lean.z));
            hall.add("plants", "clay", 1.0, stick(frame.point(at(lean.x * 0.2, 0.4, lean.z * 0.2)), tip, 0.012));
        }
        let leaf = move |random: &mut Random, edge: f64| {
            let spread = random.direction() * random.unit().sqrt() * 0.55;
            let base = frame.point(at(spread.x, top - 0.1 + spread.y * 0.8, spread.z));
            let tip = (random.direction() + spread).normalize_or(glam::DVec3::Y);
            let side = tip.cross(random.direction()).normalize_or(glam::DVec3::X);
            [base - side * (0.3 * edge), base + side * (0.3 * edge), base + tip * (1.6 * edge)]
        };
        hall.scatter("plants", "leaf", 0.5, Leaves::new(random.bits(), 3.0, leaf));
    }
}
