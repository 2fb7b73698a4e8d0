//! Columns: a base, a fluted shaft and a capital of leaves.

use crate::generate::circle::turn;
use crate::generate::frame::Frame;
use crate::generate::model::Model;
use crate::generate::patch::Patch;
use crate::generate::shape::{at, blend, block, lathe};

/// A column of this height and thickness.
pub fn build(church: &mut Model, group: &'static str, frame: Frame, height: f64, radius: f64) {
    let base = [(1.55, 0.0), (1.6, 0.18), (1.35, 0.3), (1.15, 0.42), (1.28, 0.55), (1.0, 0.7)];
    let base = base.map(|(wide, high)| (wide * radius, high * radius + 0.2));
    church.add_all(group, "pillar", 0.0, block(frame, 1.7 * radius, 0.2, 1.7 * radius));
    church.add(group, "pillar", 2.0, lathe(frame, &base).least(2, 6));
    let (foot, neck) = (0.2 + 0.7 * radius, height - 2.1 * radius);
    church.add(group, "pillar", 2.0, shaft(frame, foot, neck, radius));
    church.add(group, "pillar", 3.0, capital(frame, neck, 1.6 * radius, radius));
    let abacus = frame.moved(0.0, height - 0.5 * radius, 0.0);
    church.add_all(group, "pillar", 0.0, block(abacus, 1.6 * radius, 0.5 * radius, 1.6 * radius));
}

fn shaft(frame: Frame, foot: f64, neck: f64, radius: f64) -> Patch {
    let surface = move |u: f64, v: f64| {
        let (x, z) = turn(u);
        let flute = 1.0 - 0.03 * (1.0 - turn(u * 10.0).0);
        let wide = radius * blend(1.0, 0.88, v * v) * flute;
        frame.point(at(x * wide, blend(foot, neck, v), -z * wide))
    };
    Patch::tube(surface).least(1, 10)
}

/// Two rows of leaves that bend outwards.
fn capital(frame: Frame, low: f64, height: f64, radius: f64) -> Patch {
    let surface = move |u: f64, v: f64| {
        let (x, z) = turn(u);
        let row = (2.0 * v).floor().min(1.0);
        let part = 2.0 * v - row;
        let leaf = 0.5 + 0.5 * turn(u * 8.0 + 0.5 * row).0;
        let curl = 0.3 * leaf * part * part * (1.0 - part) * 4.0;
        let wide = radius * (blend(0.88, 1.45, v * v) + curl);
        frame.point(at(x * wide, low + height * v, -z * wide))
    };
    Patch::tube(surface).least(2, 8)
}
