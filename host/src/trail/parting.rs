//! When the rays of a packet go on one by one.

use eyerays_shader::data::Tuning;
use eyerays_shader::real::{Mask, Real};

use crate::method::Method;

/// When a packet parts, and whether it comes together again.
#[derive(Clone, Copy)]
pub(super) enum Parting {
    /// It is one ray, or stays together.
    Never,
    /// At so many waiting nodes.
    Full { most: u32, rejoins: bool },
    /// At a child that fewer than this percentage of its rays meet.
    Few { percent: u32, rejoins: bool },
}

impl Parting {
    /// Of a method with its limits.
    pub fn of(method: Method, tuning: Tuning) -> Parting {
        let (most, percent) = (tuning.stack_max(), tuning.cut());
        match method {
            Method::SequentialStack => Parting::Full { most, rejoins: false },
            Method::InterleavedStack => Parting::Full { most, rejoins: true },
            Method::SequentialCut => Parting::Few { percent, rejoins: false },
            Method::InterleavedCut => Parting::Few { percent, rejoins: true },
            _ => Parting::Never,
        }
    }

    /// Do the rays that meet a child leave their packet?
    pub fn leaves<R: Real>(self, rays: R::Mask) -> bool {
        match self {
            Parting::Few { percent, .. } => 100 * rays.count() < percent * everyone::<R>().count(),
            _ => false,
        }
    }
}

/// All rays of a packet.
pub(super) fn everyone<R: Real>() -> R::Mask {
    R::splat(0.0).le(R::splat(0.0))
}
