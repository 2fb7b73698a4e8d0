//! What waits.

use core::mem::MaybeUninit;

use spirv_std::arch::IndexUnchecked;

/// Room for `N` values, a power of two, that are not there before they are put: to set them all for every ray
/// took a GPU 3 to 30 % of its time. A check of a place would leave the kernel, and a lane that has left breaks votes.
pub struct Stack<T: Copy, const N: usize>([MaybeUninit<T>; N]);

impl<T: Copy, const N: usize> Stack<T, N> {
    /// Nothing waits.
    #[inline(always)]
    #[allow(clippy::new_without_default, reason = "a default says that something is set")]
    pub fn new() -> Self {
        // SAFETY: values that may be uninitialised need no initialisation.
        Stack(unsafe { MaybeUninit::uninit().assume_init() })
    }

    /// Sets what is at a place. Places go round; every valid tree has room.
    #[inline(always)]
    pub fn put(&mut self, place: u32, value: T) {
        // SAFETY: what is masked by N - 1 is less than N.
        unsafe { *self.0.index_unchecked_mut(place as usize & (N - 1)) = MaybeUninit::new(value) };
    }

    /// What is at a place.
    ///
    /// # Safety
    /// It has been put.
    #[inline(always)]
    pub unsafe fn get(&self, place: u32) -> T {
        // SAFETY: as above, and the caller's.
        unsafe { self.0.index_unchecked(place as usize & (N - 1)).assume_init() }
    }
}
