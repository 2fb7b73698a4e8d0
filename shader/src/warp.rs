//! The vote across lanes that share a stack.
//!
//! On the GPU the lanes of a packet are a subgroup, each with its own `f32`; on the CPU they are the
//! lanes of one value. Votes are the only place where lanes hear of each other.

use crate::real::Mask;

/// Lanes that decide together.
pub trait Warp {
    /// Does it hold in any lane?
    fn any<M: Mask>(mask: M) -> bool;
}

/// A ray by itself, or the lanes of one value.
pub struct Alone;

impl Warp for Alone {
    #[inline(always)]
    fn any<M: Mask>(mask: M) -> bool {
        mask.any()
    }
}

/// The lanes of a subgroup, as many as the device has.
#[cfg(target_arch = "spirv")]
pub struct Subgroup;

#[cfg(target_arch = "spirv")]
impl Warp for Subgroup {
    #[inline(always)]
    fn any<M: Mask>(mask: M) -> bool {
        spirv_std::arch::subgroup_any(mask.any())
    }
}
