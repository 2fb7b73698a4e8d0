//! The crossing under its dome with the arms beside it, and the apse at the end.

use super::arch::Arch;
use super::{AISLE, ALONG, NAVE, SIDES, SPRING, column, pane};
use crate::generate::circle::turn;
use crate::generate::frame::Frame;
use crate::generate::model::Model;
use crate::generate::patch::Patch;
use crate::generate::random::Random;
use crate::generate::shape::{at, blend, block, rod, stick};

/// Where drum and dome begin over the middle of the crossing.
const DRUM: (f64, f64) = (SPRING.2 + NAVE, SPRING.2 + NAVE + 2.6);

/// Piers, arches, pendentives, drum, dome and arms.
pub fn build(church: &mut Model, random: &mut Random) {
    let middle = Frame::at(0.0, 0.0, (ALONG[1] + ALONG[2]) / 2.0);
    for quarter in 0..4 {
        let frame = middle.turned(f64::from(quarter) / 4.0);
        church.add("vaults", "vault", 1.0, pendentive(frame));
        let side = frame.moved(0.0, 0.0, -NAVE);
        church.add("ribs", "pillar", 1.5, Arch::round(SPRING.2, NAVE).moulding(side, 0.26));
        pier(church, frame);
    }
    for side in SIDES {
        arm(church, middle, side, random);
    }
    drum(church, middle, random);
}

/// From a corner of the square to a quarter of the drum's ring, on one sphere.
fn pendentive(frame: Frame) -> Patch {
    let surface = move |u: f64, v: f64| {
        let (x, z) = turn((1.0 - u) / 4.0);
        let (x, z) = (NAVE * blend(1.0, x, v), NAVE * blend(1.0, z, v));
        frame.point(at(x, SPRING.2 + (2.0 * NAVE * NAVE - x * x - z * z).max(0.0).sqrt(), z))
    };
    Patch::open(surface).least(3, 4)
}

/// A pier with a shaft on its inner edge.
fn pier(church: &mut Model, frame: Frame) {
    let half = (AISLE.0 - NAVE) / 2.0;
    let body = frame.moved(NAVE + half, 0.0, NAVE + half);
    church.add_all("columns", "stone", 0.0, block(body, half, SPRING.2, half));
    let [low, high] = [0.0, SPRING.2].map(|y| frame.point(at(NAVE, y, NAVE)));
    church.add("columns", "pillar", 2.0, stick(low, high, 0.24).least(1, 8));
    church.add_all("columns", "pillar", 0.0, block(body.moved(0.0, SPRING.2 - 0.35, 0.0), 0.62, 0.3, 0.62));
    church.add_all("columns", "pillar", 0.0, block(body, 0.62, 0.4, 0.62));
}

/// A barrel beside the crossing, the walls over the aisles' ends, and a rose window.
fn arm(church: &mut Model, middle: Frame, side: f64, random: &mut Random) {
    let reach = AISLE.2 - NAVE;
    let axis = middle.turned(-0.25 * side);
    let barrel = Arch::round(SPRING.2, NAVE);
    church.add("vaults", "vault", 1.0, barrel.soffit(axis.moved(0.0, 0.0, -NAVE), reach).least(1, 8));
    let end = axis.moved(0.0, 0.0, -AISLE.2);
    let corner = end.point(at(-NAVE, 0.0, 0.0));
    let wall = Patch::quad(corner, end.vector(at(2.0 * NAVE, 0.0, 0.0)), end.vector(at(0.0, SPRING.2, 0.0)));
    church.add("walls", "stone", 0.0, wall);
    church.add("walls", "stone", 0.2, barrel.lunette(end));
    rose(church, end.moved(0.0, 7.0, 0.05), 2.2, random);
    let opening = Arch::round(SPRING.1, AISLE.1 - AISLE.0);
    for (z, turns) in [(ALONG[1], 0.0), (ALONG[2], 0.5)] {
        let frame = Frame::at(side * AISLE.1, 0.0, z).turned(turns);
        church.add("walls", "stone", 0.2, opening.spandrel(frame, SPRING.2));
        church.add("arches", "pillar", 1.5, opening.moulding(frame, 0.16));
    }
}

/// A round window: petals of colour between rods of stone.
pub fn rose(church: &mut Model, frame: Frame, radius: f64, random: &mut Random) {
    const PETALS: u32 = 8;
    for i in 0..PETALS {
        let sector = move |u: f64, v: f64| {
            let (x, y) = turn((f64::from(i) + u) / f64::from(PETALS));
            frame.point(at(-x, y, 0.0) * (radius * (1.0 - v)))
        };
        church.add("windows", pane(random), 0.2, Patch::open(sector).least(1, 2).faceted());
        let (x, y) = turn(f64::from(i) / f64::from(PETALS));
        let rim = frame.point(at(x, y, 0.0) * radius);
        church.add("windows", "pillar", 1.0, stick(frame.origin, rim, 0.05).least(1, 3));
    }
    church.add("windows", "pillar", 1.5, hoop(frame.leaning(0.25), 0.0, radius, 0.14).least(10, 3));
}

/// A ring about the frame's upright axis.
fn hoop(frame: Frame, y: f64, radius: f64, thick: f64) -> Patch {
    Patch::tube(move |u, v| {
        let ((x, z), (out, up)) = (turn(v), turn(u));
        frame.point(at(x * (radius + out * thick), y + up * thick, z * (radius + out * thick)))
    })
    .least(12, 3)
}

fn drum(church: &mut Model, frame: Frame, random: &mut Random) {
    let (low, high) = DRUM;
    let wall = move |u: f64, v: f64| {
        let (x, z) = turn(u);
        frame.point(at(x * NAVE, blend(low, high, v), z * NAVE))
    };
    church.add("dome", "stone", 1.0, Patch::tube(wall).least(1, 16));
    let dome = move |u: f64, v: f64| {
        let ((x, z), (out, up)) = (turn(u), turn(v / 4.0));
        frame.point(at(x * NAVE * out.max(0.0), high + NAVE * up, z * NAVE * out.max(0.0)))
    };
    church.add("dome", "vault", 1.0, Patch::tube(dome).least(4, 16));
    for (y, thick) in [(low, 0.2), (high, 0.16)] {
        church.add("dome", "pillar", 1.5, hoop(frame, y, NAVE - 0.02, thick));
    }
    for i in 0..8 {
        let turned = frame.turned(f64::from(i) / 8.0);
        let window = Arch::round(low + 1.5, 0.5);
        let inner = turned.moved(0.0, 0.0, -0.96 * NAVE);
        church.add("windows", pane(random), 0.2, window.lunette(inner));
        let (corner, wide) = (inner.point(at(-0.5, low + 0.5, 0.0)), inner.vector(at(1.0, 0.0, 0.0)));
        church.add("windows", pane(random), 0.0, Patch::quad(corner, wide, at(0.0, 1.0, 0.0)));
        church.add("windows", "pillar", 1.0, window.moulding(inner, 0.06));
        let between = frame.turned((f64::from(i) + 0.5) / 8.0);
        let rib = move |v: f64| {
            let (out, up) = turn(0.23 * v);
            between.point(at(0.0, high + NAVE * up, -NAVE * out))
        };
        church.add("ribs", "pillar", 1.5, rod(rib, |_| 0.09).least(3, 3));
    }
}

/// The half round end with its own half dome, and the walls beside it.
pub fn apse(church: &mut Model) {
    let frame = Frame::at(0.0, 0.0, ALONG[3]);
    for side in SIDES {
        let left = if side < 0.0 { -AISLE.2 - 0.4 } else { NAVE - 0.02 };
        let wide = AISLE.2 + 0.4 - NAVE + 0.02;
        let wall = Patch::quad(at(left + wide, 0.0, ALONG[3]), at(-wide, 0.0, 0.0), at(0.0, 9.0, 0.0));
        church.add("walls", "stone", 0.0, wall);
    }
    for i in 0..7 {
        let (x, z) = turn((f64::from(i) + 0.5) / 14.0);
        column::build(church, "colonnade", frame.moved(x * 3.3, 0.5, z * 3.3), 2.9, 0.13);
    }
    for y in [3.5, SPRING.2] {
        let cornice = move |v: f64| {
            let (x, z) = turn(v / 2.0);
            frame.point(at(x * 3.5, y, z * 3.5))
        };
        church.add("apse", "pillar", 1.5, rod(cornice, |_| 0.16).least(8, 3));
    }
    let half_dome = move |u: f64, v: f64| {
        let ((x, z), (out, up)) = (turn(u / 2.0), turn(v / 4.0));
        frame.point(at(x * NAVE * out.max(0.0), SPRING.2 + NAVE * up, z * NAVE * out.max(0.0)))
    };
    church.add("apse", "gold", 1.0, Patch::open(half_dome).least(4, 8));
    let wall = move |u: f64, v: f64| {
        let (x, z) = turn(u / 2.0);
        frame.point(at(x * NAVE, SPRING.2 * v, z * NAVE))
    };
    church.add("apse", "stone", 1.0, Patch::open(wall).least(1, 10));
}
