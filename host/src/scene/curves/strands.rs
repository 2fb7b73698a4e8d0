//! Strands of control points.

use glam::{DVec4, Vec3, Vec4};

use super::Basis;

/// A point that a curve goes through or near.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ControlPoint {
    /// Where it is.
    pub position: Vec3,
    /// How thick the curve is there, in the same units, at least 0: half its width.
    pub radius: f32,
}

/// Control points of many strands, one after the other.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Strands {
    points: Vec<ControlPoint>,
    ups: Vec<Vec3>,
    colours: Vec<Vec4>,
    /// Behind the last point of each.
    ends: Vec<usize>,
}

/// The control points of one strand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strand<'s> {
    /// From its root to its tip.
    pub points: &'s [ControlPoint],
    /// Where the front of a ribbon faces at each point, zero where that is not said; or empty.
    pub ups: &'s [Vec3],
    /// Linear RGB and opacity at each point, each 0 to 1; or empty.
    pub colours: &'s [Vec4],
}

impl Strands {
    /// Adds a strand.
    pub fn push(&mut self, strand: Strand) {
        let before = self.points.len();
        self.points.extend(strand.points);
        extend(&mut self.ups, strand.ups, (before, self.points.len()), Vec3::ZERO);
        extend(&mut self.colours, strand.colours, (before, self.points.len()), Vec4::ONE);
        self.ends.push(self.points.len());
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Is there none?
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// Have they colours?
    pub fn has_colours(&self) -> bool {
        !self.colours.is_empty()
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = Strand<'_>> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| Strand {
            points: &self.points[start..end],
            ups: self.ups.get(start..end).unwrap_or_default(),
            colours: self.colours.get(start..end).unwrap_or_default(),
        })
    }
}

/// Adds what more points have, and `none` for those that have nothing; nothing as long as none has anything.
fn extend<T: Copy>(all: &mut Vec<T>, more: &[T], (before, after): (usize, usize), none: T) {
    if !all.is_empty() || !more.is_empty() {
        all.resize(before, none);
        all.extend(more);
        all.resize(after, none);
    }
}

impl Strand<'_> {
    /// Why it can't be drawn, in words that follow "the strand", and what to do.
    pub fn fault(&self, basis: Basis) -> Option<String> {
        let count = self.points.len();
        if let Err(wanted) = basis.pieces(count) {
            return Some(format!("has {count} points, and {basis} wants {wanted}; add or remove some"));
        }
        let odd = |point: &ControlPoint| !point.position.is_finite() || !point.radius.is_finite() || point.radius < 0.0;
        if let Some(number) = self.points.iter().position(odd) {
            let ControlPoint { position, radius } = self.points[number];
            let what = match position.is_finite() {
                true => format!("the radius {radius}, which must be a finite number of at least 0"),
                false => format!("the position {position}, which is nowhere"),
            };
            return Some(format!("has at its point number {} {what}; correct it", number + 1));
        }
        if self.points.iter().all(|point| point.radius == 0.0) {
            return Some("has no radius above 0 and is too thin to be seen; give it one".into());
        }
        let is_point = self.points.iter().all(|point| point.position == self.points[0].position);
        is_point.then(|| "has all of its points at one place; move them apart".into())
    }

    /// The greatest radius of its points.
    pub(super) fn greatest_radius(&self) -> f64 {
        f64::from(self.points.iter().map(|point| point.radius).fold(0.0, f32::max))
    }

    /// Places and radii of a Bezier curve of it.
    pub(super) fn piece(&self, basis: Basis, number: usize) -> [DVec4; 4] {
        let point = |at: usize| self.points[at].position.extend(self.points[at].radius).as_dvec4();
        let mut piece = basis.piece(number, self.points.len(), point);
        if basis == Basis::CatmullRom {
            // Beside points of little radius the spline would go below none.
            piece.iter_mut().for_each(|point| point.w = point.w.max(0.0));
        }
        piece
    }
}
