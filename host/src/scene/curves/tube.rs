//! Strands as tubes: rings of vertices around them, and flat ends.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::frame::Frame;
use super::outline::{Skin, Vertex, along};
use super::stations::Station;
use super::{Curves, Strand};
use crate::math;

/// The section of a tube.
pub struct Tube {
    /// The sine and cosine of the angle at each corner, counter-clockwise about the way of the strand.
    corners: Vec<[f64; 2]>,
    /// How many vertices a ring has: the first and the last are at one place where there are texture coordinates.
    columns: usize,
}

/// A ring of vertices around a station.
struct Ring {
    /// The number of its first vertex.
    first: u32,
    station: Station,
    /// From the centre to the first corner.
    normal: DVec3,
}

impl Tube {
    pub fn of(curves: &Curves, strand: &Strand) -> Tube {
        let sides = match curves.sides {
            Some(sides) => sides.clamp(*Curves::SIDES.start(), *Curves::SIDES.end()),
            None => sides(curves.tolerance_of(strand), strand.greatest_radius()),
        };
        let corner = |corner: u32| math::sin_cos(TAU * f64::from(corner) / f64::from(sides)).into();
        let corners: Vec<[f64; 2]> = (0..sides).map(corner).collect();
        Tube { columns: corners.len() + usize::from(curves.has_coordinates), corners }
    }

    pub fn station_size(&self) -> (usize, usize) {
        (2 * self.corners.len(), self.columns)
    }

    pub fn ends_size(&self) -> (usize, usize) {
        (2 * self.corners.len(), 2 * self.corners.len())
    }

    /// Adds it to a mesh.
    pub fn add(&self, skin: &mut Skin, stations: &[Station]) {
        let mut frame = Frame::default();
        let mut last: Option<Ring> = None;
        for (station, along) in along(stations) {
            skin.go_to(station, along);
            let normal = frame.normal(station, None);
            let ring = self.ring(skin, station, normal);
            match &last {
                Some(last) => self.wall(skin, last.first, ring.first),
                None => self.end(skin, &ring, false),
            }
            last = Some(ring);
        }
        if let Some(last) = last {
            self.end(skin, &last, true);
        }
    }

    fn ring(&self, skin: &mut Skin, station: &Station, normal: DVec3) -> Ring {
        let ring = Ring { first: skin.next_number(), station: *station, normal };
        let Station { center, radius, tangent, slope, .. } = *station;
        for corner in 0..self.columns {
            let spoke = self.spoke(&ring, corner);
            // Where a strand gets thinner its surface faces ahead.
            skin.vertex(&Vertex {
                place: center + spoke * radius,
                normal: spoke - tangent * slope,
                tangent: tangent + spoke * slope,
                across: corner as f64 / self.corners.len() as f64,
            });
        }
        ring
    }

    /// The unit vector from the centre of a ring to a corner.
    fn spoke(&self, ring: &Ring, corner: usize) -> DVec3 {
        let [sine, cosine] = self.corners[corner % self.corners.len()];
        ring.normal * cosine + ring.station.tangent.cross(ring.normal) * sine
    }

    /// The surface between two rings.
    fn wall(&self, skin: &mut Skin, from: u32, to: u32) {
        let columns = self.columns as u32;
        for corner in 0..self.corners.len() as u32 {
            let next = (corner + 1) % columns;
            let [a, b, c, d] = [from + corner, from + next, to + next, to + corner];
            skin.triangle([a, b, c]);
            skin.triangle([a, c, d]);
        }
    }

    /// A polygon with the normal of the end, but for a tip.
    fn end(&self, skin: &mut Skin, ring: &Ring, is_last: bool) {
        let Station { center, radius, tangent, .. } = ring.station;
        if radius == 0.0 {
            return;
        }
        let outwards = if is_last { tangent } else { -tangent };
        let sides = self.corners.len();
        let corner = |corner: usize| Vertex {
            place: center + self.spoke(ring, corner) * radius,
            normal: outwards,
            tangent: ring.normal,
            across: corner as f64 / sides as f64,
        };
        let numbers: Vec<u32> = (0..sides).map(|number| skin.vertex(&corner(number))).collect();
        for pair in numbers[1..].windows(2) {
            skin.triangle(if is_last { [numbers[0], pair[0], pair[1]] } else { [numbers[0], pair[1], pair[0]] });
        }
    }
}

/// An even number of sides whose middles are no farther than the tolerance from the circle through their corners.
fn sides(tolerance: f64, radius: f64) -> u32 {
    const LEAST: u32 = 4;
    if tolerance >= radius {
        return LEAST;
    }
    let half = PI / math::acos(1.0 - tolerance / radius) / 2.0;
    ((2.0 * half.ceil()) as u32).clamp(LEAST, *Curves::SIDES.end())
}
