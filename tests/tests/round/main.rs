//! Spheres and disks: hits against exact arithmetic and brute force, and rays that leave them.
//!
//! `EYERAYS_BATTERY=full` takes all samples; `--nocapture` prints the counts of docs/numerics.md.

mod disks;
mod draw;
mod leaving;
mod mixed;
mod scenes;
mod spheres;
mod subnormals;
mod tally;

use rayon::prelude::*;

/// Rays that one task draws from a seed of its own.
const PART: usize = 1 << 10;

/// Draws and judges so many rays of a case on all cores, and adds up what was found.
fn tallied<T: Send>(
    case: usize,
    rays: usize,
    none: impl Fn() -> T + Sync + Send,
    judge: impl Fn(&mut fastrand::Rng) -> T + Sync + Send,
    and: impl Fn(T, T) -> T + Sync + Send,
) -> T {
    let part = |part: usize| {
        let mut rng = fastrand::Rng::with_seed((case << 40 | part) as u64);
        (0..PART).map(|_| judge(&mut rng)).fold(none(), &and)
    };
    (0..rays.div_ceil(PART)).into_par_iter().map(part).reduce(&none, &and)
}
