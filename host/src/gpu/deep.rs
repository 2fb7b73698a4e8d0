//! Work on threads with deep stacks: compilers of drivers recurse (Mesa's RADV overflows 2 MiB with the kernels of a large scene).

use std::panic::resume_unwind;
use std::thread::{Builder, scope};

/// Bytes of a stack. Only what is used of it takes memory.
const STACK: usize = 64 << 20;

/// What the work makes of each item, all at once, in their order. Where there is no thread to be had, the caller's does it.
pub(super) fn on_deep_stacks<T: Sync, U: Send>(items: &[T], work: impl Fn(&T) -> U + Sync) -> Vec<U> {
    let work = &work;
    scope(|scope| {
        let start = |item| Builder::new().stack_size(STACK).spawn_scoped(scope, move || work(item)).map_err(|_| item);
        let started: Vec<_> = items.iter().map(start).collect();
        let result = |thread| match thread {
            Ok(thread) => std::thread::ScopedJoinHandle::join(thread).unwrap_or_else(|panic| resume_unwind(panic)),
            Err(item) => work(item),
        };
        started.into_iter().map(result).collect()
    })
}

#[cfg(test)]
mod tests {
    use std::hint::black_box;

    use super::*;

    /// Takes at least 4 KiB of stack for each level.
    fn sink(levels: usize) -> usize {
        let frame = black_box([levels as u8; 4096]);
        if levels == 0 { 0 } else { 1 + sink(levels - 1) + usize::from(black_box(frame)[7] == 255 && levels == 0) }
    }

    #[test]
    fn work_may_recurse_over_tens_of_megabytes() {
        assert_eq!(on_deep_stacks(&[3000, 1, 2500], |&levels| sink(levels)), [3000, 1, 2500]);
    }

    #[test]
    #[should_panic(expected = "of the second")]
    fn a_panic_is_the_callers() {
        on_deep_stacks(&[1, 2], |&item| assert!(item == 1, "of the second"));
    }
}
