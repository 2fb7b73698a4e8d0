//! Who takes answers.

use std::ops::Range;

/// What each of many rays has a part of.
pub trait Split: Send + Sized {
    /// The parts of the first `rays` rays, and those of the others.
    fn split_at(self, rays: usize) -> (Self, Self);
}

/// Takes the answers to questions of rays, from several threads at once, each those of some rays.
pub trait Sink<T>: Split {
    /// Takes the answers of all its rays.
    fn take(self, answers: &[T]);
}

impl<T: Send> Split for &mut [T] {
    fn split_at(self, rays: usize) -> (Self, Self) {
        self.split_at_mut(rays)
    }
}

impl<T: Copy + Send> Sink<T> for &mut [T] {
    fn take(self, answers: &[T]) {
        self.copy_from_slice(answers);
    }
}

/// What is taken from the front, part after part.
pub(super) struct Parts<S>(Option<S>);

impl<S: Split> Parts<S> {
    pub fn of(whole: S) -> Self {
        Parts(Some(whole))
    }

    /// That of the next `rays` rays.
    pub fn next(&mut self, rays: usize) -> S {
        let (next, left) = self.0.take().expect("what is left is put back").split_at(rays);
        self.0 = Some(left);
        next
    }
}

/// Rays that a thread asks, or is told of, at once: what lies between stays in a core's cache, and no thread waits long for the last.
const TASK: usize = 1024;

/// Has threads work on some neighbouring rays each, and on the sinks of these.
pub(super) fn divided<S: Split>(rays: Range<usize>, sink: S, work: &(impl Fn(Range<usize>, S) + Sync)) {
    if rays.len() <= TASK {
        return work(rays, sink);
    }
    let half = (rays.len() / 2).next_multiple_of(TASK);
    let (first, second) = sink.split_at(half);
    let (before, after) = (rays.start..rays.start + half, rays.start + half..rays.end);
    rayon::join(|| divided(before, first, work), || divided(after, second, work));
}
