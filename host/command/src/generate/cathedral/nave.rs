//! The bays of nave and choir, with their aisles.

use super::arch::Arch;
use super::{AISLE, ALONG, BAY, NAVE, SIDES, SPRING, column, crossing, pane, vault};
use crate::generate::frame::Frame;
use crate::generate::model::Model;
use crate::generate::patch::Patch;
use crate::generate::random::Random;
use crate::generate::shape::{at, stick};

/// The arches of the arcade.
const ARCADE: Arch = Arch { spring: SPRING.0, half: 1.5, rise: 1.5 };

/// The west wall, all bays, and the columns between them.
pub fn build(church: &mut Model, random: &mut Random) {
    west(church, random);
    let bays = ((ALONG[1] - ALONG[0]) / BAY) as u32;
    let nave = (0..bays).map(|i| ALONG[0] + BAY * (f64::from(i) + 0.5));
    for z in nave.chain([ALONG[2] + BAY / 2.0]) {
        high_vault(church, z);
        for side in SIDES {
            // Facing the axis from this side.
            let frame = Frame::at(0.0, 0.0, z).turned(-0.25 * side).moved(0.0, 0.0, -NAVE);
            arcade(church, frame);
            clerestory(church, frame, random);
            aisle(church, side, z);
            outer_wall(church, frame.moved(0.0, 0.0, NAVE - AISLE.2), random);
        }
    }
    let between = (0..bays).map(|i| ALONG[0] + BAY * f64::from(i));
    for z in between.chain([ALONG[3]]) {
        for side in SIDES {
            let middle = side * (NAVE + AISLE.0) / 2.0;
            column::build(church, "columns", Frame::at(middle, 0.0, z), SPRING.0, 0.36);
            let (low, high) = (at(side * NAVE, SPRING.0, z), at(side * NAVE, SPRING.2, z));
            church.add("walls", "pillar", 1.0, stick(low, high, 0.14).least(1, 5));
            let (low, high) = (at(side * AISLE.2, 0.0, z), at(side * AISLE.2, SPRING.1, z));
            church.add("walls", "pillar", 1.0, stick(low, high, 0.2).least(1, 5));
        }
        let rib = Arch::round(SPRING.2, NAVE).moulding(Frame::at(0.0, 0.0, z), 0.17);
        church.add("ribs", "pillar", 1.5, rib);
    }
}

/// The wall at the nave's beginning, with a door and a round window.
fn west(church: &mut Model, random: &mut Random) {
    let frame = Frame::at(0.0, 0.0, ALONG[0]);
    let (wide, high) = (at(2.0 * AISLE.2 + 1.0, 0.0, 0.0), at(0.0, 14.0, 0.0));
    church.add("walls", "stone", 0.0, Patch::quad(frame.point(-wide / 2.0), wide, high));
    crossing::rose(church, frame.moved(0.0, 7.6, 0.05), 1.9, random);
    let door = Arch::round(2.6, 1.2);
    let leaf = Patch::quad(frame.point(at(-1.2, 0.0, 0.04)), at(2.4, 0.0, 0.0), at(0.0, door.spring, 0.0));
    church.add("doors", "wood", 0.0, leaf);
    church.add("doors", "red", 0.2, door.lunette(frame.moved(0.0, 0.0, 0.04)));
    for radius in [1.2, 1.5, 1.8] {
        let order = Arch::round(door.spring, radius);
        church.add("arches", "pillar", 1.5, order.moulding(frame, 0.14));
        for side in SIDES {
            let [low, high] = [0.0, door.spring].map(|y| frame.point(at(side * radius, y, 0.0)));
            church.add("arches", "pillar", 1.5, stick(low, high, 0.12).least(1, 5));
        }
    }
}

fn high_vault(church: &mut Model, z: f64) {
    let (middle, half) = (at(0.0, SPRING.2, z), (NAVE, BAY / 2.0));
    church.add_all("vaults", "vault", 1.0, vault::groin(middle, half, NAVE));
    church.add_all("ribs", "pillar", 1.5, vault::ribs(middle, half, NAVE, 0.1));
}

/// An arch between two columns and the wall upon it, towards nave and aisle.
fn arcade(church: &mut Model, frame: Frame) {
    let thick = AISLE.0 - NAVE;
    let behind = frame.turned(0.5).moved(0.0, 0.0, thick);
    for (frame, top) in [(frame, SPRING.2), (behind, 7.0)] {
        church.add("walls", "stone", 0.2, ARCADE.spandrel(frame, top));
        church.add_all("walls", "stone", 0.0, ARCADE.jambs(frame, BAY, SPRING.0, top));
        let trim = Arch { half: 1.6, rise: 1.6, ..ARCADE };
        church.add("arches", "pillar", 1.5, trim.moulding(frame, 0.11));
    }
    church.add("arches", "stone", 1.0, ARCADE.soffit(frame, thick));
    for (y, radius) in [(6.2, 0.09), (SPRING.2 - 0.1, 0.13)] {
        let [from, to] = [-BAY / 2.0, BAY / 2.0].map(|x| frame.point(at(x, y, 0.0)));
        church.add("walls", "pillar", 1.0, stick(from, to, radius).least(1, 3));
    }
}

/// The wall under the high vault with its window.
fn clerestory(church: &mut Model, frame: Frame, random: &mut Random) {
    let wall = Arch { spring: SPRING.2, half: BAY / 2.0, rise: NAVE };
    let window = Arch { spring: SPRING.2 + 0.5, half: 1.0, rise: 2.0 };
    church.add("walls", "stone", 0.2, wall.lunette(frame));
    church.add("windows", pane(random), 0.2, window.lunette(frame.moved(0.0, 0.0, 0.04)));
    church.add("windows", "pillar", 1.0, window.moulding(frame.moved(0.0, 0.0, 0.04), 0.09));
}

fn aisle(church: &mut Model, side: f64, z: f64) {
    let half = (AISLE.1 - AISLE.0, BAY / 2.0);
    church.add_all("vaults", "vault", 1.0, vault::groin(at(side * AISLE.1, SPRING.1, z), half, half.0));
    let rib = Arch::round(SPRING.1, half.0).moulding(Frame::at(side * AISLE.1, 0.0, z - BAY / 2.0), 0.12);
    church.add("ribs", "pillar", 1.5, rib);
}

/// The aisle's wall around a window in a niche.
fn outer_wall(church: &mut Model, frame: Frame, random: &mut Random) {
    let (sill, depth) = (1.5, 0.35);
    let niche = Arch::round(3.2, 0.8);
    church.add("walls", "stone", 0.2, niche.spandrel(frame, SPRING.1));
    church.add_all("walls", "stone", 0.0, niche.jambs(frame, BAY, 0.0, SPRING.1));
    let wide = frame.vector(at(1.6, 0.0, 0.0));
    let quad = |x, y, z, along, up| Patch::quad(frame.point(at(x, y, z)), along, up);
    let (high, deep) = (frame.vector(at(0.0, niche.spring - sill, 0.0)), frame.vector(at(0.0, 0.0, depth)));
    let planes = [
        quad(-0.8, 0.0, 0.0, wide, frame.vector(at(0.0, sill, 0.0))),
        quad(-0.8, sill, 0.0, wide, -deep),
        quad(-0.8, sill, 0.0, -deep, high),
        quad(0.8, sill, -depth, deep, high),
    ];
    church.add_all("walls", "stone", 0.0, planes);
    church.add("walls", "stone", 1.0, niche.soffit(frame, depth));
    let glass = pane(random);
    church.add("windows", glass, 0.0, quad(-0.8, sill, -depth, wide, high));
    church.add("windows", glass, 0.2, niche.lunette(frame.moved(0.0, 0.0, -depth)));
    let bar = [at(0.0, sill, -depth), at(0.0, niche.spring + niche.rise, -depth)].map(|p| frame.point(p));
    church.add("windows", "iron", 1.0, stick(bar[0], bar[1], 0.03).least(1, 3));
    let wall = Arch { spring: SPRING.1, half: BAY / 2.0, rise: AISLE.1 - AISLE.0 };
    church.add("walls", "stone", 0.2, wall.lunette(frame));
}
