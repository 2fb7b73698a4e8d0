//! Arches: openings in walls, and what follows their curve. A frame stands on the floor under the middle of the
//! arch and looks along its z at who sees the wall.

use crate::generate::circle::turn;
use crate::generate::frame::Frame;
use crate::generate::patch::Patch;
use crate::generate::shape::{at, rod};

/// The curve of a round or an elliptic arch.
#[derive(Clone, Copy)]
pub struct Arch {
    /// Where the curve begins.
    pub spring: f64,
    /// Half of its width.
    pub half: f64,
    /// Its height over the spring.
    pub rise: f64,
}

impl Arch {
    /// A half circle.
    pub fn round(spring: f64, radius: f64) -> Self {
        Arch { spring, half: radius, rise: radius }
    }

    /// From left to right over the top.
    fn point(self, share: f64) -> (f64, f64) {
        let (cosine, sine) = turn(share / 2.0);
        (-self.half * cosine, self.spring + self.rise * sine)
    }

    /// The wall over the opening, up to `top`.
    pub fn spandrel(self, frame: Frame, top: f64) -> Patch {
        let surface = move |u: f64, v: f64| {
            let (x, y) = self.point(u);
            let over = (2.0 * u - 1.0) * self.half;
            frame.point(at(x + (over - x) * v, y + (top - y) * v, 0.0))
        };
        Patch::open(surface).least(1, 5).faceted()
    }

    /// The wall on both sides of the opening, `width` wide in all, from `base` to `top`.
    pub fn jambs(self, frame: Frame, width: f64, base: f64, top: f64) -> [Patch; 2] {
        let jamb = width / 2.0 - self.half;
        [-width / 2.0, self.half].map(|left| {
            let corner = frame.point(at(left, base, 0.0));
            Patch::quad(corner, frame.vector(at(jamb, 0.0, 0.0)), frame.vector(at(0.0, top - base, 0.0)))
        })
    }

    /// The underside, `depth` into the wall.
    pub fn soffit(self, frame: Frame, depth: f64) -> Patch {
        let surface = move |u: f64, v: f64| {
            let (x, y) = self.point(u);
            frame.point(at(x, y, (v - 1.0) * depth))
        };
        Patch::open(surface).least(1, 5)
    }

    /// The area under the curve.
    pub fn lunette(self, frame: Frame) -> Patch {
        let surface = move |u: f64, v: f64| {
            let (x, y) = self.point(1.0 - u);
            frame.point(at(x * v, self.spring + (y - self.spring) * v, 0.0))
        };
        Patch::open(surface).least(1, 6).faceted()
    }

    /// A round moulding along the curve.
    pub fn moulding(self, frame: Frame, radius: f64) -> Patch {
        let path = move |v| {
            let (x, y) = self.point(v);
            frame.point(at(x, y, 0.0))
        };
        rod(path, move |_| radius).least(4, 3)
    }
}
