//! Where along a strand its surface has vertices.

use glam::{DVec3, DVec4};

use super::basis::halves;
use super::{Basis, ControlPoint, Strand};
use crate::math;

/// A place along a strand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Station {
    pub center: DVec3,
    pub radius: f64,
    /// The unit vector along the strand.
    pub tangent: DVec3,
    /// By how much the radius grows a unit of length.
    pub slope: f64,
    /// The number of the Bezier curve, and the share of its way.
    pub piece: usize,
    pub share: f64,
}

/// The most that a strand turns from one station to the next, in radians: surfaces between them would fold.
const MOST_TURN: f64 = std::f64::consts::FRAC_PI_3;
/// The least that it turns at a corner before there is another station, in radians, whatever the tolerance asks for.
const LEAST_TURN: f64 = std::f64::consts::PI / 90.0;
/// How often a Bezier curve is halved at most: it then differs from its chord by a share of 4^-12 of what it did, which is less than
/// single precision tells.
const MOST_HALVES: u32 = 12;
/// Shares of the coordinates that are no length but errors of rounding.
const ROUNDING: f64 = 1e-13;

/// Gives the stations of a strand to `visit`, in order: so close that straight lines between them are no farther than the tolerance from
/// the curve, and lines along its surface from that. Corners, cusps and reversals have several at one place, which turn from one way to the
/// other. Points that repeat the one before have none of their own, and neither have strands of a wrong number of points.
///
/// # Errors
/// That of `visit`, which ends it.
pub fn each<E>(
    strand: &Strand,
    basis: Basis,
    tolerance: f64,
    visit: impl FnMut(Station) -> Result<(), E>,
) -> Result<(), E> {
    let Ok(pieces) = basis.pieces(strand.points.len()) else { return Ok(()) };
    let far = |most: f32, at: &ControlPoint| most.max(at.position.abs().max_element());
    let nothing = ROUNDING * f64::from(strand.points.iter().fold(0.0, far));
    let most_halves = if basis == Basis::Linear { 0 } else { MOST_HALVES };
    let mut walk = Walk { tolerance, nothing, most_halves, last: None, visit };
    for number in 0..pieces {
        walk.part(&Part { points: strand.piece(basis, number), piece: number, shares: [0.0, 1.0], halved: 0 })?;
    }
    match walk.last {
        Some(last) => (walk.visit)(last),
        None => Ok(()),
    }
}

/// A part of a Bezier curve, and the curve that it is itself.
struct Part {
    points: [DVec4; 4],
    piece: usize,
    shares: [f64; 2],
    halved: u32,
}

/// Where a curve leads, and by how much its radius grows a unit of length.
#[derive(Clone, Copy)]
struct Way {
    tangent: DVec3,
    slope: f64,
}

impl Part {
    fn halves(&self) -> [Part; 2] {
        let [from, to] = self.shares;
        let middle = 0.5 * (from + to);
        let [first, second] = halves(self.points);
        let part = |points, shares| Part { points, shares, piece: self.piece, halved: self.halved + 1 };
        [part(first, [from, middle]), part(second, [middle, to])]
    }

    /// The way at its start and at its end, where it has a length: also where points coincide there, and so a tangent is zero.
    fn ways(&self, nothing: f64) -> Option<[Way; 2]> {
        let [a, b, c, d] = self.points;
        let size = [b, c, d].map(|point| (point - a).truncate().length()).into_iter().fold(0.0, f64::max);
        let least = nothing.max(1e-9 * size);
        let way = |step: &DVec4| {
            let length = step.truncate().length();
            (length > least).then(|| Way { tangent: step.truncate() / length, slope: step.w / length })
        };
        let first = [b - a, c - a, d - a].iter().find_map(way)?;
        let last = [d - c, d - b, d - a].iter().find_map(way);
        Some([first, last.unwrap_or(first)])
    }

    /// How far it may be from its chord at most, places and radii together: an eighth of the greatest second derivative.
    fn bend(&self) -> f64 {
        let [a, b, c, d] = self.points;
        let bends = [a - b * 2.0 + c, b - c * 2.0 + d];
        0.75 * bends.map(|bend| bend.truncate().length() + bend.w.abs()).into_iter().fold(0.0, f64::max)
    }

    /// By how much it turns at most, in radians: as much as its polygon.
    fn turn(&self, nothing: f64) -> f64 {
        let [a, b, c, d] = self.points.map(DVec4::truncate);
        let legs = [b - a, c - b, d - c].into_iter().filter(|leg| leg.length() > nothing);
        let mut last = None;
        legs.map(|leg| last.replace(leg).map_or(0.0, |last| angle(last, leg))).sum()
    }

    fn length(&self) -> f64 {
        let [a, b, c, d] = self.points.map(DVec4::truncate);
        (b - a).length() + (c - b).length() + (d - c).length()
    }

    fn radius(&self) -> f64 {
        self.points.iter().map(|point| point.w).fold(0.0, f64::max)
    }

    fn station(&self, end: usize, way: Way) -> Station {
        let point = self.points[3 * end];
        let (center, radius) = (point.truncate(), point.w);
        Station { center, radius, tangent: way.tangent, slope: way.slope, piece: self.piece, share: self.shares[end] }
    }
}

/// The angle between two ways of any length, in radians.
fn angle(a: DVec3, b: DVec3) -> f64 {
    math::atan2(a.cross(b).length(), a.dot(b))
}

struct Walk<V> {
    tolerance: f64,
    /// No length, but errors of rounding.
    nothing: f64,
    most_halves: u32,
    /// What is not visited yet.
    last: Option<Station>,
    visit: V,
}

impl<E, V: FnMut(Station) -> Result<(), E>> Walk<V> {
    fn part(&mut self, part: &Part) -> Result<(), E> {
        let Some([first, last]) = part.ways(self.nothing) else { return Ok(()) };
        if part.halved < self.most_halves && !self.is_fine(part) {
            let [one, other] = part.halves();
            self.part(&one)?;
            return self.part(&other);
        }
        let start = part.station(0, first);
        let start = match self.last.take() {
            Some(last) => self.joined(last, start)?,
            None => start,
        };
        let end = part.station(1, last);
        self.turn(start, end)?;
        self.last = Some(end);
        Ok(())
    }

    fn is_fine(&self, part: &Part) -> bool {
        let bend = part.bend();
        if bend > self.tolerance {
            return false;
        }
        // Where it is shorter than anybody sees it may turn as it likes.
        if part.length() <= 0.25 * self.tolerance {
            return true;
        }
        let turn = part.turn(self.nothing);
        turn <= MOST_TURN && bend + part.radius() * (1.0 - math::cos(0.5 * turn)) <= self.tolerance
    }

    /// How much a strand of a radius may turn from a station to the next.
    fn most_turn(&self, radius: f64) -> f64 {
        if self.tolerance >= radius {
            return MOST_TURN;
        }
        (2.0 * math::acos(1.0 - self.tolerance / radius)).clamp(LEAST_TURN, MOST_TURN)
    }

    /// One station of two at the same place that lead nearly the same way; else the second, before which the first is visited.
    fn joined(&mut self, last: Station, next: Station) -> Result<Station, E> {
        let is_there = last.center == next.center && last.radius == next.radius;
        if is_there && angle(last.tangent, next.tangent) <= self.most_turn(next.radius) {
            let tangent = (last.tangent + next.tangent).normalize();
            return Ok(Station { tangent, slope: 0.5 * (last.slope + next.slope), ..next });
        }
        self.turn(last, next)?;
        Ok(next)
    }

    /// Visits a station, and as many others on the way to the next as it turns by.
    fn turn(&mut self, from: Station, to: Station) -> Result<(), E> {
        (self.visit)(from)?;
        let angle = angle(from.tangent, to.tangent);
        let most = self.most_turn(from.radius.max(to.radius));
        // An error of rounding is no reason for another one.
        let steps = (angle / most - 1e-6).ceil().max(1.0);
        let mut step = 1.0;
        while step < steps {
            (self.visit)(between(&from, &to, step / steps))?;
            step += 1.0;
        }
        Ok(())
    }
}

/// At a share of the way from one station to another.
fn between(from: &Station, to: &Station, share: f64) -> Station {
    // What turns back may do so any way.
    let axis = from.tangent.cross(to.tangent).try_normalize();
    let axis = axis.unwrap_or_else(|| from.tangent.any_orthonormal_vector());
    let (sine, cosine) = math::sin_cos(share * angle(from.tangent, to.tangent));
    let lerp = |a: f64, b: f64| a + (b - a) * share;
    let own = if from.piece == to.piece { lerp(from.share, to.share) } else { to.share };
    Station {
        center: from.center + (to.center - from.center) * share,
        radius: lerp(from.radius, to.radius),
        tangent: (from.tangent * cosine + axis.cross(from.tangent) * sine).normalize(),
        slope: lerp(from.slope, to.slope),
        piece: to.piece,
        share: own,
    }
}
