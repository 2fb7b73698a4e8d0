//! Vaults over bays.

use glam::DVec3;

use super::SIDES;
use crate::generate::circle::turn;
use crate::generate::frame::Frame;
use crate::generate::patch::Patch;
use crate::generate::shape::{at, rod};

/// A groin vault over a rectangle of these half sides, seen from below: two barrels that meet in the diagonals.
pub fn groin(middle: DVec3, half: (f64, f64), rise: f64) -> [Patch; 4] {
    [0.0, 1.0, 2.0, 3.0].map(|quarter: f64| {
        let frame = Frame::at(middle.x, middle.y, middle.z).turned(quarter / 4.0);
        let (ahead, aside) = if quarter % 2.0 == 0.0 { half } else { (half.1, half.0) };
        let web = move |u: f64, v: f64| {
            // Steps along both curves are even in angle.
            let share = turn(v / 4.0).1;
            let across = share * turn(u / 2.0).0;
            frame.point(at(ahead * share, rise * (1.0 - across * across).max(0.0).sqrt(), aside * across))
        };
        Patch::open(web).least(2, 3)
    })
}

/// The ribs under a groin vault's diagonals.
pub fn ribs(middle: DVec3, half: (f64, f64), rise: f64, radius: f64) -> [Patch; 2] {
    SIDES.map(|side| {
        let path = move |v: f64| {
            let (along, up) = turn(v / 2.0);
            middle + at(half.0 * along, rise * up, side * half.1 * along)
        };
        rod(path, move |_| radius).least(4, 3)
    })
}
