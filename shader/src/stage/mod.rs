//! The stages of a launch (thesis chapter 6): trace, shadow, shade. They exchange records through
//! device memory, one slot a ray; a slot follows its ray tree depth first, so that a pixel's sum has
//! one order however slots are scheduled.
//!
//! The first wave of a launch traces primary rays, one for every slot. Each further wave traces, for
//! the slots that still have one, the next secondary ray.

mod path;
mod persistent;
mod segment;
mod shade;
mod shadow;
#[cfg(not(target_arch = "spirv"))]
mod together;
mod trace;

pub use path::{Path, RECORDS};
pub use persistent::persistent;
pub use segment::Segment;
pub use shade::{Wave, shade};
pub use shadow::{Asking, FACES_AWAY, REACHED, SHADOWED, answered, asked, shadow};
#[cfg(not(target_arch = "spirv"))]
pub use together::{most, shadow_together, trace_together};
pub use trace::{found, trace, traced};

/// In a film record's integer: some contribution to the pixel was no finite number and was left out.
pub const NON_FINITE: u32 = 1 << 31;
