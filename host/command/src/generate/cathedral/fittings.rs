//! Pews, lamps, the font and the altar, and what nobody sees: the crypt and the beams of the roof.

use super::{ALONG, NAVE, SIDES, SPRING};
use crate::generate::circle::turn;
use crate::generate::frame::Frame;
use crate::generate::model::Model;
use crate::generate::patch::Patch;
use crate::generate::random::Random;
use crate::generate::shape::{at, ball, block, lathe, stick};

/// All of them.
pub fn build(church: &mut Model, random: &mut Random) {
    for row in 0..10 {
        for side in SIDES {
            let z = -16.5 + 1.35 * f64::from(row) + random.within(-0.03, 0.03);
            pew(church, Frame::at(side * 1.95, 0.0, z).turned(random.within(-0.003, 0.003)));
        }
    }
    for z in [-18.0, -12.0, -6.0, 0.0] {
        for side in SIDES {
            lamp(church, Frame::at(side * 1.9, 4.2 + random.within(-0.15, 0.15), z), 11.0);
        }
    }
    font(church);
    choir(church, random);
    hidden(church);
}

fn pew(church: &mut Model, frame: Frame) {
    church.add_all("pews", "wood", 0.0, block(frame.moved(0.0, 0.42, 0.0), 1.25, 0.05, 0.2));
    church.add_all("pews", "wood", 0.0, block(frame.moved(0.0, 0.1, -0.22).leaning(-0.02), 1.25, 0.8, 0.025));
    for side in SIDES {
        church.add_all("pews", "wood", 0.0, block(frame.moved(side * 1.25, 0.0, -0.03), 0.03, 0.7, 0.25));
    }
}

/// A globe of glass in a crown of gold on a chain from the vault.
fn lamp(church: &mut Model, frame: Frame, top: f64) {
    let (low, high) = (frame.point(at(0.0, 0.3, 0.0)), at(frame.origin.x, top, frame.origin.z));
    church.add("lamps", "iron", 1.0, stick(low, high, 0.015).least(1, 3));
    church.add("lamps", "glass", 2.0, ball(move |p| frame.point(p * 0.2)).least(5, 8));
    let crown = [(0.24, -0.05), (0.27, 0.0), (0.22, 0.1), (0.1, 0.22), (0.02, 0.32)];
    church.add("lamps", "gold", 2.0, lathe(frame, &crown).least(3, 7));
}

/// A basin that holds water up to its brim.
fn font(church: &mut Model) {
    let frame = Frame::at(2.4, 0.0, -18.2);
    let basin = [
        (0.45, 0.0),
        (0.42, 0.12),
        (0.2, 0.25),
        (0.17, 0.5),
        (0.3, 0.7),
        (0.6, 0.85),
        (0.65, 1.0),
        (0.6, 1.02),
        (0.52, 0.92),
        (0.3, 0.8),
        (0.0, 0.76),
    ];
    church.add("font", "marble", 2.0, lathe(frame, &basin).least(10, 12));
    let ripple = |p: glam::DVec3| at(0.0, 0.004 * (p.x * p.x + p.z * p.z), 0.0);
    let water = ball(move |p| {
        frame.point(at(0.0, 0.95, 0.0) + ripple(p) + p * at(0.55, if p.y < 0.0 { 0.14 } else { 0.01 }, 0.55))
    });
    church.add("font", "water", 1.0, water.least(6, 10));
}

/// Steps, the altar under its linen, candles and a cross.
fn choir(church: &mut Model, random: &mut Random) {
    for step in 0..3 {
        let rise = 0.16 * f64::from(step);
        let depth = 2.6 - 0.3 * f64::from(step);
        let frame = Frame::at(0.0, rise, ALONG[3] - 0.2);
        church.add_all("choir", "marble", 0.0, block(frame, NAVE - 0.6 - 0.2 * f64::from(step), 0.16, depth));
    }
    let altar = Frame::at(0.0, 0.48, ALONG[3] + 0.6);
    church.add_all("choir", "stone", 0.0, block(altar, 1.2, 1.0, 0.45));
    let cloth = move |u: f64, v: f64| {
        let (x, z) = turn(u);
        let norm = ((x * x * x * x) + (z * z * z * z)).sqrt().sqrt();
        let hang = (2.0 * v - 1.0).max(0.0);
        let fold = 1.0 + 0.05 * hang * turn(u * 22.0).0;
        let reach = (2.0 * v).min(1.0) * fold / norm;
        altar.point(at(1.26 * x * reach, 1.02 - 0.3 * hang, 0.5 * z * reach))
    };
    church.add("choir", "linen", 1.0, Patch::tube(cloth).least(4, 24));
    let stick_outline =
        [(0.1, 0.0), (0.09, 0.03), (0.025, 0.08), (0.02, 0.25), (0.04, 0.3), (0.02, 0.35), (0.06, 0.45)];
    for x in [-0.9, -0.6, -0.3, 0.3, 0.6, 0.9] {
        let frame = altar.moved(x, 1.02, random.within(-0.04, 0.04));
        church.add("choir", "gold", 3.0, lathe(frame, &stick_outline).least(5, 6));
        let [low, high] = [0.44, 0.8 + random.within(-0.08, 0.05)].map(|y| frame.point(at(0.0, y, 0.0)));
        church.add("choir", "linen", 2.0, stick(low, high, 0.025).least(1, 5));
    }
    church.add_all("choir", "gold", 0.0, block(altar.moved(0.0, 1.02, 0.0), 0.04, 1.3, 0.03));
    church.add_all("choir", "gold", 0.0, block(altar.moved(0.0, 1.8, 0.0), 0.35, 0.08, 0.03));
}

fn hidden(church: &mut Model) {
    for i in 0..5 {
        for x in [-6.0, -2.0, 2.0, 6.0] {
            let z = ALONG[0] + 4.0 + 8.0 * f64::from(i);
            church.add("crypt", "pillar", 1.0, stick(at(x, -3.2, z), at(x, 0.0, z), 0.4).least(1, 5));
        }
        for side in SIDES {
            let z = ALONG[0] + 2.0 + 5.0 * f64::from(i);
            let (eaves, ridge) = (at(side * 5.0, SPRING.2 + 4.0, z), at(0.0, 16.5, z));
            church.add("roof", "wood", 0.5, stick(eaves, ridge, 0.15).least(1, 4));
        }
    }
}
