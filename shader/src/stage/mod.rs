//! The stages of a launch (thesis chapter 6): trace, shadow, shade, and the exposure of the film at its end. They exchange records through
//! device memory, one slot a sample of a pixel; a slot follows its ray tree depth first and keeps its own sum, so that
//! the sum has one order however slots are scheduled.
//!
//! The first wave of a launch traces primary rays, one for every slot. Each further wave traces, for
//! the slots that still have one, the next secondary ray.

mod aov;
mod caught;
mod cross;
mod film;
mod found;
mod generate;
mod nearest;
mod path;
mod path_state;
mod persistent;
mod segment;
mod shadow;
#[cfg(not(target_arch = "spirv"))]
mod together;
mod trace;
mod transmit;

pub use aov::{AOV_WORDS, AovSlot, AovSums, Contribution, FirstSurface, Split, expose_aovs, sum_records};
pub use caught::{CatcherSums, Caught};
pub use cross::cross;
pub use film::{
    BLOCK, FILM_WORDS, FilmWords, LIGHT_FRACTION, LIGHT_MOST, NOISY_FILM_WORDS, PixelSums, Row, SQUARE_FRACTION,
    SQUARE_MOST, Sample, brightness, expose, expose_blocks, film_words,
};
pub use found::Found;
pub use generate::{CameraTables, generate};
pub use nearest::nearest;
pub use path::{Path, RECORDS};
pub use path_state::{LINKED_GROUPS, PathState, ShadowRay, sampled, shadow_records, state_records};
pub use persistent::persistent;
pub use segment::{NOWHERE, Segment};
pub use shadow::{FACES_AWAY, REACHED, SHADOWED, ShadowInputs, shadow, shadow_ray, visibility};
#[cfg(not(target_arch = "spirv"))]
pub use together::{most, shadow_together, trace_together};
pub use trace::{ray, trace, traced};
pub use transmit::{TransmitInputs, transmit};

/// In the integer of a sum or a film record: some contribution was not finite (infinite or NaN) and was left out.
pub const NON_FINITE: u32 = 1 << 31;
/// In the integer of a sum: the camera's ray found nothing, of which a film keeps a count of its own ([`CLEAR`](crate::data::Launch::CLEAR)).
pub const CLEARED: u32 = 1 << 30;
