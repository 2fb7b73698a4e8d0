//! A ray as it lies in memory.

use crate::buffer::{read, write};
use crate::ray::Ray;
use crate::real::{Scalar, V3};

/// Where a ray starts, where it goes and how far.
#[derive(Clone, Copy)]
pub struct Segment<R> {
    /// Where it starts, in the normalised scene.
    pub origin: V3<R>,
    /// Where it goes, of any length but zero.
    pub direction: V3<R>,
    /// Nothing beyond this many lengths of the direction counts.
    pub limit: R,
    /// The primitive that it starts on, or [`Hit::NOTHING`](crate::ray::Hit::NOTHING).
    pub source_primitive: u32,
}

/// A limit that no box lies before: a lane or a slot without a ray.
pub const NOWHERE: f32 = -1.0;

impl<R: Scalar> Segment<R> {
    /// Ray `index` of a stream of `count`: two records, all first ones before all second ones, so that
    /// neighbouring lanes load neighbours; the second's integer is the bits of the limit.
    #[inline(always)]
    pub fn load(count: u32, index: u32, stream: &[R::Record]) -> Self {
        let (origin, source_primitive) = R::load(read(stream, index));
        let (direction, limit) = R::load(read(stream, count + index));
        Segment { origin, direction, limit: R::splat(f32::from_bits(limit)), source_primitive }
    }

    /// Keeps it where [`Segment::load`] finds it; the limit in single precision.
    #[inline(always)]
    pub fn store(&self, count: u32, index: u32, stream: &mut [R::Record]) {
        write(stream, index, R::store(self.origin, self.source_primitive));
        write(stream, count + index, R::store(self.direction, self.limit.to_f32().to_bits()));
    }

    /// The ray, ready for boxes and primitives.
    #[inline(always)]
    pub fn ray(&self) -> Ray<R> {
        Ray::leaving(self.source_primitive, self.origin, self.direction)
    }
}
