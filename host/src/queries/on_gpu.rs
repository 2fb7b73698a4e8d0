//! Rays that a GPU follows.

use std::ops::Range;

use super::Heard;
use super::sink::{Parts, Sink, divided};
use crate::batch::Rays;
use crate::error::Error;
use crate::gpu::{Caster, Chunk};
use crate::stream::Question;

/// Answers all rays, told of by the threads that it is called in: each tells of some rays of a chunk.
pub(super) fn on_gpu<T, E: From<Error> + Send>(
    (caster, question): (&Caster, Question),
    (count, rays): (usize, &impl Rays),
    tell: impl Fn(&Chunk<'_>, Range<usize>) -> Vec<T> + Sync,
    sink: impl Sink<T>,
    heard: &mut Heard<'_, E>,
) -> Result<(), E> {
    let mut parts = Parts::of(sink);
    caster.ask(question, (count, rays), &mut |chunk| {
        let rays = chunk.rays.len();
        divided(0..rays, parts.next(rays), &|rays, sink| sink.take(&tell(&chunk, rays)));
        heard(chunk.rays.end)
    })
}
