//! The stages of a launch (thesis chapter 6): trace, shadow, shade, and gather at its end. They exchange records through
//! device memory, one slot a sample of a pixel; a slot follows its ray tree depth first and keeps its own sum, so that
//! the sum has one order however slots are scheduled.
//!
//! The first wave of a launch traces primary rays, one for every slot. Each further wave traces, for
//! the slots that still have one, the next secondary ray.

mod accumulate;
mod gather;
mod generate;
mod path;
mod path_state;
mod persistent;
mod segment;
mod shadow;
#[cfg(not(target_arch = "spirv"))]
mod together;
mod trace;

pub use accumulate::{FILM_RECORDS, accumulate, brightness};
pub use gather::{counted, gather};
pub use generate::generate;
pub use path::{Path, RECORDS};
pub use path_state::{PathState, SHADOW_RECORDS, STATE_RECORDS, ShadowRay};
pub use persistent::persistent;
pub use segment::Segment;
pub use shadow::{FACES_AWAY, REACHED, SHADOWED, ShadowInputs, shadow, shadow_ray, visibility};
#[cfg(not(target_arch = "spirv"))]
pub use together::{most, shadow_together, trace_together};
pub use trace::{found, ray, trace, traced};

/// In the integer of a sum or a film record: some contribution was not finite (infinite or NaN) and was left out.
pub const NON_FINITE: u32 = 1 << 31;
