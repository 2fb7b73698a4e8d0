//! The stack of nodes still to visit.

use core::mem::MaybeUninit;

use spirv_std::arch::IndexUnchecked;

/// Room for `N` values, a power of two, uninitialised: initialising them all for every ray took 3 to 30 % of a GPU's
/// time. Indices are not checked, since a failed check would end the lane, and a lane that has ended breaks votes.
pub struct Stack<T: Copy, const N: usize>([MaybeUninit<T>; N]);

impl<T: Copy, const N: usize> Stack<T, N> {
    /// An empty stack.
    #[inline(always)]
    #[allow(clippy::new_without_default, reason = "a default value should be initialised")]
    pub fn new() -> Self {
        // SAFETY: an array of `MaybeUninit` needs no initialisation.
        Stack(unsafe { MaybeUninit::uninit().assume_init() })
    }

    /// Sets the value at an index. Indices wrap around, but no valid tree needs more than `N`.
    #[inline(always)]
    pub fn put(&mut self, index: u32, value: T) {
        // SAFETY: an index masked by N - 1 is less than N.
        unsafe { *self.0.index_unchecked_mut(index as usize & (N - 1)) = MaybeUninit::new(value) };
    }

    /// The value at an index.
    ///
    /// # Safety
    /// It has been set with [`Stack::put`].
    #[inline(always)]
    pub unsafe fn get(&self, index: u32) -> T {
        // SAFETY: as above, and the caller's.
        unsafe { self.0.index_unchecked(index as usize & (N - 1)).assume_init() }
    }
}
