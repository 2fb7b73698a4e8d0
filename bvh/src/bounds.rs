//! Axis-aligned boxes, made by exact operations only, so that containment is exact.

use eyerays_shader::data::{Bounds as Record, NodeRef, Primitive, numbers, pack};
use glam::Vec3;

/// A closed box; the least and greatest corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds {
    pub min: [f32; 3],
    pub max: [f32; 3],
}

impl Bounds {
    /// The neutral element of [`Bounds::union`].
    pub const EMPTY: Bounds = Bounds { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

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
    pub fn new(min: Vec3, max: Vec3) -> Self {
        Bounds { min: min.into(), max: max.into() }
    }

    /// The least box around both, by compare and select: no coordinate is ever rounded.
    pub fn union(self, other: Self) -> Self {
        Bounds {
            min: zip(self.min, other.min, |a, b| if a < b { a } else { b }),
            max: zip(self.max, other.max, |a, b| if a > b { a } else { b }),
        }
    }

    /// The intersection, which may be empty ([`Bounds::is_empty`]).
    pub fn intersection(self, other: Self) -> Self {
        Bounds {
            min: zip(self.min, other.min, |a, b| if a > b { a } else { b }),
            max: zip(self.max, other.max, |a, b| if a < b { a } else { b }),
        }
    }

    /// Is there no point inside?
    pub fn is_empty(self) -> bool {
        (0..3).any(|i| self.min[i] > self.max[i])
    }

    /// The least box around all.
    pub fn around(boxes: impl IntoIterator<Item = Bounds>) -> Self {
        boxes.into_iter().fold(Bounds::EMPTY, Bounds::union)
    }

    /// Does every point of `other` lie inside? False if a coordinate is NaN.
    pub fn contains(self, other: Self) -> bool {
        (0..3).all(|i| self.min[i] <= other.min[i] && self.max[i] >= other.max[i])
    }

    /// Twice the centre, which spares a rounding.
    pub fn centre(self) -> [f32; 3] {
        zip(self.min, self.max, |a, b| a + b)
    }

    /// Edge lengths.
    pub fn extent(self) -> [f32; 3] {
        zip(self.max, self.min, |a, b| a - b)
    }

    /// Half the surface area.
    pub fn half_area(self) -> f32 {
        let [x, y, z] = self.extent();
        x * y + y * z + z * x
    }

    /// The box with its reference, as a node pair takes it.
    pub fn child(self, reference: NodeRef) -> (Vec3, Vec3, NodeRef) {
        (self.min.into(), self.max.into(), reference)
    }
}

fn zip(a: [f32; 3], b: [f32; 3], f: impl Fn(f32, f32) -> f32) -> [f32; 3] {
    [f(a[0], b[0]), f(a[1], b[1]), f(a[2], b[2])]
}
