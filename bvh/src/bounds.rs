//! Axis-aligned boxes, made by exact operations only, so that containment is exact.

use eyerays_shader::data::{Bounds as Record, NodeRef, Primitive, numbers, pack};
use glam::{Vec3, Vec3A};

/// A closed box; the least and greatest corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds {
    pub min: Vec3A,
    pub max: Vec3A,
}

impl Bounds {
    /// The neutral element of [`Bounds::union`].
    pub const EMPTY: Bounds = Bounds { min: Vec3A::INFINITY, max: Vec3A::NEG_INFINITY };

    /// A primitive's own box, padding included.
    pub fn of(primitive: &Primitive) -> Self {
        let (min, max) = primitive.bounds();
        Bounds::new(min, max)
    }

    /// The box of a record.
    pub fn read(record: &Record) -> Self {
        Bounds::new(numbers(record.least), numbers(record.greatest))
    }

    /// The box's record.
    pub fn write(self) -> Record {
        Record { least: pack(self.min.into(), 0), greatest: pack(self.max.into(), 0) }
    }

    /// The box between two corners.
    pub fn new(min: impl Into<Vec3A>, max: impl Into<Vec3A>) -> Self {
        Bounds { min: min.into(), max: max.into() }
    }

    /// The box of one point.
    pub fn point(point: Vec3A) -> Self {
        Bounds { min: point, max: point }
    }

    /// The least box around both, by compare and select: no coordinate is ever rounded.
    pub fn union(self, other: Self) -> Self {
        Bounds { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The intersection, which may be empty ([`Bounds::is_empty`]).
    pub fn intersection(self, other: Self) -> Self {
        Bounds { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// Is there no point inside?
    pub fn is_empty(self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    /// The least box around all.
    pub fn around(boxes: impl IntoIterator<Item = Bounds>) -> Self {
        boxes.into_iter().fold(Bounds::EMPTY, Bounds::union)
    }

    /// Does every point of `other` lie inside? False if a coordinate is NaN.
    pub fn contains(self, other: Self) -> bool {
        (self.min.cmple(other.min) & self.max.cmpge(other.max)).all()
    }

    /// Is it a box, and inside another one?
    pub fn is_part_of(self, whole: Self) -> bool {
        self.min.cmple(self.max).all() && whole.contains(self)
    }

    /// The box with so much more room on every side, but for one rounding of each plane.
    pub fn widened(self, margin: f32) -> Self {
        let [low, high] = [self.min, self.max].map(|corner| corner.as_dvec3());
        Bounds { min: (low - f64::from(margin)).as_vec3a(), max: (high + f64::from(margin)).as_vec3a() }
    }

    /// Twice the centre, which spares a rounding.
    pub fn centre(self) -> Vec3A {
        self.min + self.max
    }

    /// Edge lengths.
    pub fn extent(self) -> Vec3A {
        self.max - self.min
    }

    /// Half the surface area.
    pub fn half_area(self) -> f32 {
        half_area(self.extent())
    }

    /// The box with its reference, as a node pair takes it.
    pub fn child(self, reference: NodeRef) -> (Vec3, Vec3, NodeRef) {
        (self.min.into(), self.max.into(), reference)
    }
}

/// Half the surface area of a box of these edge lengths.
pub(crate) fn half_area(extent: Vec3A) -> f32 {
    let [x, y, z] = extent.to_array();
    x * y + y * z + z * x
}

/// The axis of the greatest extent; the first of equals.
pub(crate) fn longest(extent: Vec3A) -> usize {
    let longer = |a: usize, b: usize| if extent[b] > extent[a] { b } else { a };
    longer(longer(0, 1), 2)
}
