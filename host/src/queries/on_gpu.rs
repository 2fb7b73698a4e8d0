//! Rays that a GPU follows.

use std::ops::Range;

use super::Heard;
use super::sink::{Parts, Sink, divided};
use super::surfaces::Surfaces;
use crate::batch::Rays;
use crate::error::Error;
use crate::gpu::{Caster, Chunk};
use crate::stream::Question;

/// Answers all rays, told of by the surfaces' threads: each tells of some rays of a chunk.
pub(super) fn on_gpu<T, E: From<Error>>(
    surfaces: &Surfaces,
    (caster, question): (&Caster, Question),
    (count, rays): (usize, &impl Rays),
    tell: impl Fn(&Chunk<'_>, Range<usize>) -> Vec<T> + Sync,
    sink: impl Sink<T>,
    heard: &mut Heard<'_, E>,
) -> Result<(), E> {
    let mut parts = Parts::of(sink);
    let mut all = |chunk: Chunk<'_>| {
        let rays = chunk.rays.len();
        divided(0..rays, parts.next(rays), &|rays, sink| sink.take(&tell(&chunk, rays)));
    };
    caster.ask(question, (count, rays), &surfaces.threads, &mut all, heard)
}
