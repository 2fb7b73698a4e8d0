//! The vote across lanes that share a stack.
//!
//! On the GPU the lanes of a packet are a subgroup, each with its own `f32`; on the CPU they are the
//! lanes of one value. Only the functions here let lanes hear of each other.

use crate::real::Mask;

/// Lanes that decide together.
pub trait Warp {
    /// Do other rays share a lane's instructions?
    const SHARED: bool;

    /// Does it hold in any lane?
    fn any<M: Mask>(mask: M) -> bool;
    /// In how many lanes does it hold?
    fn count<M: Mask>(mask: M) -> u32;
}

/// A ray by itself, or the lanes of one value.
pub struct Alone;

impl Warp for Alone {
    const SHARED: bool = false;

    #[inline(always)]
    fn any<M: Mask>(mask: M) -> bool {
        mask.any()
    }
    #[inline(always)]
    fn count<M: Mask>(mask: M) -> u32 {
        mask.count()
    }
}

/// The lanes of a subgroup, as many as the device has.
#[cfg(target_arch = "spirv")]
pub struct Subgroup;

#[cfg(target_arch = "spirv")]
impl Warp for Subgroup {
    const SHARED: bool = true;

    #[inline(always)]
    fn any<M: Mask>(mask: M) -> bool {
        spirv_std::arch::subgroup_any(mask.any())
    }
    #[inline(always)]
    fn count<M: Mask>(mask: M) -> u32 {
        let ballot = spirv_std::arch::subgroup_ballot(mask.any());
        bits(ballot)
    }
}

/// Lanes of a ballot. There is an instruction for it, which is no faster (NVIDIA) and which naga does not read.
#[cfg(target_arch = "spirv")]
#[inline(always)]
fn bits(ballot: glam::UVec4) -> u32 {
    ballot.x.count_ones() + ballot.y.count_ones() + ballot.z.count_ones() + ballot.w.count_ones()
}

/// Takes numbers for the lanes of a subgroup that want one from a counter in device memory.
#[cfg(target_arch = "spirv")]
#[inline(always)]
pub fn take(wants: bool, lane: u32, counters: &mut [u32], counter: u32) -> u32 {
    use spirv_std::arch::{atomic_i_add, subgroup_ballot, subgroup_broadcast_first};
    use spirv_std::memory::{Scope, Semantics};
    let wanting = subgroup_ballot(wants);
    let count = bits(wanting);
    // Bits of the lanes below, in the word that a lane lies in and in those before.
    let below = |word: u32, first: u32| {
        let all = if lane >= first + 32 { u32::MAX } else { (1 << (lane & 31)) - 1 };
        if lane < first { 0 } else { (word & all).count_ones() }
    };
    let before = below(wanting.x, 0) + below(wanting.y, 32) + below(wanting.z, 64) + below(wanting.w, 96);
    let mut first = 0;
    if subgroup_broadcast_first(lane) == lane && count > 0 {
        // SAFETY: the host sizes the counters; the addition is atomic.
        first = unsafe {
            use spirv_std::arch::IndexUnchecked;
            let taken = counters.index_unchecked_mut(counter as usize);
            atomic_i_add::<u32, { Scope::QueueFamily as u32 }, { Semantics::NONE.bits() }>(taken, count)
        };
    }
    subgroup_broadcast_first(first) + before
}

/// Positions for the lanes of a subgroup that want one at the end of a list whose length a counter in device memory
/// keeps: one atomic addition for all of them. By scans, which naga reads; it does not read an election.
#[cfg(target_arch = "spirv")]
#[inline(always)]
pub fn append(wants: bool, counters: &mut [u32], counter: u32) -> u32 {
    use spirv_std::arch::{atomic_i_add, subgroup_broadcast_first, subgroup_exclusive_i_add, subgroup_i_add};
    use spirv_std::memory::{Scope, Semantics};
    let own = if wants { 1 } else { 0 };
    let (before, count) = (subgroup_exclusive_i_add(own), subgroup_i_add(own));
    let mut first = 0;
    if subgroup_exclusive_i_add(1) == 0 {
        // SAFETY: the host sizes the counters; the addition is atomic.
        first = unsafe {
            use spirv_std::arch::IndexUnchecked;
            let length = counters.index_unchecked_mut(counter as usize);
            atomic_i_add::<u32, { Scope::QueueFamily as u32 }, { Semantics::NONE.bits() }>(length, count)
        };
    }
    subgroup_broadcast_first(first) + before
}
