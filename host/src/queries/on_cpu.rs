//! Rays that a CPU follows, in the order in which it does that fastest.

use std::ops::Range;

use rayon::prelude::*;

use super::order::Order;
use super::sink::{Parts, Sink, divided};
use super::sorted::{Ordered, Places, by_direction};
use super::surfaces::Surfaces;
use super::{Heard, MOST_RAYS};
use crate::batch::Rays;
use crate::cpu::Follower;
use crate::method::Method;

/// How some rays of a block are answered.
pub(super) trait Ask<T, R>: Fn(&Follower, &Ordered<'_, R>, Range<usize>, &mut [T]) + Sync {}

impl<T, R, F: Fn(&Follower, &Ordered<'_, R>, Range<usize>, &mut [T]) + Sync> Ask<T, R> for F {}

/// Answers all rays by the surfaces' threads; `nothing` is the answer of a ray that is not asked yet.
pub(super) fn on_cpu<T: Copy + Send + Sync, R: Rays, E>(
    surfaces: &Surfaces,
    (count, rays): (usize, &R),
    (nothing, ask): (T, impl Ask<T, R>),
    sink: impl Sink<T>,
    heard: &mut Heard<'_, E>,
) -> Result<(), E> {
    let (mut parts, mut room) = (Parts::of(sink), Vec::new());
    for start in (0..count).step_by(MOST_RAYS) {
        let block = start..count.min(start + MOST_RAYS);
        let sink = parts.next(block.len());
        let job = &surfaces.job;
        let scene = (job.primitives().len(), job.normalisation().scale);
        surfaces.threads.install(|| match Order::of(rays, block.clone(), scene) {
            Order::Neighbours => in_turn(surfaces, Method::Packet, (rays, &block), (nothing, &ask), sink),
            Order::None => in_turn(surfaces, Method::Wide, (rays, &block), (nothing, &ask), sink),
            Order::Sorted(most) => sorted(surfaces, (most, &mut room), (rays, &block), (nothing, &ask), sink),
        });
        heard(block.end)?;
    }
    Ok(())
}

fn in_turn<T: Copy + Send + Sync, R: Rays>(
    surfaces: &Surfaces,
    method: Method,
    (rays, block): (&R, &Range<usize>),
    (nothing, ask): (T, &impl Ask<T, R>),
    sink: impl Sink<T>,
) {
    let (follower, rays) = (Follower::new(&surfaces.job, method), Ordered::in_turn(rays, block.start));
    divided(0..block.len(), sink, &|range, sink| {
        let mut answers = vec![nothing; range.len()];
        ask(&follower, &rays, range, &mut answers);
        sink.take(&answers);
    });
}

/// Asks rays by their directions, `most` at once. Their answers wait in a room that is kept from one block to the next, since to take memory
/// takes as long as to ask.
fn sorted<T: Copy + Send + Sync, R: Rays>(
    surfaces: &Surfaces,
    (most, room): (usize, &mut Vec<T>),
    (rays, block): (&R, &Range<usize>),
    (nothing, ask): (T, &impl Ask<T, R>),
    sink: impl Sink<T>,
) {
    let (follower, mut parts) = (Follower::new(&surfaces.job, Method::Packet), Parts::of(sink));
    let missing = most.min(block.len()).saturating_sub(room.len());
    room.par_extend(rayon::iter::repeat_n(nothing, missing));
    for start in block.clone().step_by(most) {
        let part = start..block.end.min(start + most);
        let (order, answers) = (by_direction(rays, part.clone()), &mut room[..part.len()]);
        let (rays, places) = (Ordered::by(rays, start, &order), Places::of(&order));
        divided(0..part.len(), &mut *answers, &|range, answers| ask(&follower, &rays, range, answers));
        divided(0..part.len(), parts.next(part.len()), &|range, sink| {
            let own: Vec<T> = places.part(range).map(|place| answers[place]).collect();
            sink.take(&own);
        });
    }
}
