//! A photon where it has come to.

use super::RECORDS;
use crate::buffer::{read, write};
use crate::real::{FAINT, Real, Scalar, V3};
use glam::UVec4;

/// A photon on a surface, in single precision whatever paths have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landed {
    /// Where, in the normalised scene.
    pub place: V3<f32>,
    /// The unit direction that it came from.
    pub towards: V3<f32>,
    /// Its power: radiance times area and solid angle, of linear RGB or of its sample's wavelengths.
    pub power: V3<f32>,
    /// How often it was mirrored or refracted.
    pub bounces: u32,
}

impl Landed {
    /// One at a place, which came from a direction.
    #[inline(always)]
    pub fn new<R: Scalar>(place: V3<R>, towards: V3<R>, power: V3<R>, bounces: u32) -> Self {
        let power = single(power).map(|c| Real::flush(c, FAINT));
        Landed { place: single(place), towards: single(towards), power, bounces }
    }

    /// None.
    #[inline(always)]
    pub fn none() -> Self {
        Landed { place: V3::zero(), towards: V3::zero(), power: V3::zero(), bounces: 0 }
    }

    /// Keeps it at a slot. It is in no list yet.
    #[inline(always)]
    pub fn store(&self, slot: u32, records: &mut [UVec4]) {
        write(records, RECORDS * slot, f32::store(self.place, 0));
        write(records, RECORDS * slot + 1, f32::store(self.towards, self.bounces));
        write(records, RECORDS * slot + 2, f32::store(self.power, IS_THERE));
    }

    /// Keeps at a slot that there is none.
    #[inline(always)]
    pub fn clear(slot: u32, records: &mut [UVec4]) {
        write(records, RECORDS * slot + 2, UVec4::ZERO);
    }

    /// Is there one at a slot?
    #[inline(always)]
    pub fn is_there(slot: u32, records: &[UVec4]) -> bool {
        read(records, RECORDS * slot + 2).w == IS_THERE
    }

    /// Its place, and one more than the number of the photon that follows it in its list; 0 for none.
    #[inline(always)]
    pub fn place(slot: u32, records: &[UVec4]) -> (V3<f32>, u32) {
        f32::load(read(records, RECORDS * slot))
    }

    /// That of a slot, which is in the place of its list that `place` tells.
    #[inline(always)]
    pub fn load(slot: u32, place: V3<f32>, records: &[UVec4]) -> Self {
        let (towards, bounces) = f32::load(read(records, RECORDS * slot + 1));
        Landed { place, towards, power: f32::load(read(records, RECORDS * slot + 2)).0, bounces }
    }
}

/// In single precision.
#[inline(always)]
pub fn single<R: Scalar>(v: V3<R>) -> V3<f32> {
    V3::new(v.x.to_f32(), v.y.to_f32(), v.z.to_f32())
}

/// The integer of the power of a photon that has landed.
const IS_THERE: u32 = 1;

/// In the precision of a path.
#[inline(always)]
pub fn widened<R: Scalar>(v: V3<f32>) -> V3<R> {
    V3::new(R::splat(v.x), R::splat(v.y), R::splat(v.z))
}
