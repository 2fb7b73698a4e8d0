//! What lies and stands on the table.

use super::TABLE;
use crate::generate::frame::Frame;
use crate::generate::model::Model;
use crate::generate::patch::Patch;
use crate::generate::random::Random;
use crate::generate::shape::{at, lathe, stick};

/// A sheet of paper, a pen and a tumbler before a chair.
pub fn place(hall: &mut Model, seat: Frame, random: &mut Random) {
    let front = seat.moved(random.within(-0.08, 0.08), TABLE.2, 0.75);
    let sheet = front.turned(random.within(-0.04, 0.04));
    let corner = sheet.point(at(-0.105, 0.003, 0.15));
    let paper = Patch::quad(corner, sheet.vector(at(0.21, 0.0, 0.0)), sheet.vector(at(0.0, 0.0, -0.297)));
    hall.add("tableware", "paper", 0.0, paper);
    let pen = sheet.turned(random.within(0.0, 0.2));
    let [from, to] = [at(0.13, 0.008, 0.0), at(0.13, 0.008, 0.14)].map(|end| pen.point(end));
    hall.add("tableware", "steel", 1.0, stick(from, to, 0.005).least(1, 3));
    let tumbler = [
        (0.0, 0.0),
        (0.03, 0.001),
        (0.034, 0.05),
        (0.038, 0.118),
        (0.0365, 0.12),
        (0.035, 0.118),
        (0.031, 0.05),
        (0.028, 0.012),
        (0.0, 0.01),
    ];
    let stand = front.moved(-0.22, 0.002, 0.1 + random.within(-0.05, 0.05));
    hall.add("tableware", "glass", 4.0, lathe(stand, &tumbler).least(8, 5));
}

/// Three carafes of glass along the middle.
pub fn carafes(hall: &mut Model, random: &mut Random) {
    let carafe = [
        (0.0, 0.0),
        (0.07, 0.002),
        (0.085, 0.06),
        (0.06, 0.15),
        (0.03, 0.2),
        (0.042, 0.26),
        (0.039, 0.262),
        (0.026, 0.2),
        (0.055, 0.15),
        (0.08, 0.06),
        (0.065, 0.012),
        (0.0, 0.01),
    ];
    for x in [-3.6, 0.0, 3.6] {
        let stand = Frame::at(x + random.within(-0.3, 0.3), TABLE.2 + 0.002, random.within(-0.2, 0.2));
        hall.add("tableware", "glass", 4.0, lathe(stand, &carafe).least(11, 8));
    }
}
