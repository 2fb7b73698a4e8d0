//! Groups that wait for a traversal of wide nodes, two words each; and, on a CPU, where the ray enters the
//! boxes of each group, so that one that lies beyond a hit found since is passed over.

use crate::data::STACK;
use crate::real::{Octet, Scalar};
use core::marker::PhantomData;
#[cfg(not(target_arch = "spirv"))]
use core::mem::MaybeUninit;

/// See the module. `E` tests the boxes.
#[cfg(target_arch = "spirv")]
pub struct Waiting<S: Scalar, E: Octet<S>> {
    words: [u32; 2 * STACK],
    boxes: PhantomData<(S, E)>,
}

/// See the module. `E` tests the boxes. Nothing of it is set before it is asked for: that would take as long as
/// a node.
#[cfg(not(target_arch = "spirv"))]
pub struct Waiting<S: Scalar, E: Octet<S>> {
    words: [MaybeUninit<[u32; 2]>; STACK],
    entries: [MaybeUninit<E::Kept>; STACK],
    boxes: PhantomData<S>,
}

impl<S: Scalar, E: Octet<S>> Clone for Waiting<S, E> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}

impl<S: Scalar, E: Octet<S>> Copy for Waiting<S, E> {}

#[cfg(target_arch = "spirv")]
impl<S: Scalar, E: Octet<S>> Waiting<S, E> {
    /// None.
    pub const NONE: Self = Waiting { words: [0; 2 * STACK], boxes: PhantomData };

    /// Keeps the words of a group, `depth` others waiting.
    #[inline(always)]
    pub fn put(&mut self, depth: u32, first: u32, waiting: u32) {
        let at = 2 * depth as usize & (2 * STACK - 1);
        self.words[at] = first;
        self.words[at + 1] = waiting;
    }

    /// The words of a group that was put, `depth` others waiting.
    #[inline(always)]
    pub fn get(&self, depth: u32) -> (u32, u32) {
        let at = 2 * depth as usize & (2 * STACK - 1);
        (self.words[at], self.words[at + 1])
    }

    /// Keeps nothing.
    #[inline(always)]
    pub fn enter(&mut self, _depth: u32, _near: E) {}

    /// Does the box lie beyond `limit`? Not as far as is known here.
    #[inline(always)]
    pub fn is_beyond(&self, _depth: u32, _slot: u32, _limit: S) -> bool {
        false
    }
}

#[cfg(not(target_arch = "spirv"))]
impl<S: Scalar, E: Octet<S>> Waiting<S, E> {
    /// None.
    pub const NONE: Self =
        Waiting { words: [MaybeUninit::uninit(); STACK], entries: [MaybeUninit::uninit(); STACK], boxes: PhantomData };

    /// Keeps the words of a group, `depth` others waiting.
    #[inline(always)]
    pub fn put(&mut self, depth: u32, first: u32, waiting: u32) {
        self.words[depth as usize & (STACK - 1)] = MaybeUninit::new([first, waiting]);
    }

    /// The words of a group that was put, `depth` others waiting.
    #[inline(always)]
    pub fn get(&self, depth: u32) -> (u32, u32) {
        // SAFETY: a traversal gets no more than it has put.
        let [first, waiting] = unsafe { self.words[depth as usize & (STACK - 1)].assume_init() };
        (first, waiting)
    }

    /// Keeps where the ray enters the boxes of the group in hand, `depth` others waiting.
    #[inline(always)]
    pub fn enter(&mut self, depth: u32, near: E) {
        self.entries[depth as usize & (STACK - 1)] = MaybeUninit::new(near.keep());
    }

    /// Does a box of the group in hand lie beyond `limit`, as far as is known?
    #[inline(always)]
    pub fn is_beyond(&self, depth: u32, slot: u32, limit: S) -> bool {
        // SAFETY: a traversal asks for groups with siblings alone, which were in hand as their node was opened.
        let entries = unsafe { self.entries[depth as usize & (STACK - 1)].assume_init_ref() };
        limit.lt(E::kept(entries, slot))
    }
}
