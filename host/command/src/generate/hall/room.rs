//! Walls and what hangs on them.

use glam::DVec3;

use super::HALF;
use crate::generate::circle::turn;
use crate::generate::frame::Frame;
use crate::generate::model::Model;
use crate::generate::patch::Patch;
use crate::generate::random::{Random, noise};
use crate::generate::shape::{at, block};

/// Sheets reach into each other by this much, so that no ray slips out between them.
const OVERLAP: f64 = 0.2;

/// The shell, panels, windows and the mirror.
pub fn build(hall: &mut Model, random: &mut Random) {
    shell(hall);
    for i in 0..8 {
        let x = (f64::from(i) - 3.5) * 2.4;
        panel(hall, Frame::at(x, 0.2, HALF.1).turned(0.5), 1.05, 1.2);
        panel(hall, Frame::at(x, 1.7, HALF.1).turned(0.5), 1.05, 2.4);
        panel(hall, Frame::at(x, 0.2, -HALF.1), 1.05, 0.7);
    }
    for i in 0..7 {
        let beam = Frame::at((f64::from(i) - 3.0) * 3.0, HALF.2 - 0.35, 0.0);
        hall.add_all("room", "panel", 0.0, block(beam, 0.14, 0.5, HALF.1 + 0.1));
    }
    for x in WINDOWS {
        window(hall, Frame::at(x, 1.2, -HALF.1));
    }
    let end = Frame::at(HALF.0, 0.9, 0.0).turned(-0.25);
    hall.add("mirror", "mirror", 0.0, plate(end.moved(0.0, 0.0, 0.03), 2.6, 2.8));
    moulding(hall, "mirror", "shade", end, 2.6, 2.8, 0.14);
    board(hall, random);
}

/// Where the windows are along the wall.
const WINDOWS: [f64; 4] = [-7.2, -2.4, 2.4, 7.2];

fn shell(hall: &mut Model) {
    let (x, z, height) = HALF;
    let (long, wide) = (2.0 * (x + OVERLAP), 2.0 * (z + OVERLAP));
    let (low, high) = (-OVERLAP, height + 2.0 * OVERLAP);
    let (left, front) = (-x - OVERLAP, z + OVERLAP);
    let floor = Patch::quad(at(left, 0.0, front), at(long, 0.0, 0.0), at(0.0, 0.0, -wide));
    let ceiling = Patch::quad(at(left, height, -front), at(long, 0.0, 0.0), at(0.0, 0.0, wide));
    let walls = [
        Patch::quad(at(left, low, -z), at(long, 0.0, 0.0), at(0.0, high, 0.0)),
        Patch::quad(at(-left, low, z), at(-long, 0.0, 0.0), at(0.0, high, 0.0)),
        Patch::quad(at(-x, low, front), at(0.0, 0.0, -wide), at(0.0, high, 0.0)),
        Patch::quad(at(x, low, -front), at(0.0, 0.0, wide), at(0.0, high, 0.0)),
    ];
    hall.add("room", "carpet", 0.0, floor);
    hall.add("room", "plaster", 0.0, ceiling);
    hall.add_all("room", "plaster", 0.0, walls);
}

/// A rectangle that faces along the frame's z, centred over its origin.
fn plate(frame: Frame, width: f64, height: f64) -> Patch {
    let corner = frame.point(at(-width / 2.0, 0.0, 0.0));
    Patch::quad(corner, frame.vector(at(width, 0.0, 0.0)), frame.vector(at(0.0, height, 0.0)))
}

fn panel(hall: &mut Model, frame: Frame, half: f64, height: f64) {
    hall.add("panels", "panel", 0.0, plate(frame.moved(0.0, 0.0, 0.02), 2.0 * half, height));
    moulding(hall, "panels", "panel", frame, 2.0 * half, height, 0.07);
}

/// Four half-round mitred strips around a rectangle.
fn moulding(
    hall: &mut Model,
    group: &'static str,
    material: &'static str,
    frame: Frame,
    width: f64,
    height: f64,
    radius: f64,
) {
    let corners = [at(-0.5, 0.0, 0.0), at(0.5, 0.0, 0.0), at(0.5, 1.0, 0.0), at(-0.5, 1.0, 0.0)];
    let corners = corners.map(|c| c * at(width, height, 0.0));
    for i in 0..4 {
        let (from, to) = (corners[i], corners[(i + 1) % 4]);
        let along = (to - from).normalize();
        let out = along.cross(DVec3::Z);
        let strip = move |u: f64, v: f64| {
            let (across, lift) = turn(v / 2.0);
            let (across, lift) = (across * radius, lift * radius);
            let from = from - along * across;
            let to = to + along * across;
            frame.point(from + (to - from) * u + out * across + DVec3::Z * lift)
        };
        hall.add(group, material, 1.0, Patch::open(strip).least(2, 1));
    }
}

fn window(hall: &mut Model, frame: Frame) {
    hall.add("windows", "pane", 0.0, plate(frame.moved(0.0, 0.0, 0.03), 2.2, 2.6));
    moulding(hall, "windows", "plaster", frame, 2.2, 2.6, 0.09);
    for (x, y, half, height) in [(0.0, 0.0, 0.03, 2.6), (0.0, 1.7, 1.1, 0.06)] {
        hall.add_all("windows", "plaster", 0.0, block(frame.moved(x, y, 0.04), half, height, 0.04));
    }
    hall.add_all("windows", "panel", 0.0, block(frame.moved(0.0, -0.15, 0.12), 1.3, 0.06, 0.2));
}

/// A writing board and two doors at the far end.
fn board(hall: &mut Model, random: &mut Random) {
    let end = Frame::at(-HALF.0, 0.0, 0.0).turned(0.25);
    hall.add("board", "paper", 0.0, plate(end.moved(0.0, 1.1, 0.03), 4.4, 2.2));
    moulding(hall, "board", "steel", end.moved(0.0, 1.1, 0.0), 4.4, 2.2, 0.06);
    for side in [-1.0, 1.0] {
        let door = end.moved(side * 4.3, 0.0, 0.0);
        hall.add("doors", "panel", 0.0, plate(door.moved(0.0, 0.0, 0.03), 1.2, 2.4));
        moulding(hall, "doors", "panel", door, 1.2, 2.4, 0.08);
        moulding(hall, "doors", "panel", door.moved(0.0, 0.35, 0.02), 0.8, 0.7, 0.04);
        moulding(hall, "doors", "panel", door.moved(0.0, 1.25, 0.02), 0.8, 0.9, 0.04);
    }
    for i in 0..5 {
        let sheet = end.moved(f64::from(i) * 0.7 - 1.4, 1.5 + random.within(0.0, 0.5), 0.04);
        hall.add("board", "fabric", 0.0, plate(sheet, 0.5, random.within(0.4, 0.9)));
    }
}

/// Two drapes a window, each with folds of its own.
pub fn curtains(hall: &mut Model, random: &mut Random) {
    for x in WINDOWS {
        let rail = Frame::at(x, 0.0, -HALF.1 + 0.2);
        let [from, to] = [-1.75, 1.75].map(|x| rail.point(at(x, 4.0, 0.0)));
        hall.add("curtains", "steel", 1.0, crate::generate::shape::stick(from, to, 0.025));
        for side in [-1.0, 1.0] {
            let (seed, folds) = (random.bits(), 5.0 + (random.bits() & 3) as f64);
            let frame = rail.moved(side * 1.3, 0.05, 0.0);
            let drape = move |u: f64, v: f64| {
                let drawn = 0.42 - 0.1 * v + 0.05 * noise(seed, at(v * 3.0, 0.0, 7.0));
                let sway = 0.25 * noise(seed, at(u * 4.0, v * 1.5, 0.0));
                let fold = turn(u * folds + sway).1 * (0.09 - 0.04 * v);
                frame.point(at((2.0 * u - 1.0) * drawn, 3.95 * v, fold))
            };
            hall.add("curtains", "fabric", 1.0, Patch::open(drape).least(2, 20));
        }
    }
}
