//! Reads and writes of device memory.
//!
//! On the GPU an index is not checked, since a failed check returns silently and a lane that has
//! returned breaks votes: the host proves every bound before it uploads. On the CPU it is checked.

/// Element `i` of a buffer.
#[inline(always)]
pub fn read<T: Copy>(buffer: &[T], i: u32) -> T {
    #[cfg(target_arch = "spirv")]
    // SAFETY: the host validates every index in the buffers and sizes them for every slot.
    unsafe {
        use spirv_std::arch::IndexUnchecked;
        *buffer.index_unchecked(i as usize)
    }
    #[cfg(not(target_arch = "spirv"))]
    buffer[i as usize]
}

/// Sets element `i` of a buffer.
#[inline(always)]
pub fn write<T: Copy>(buffer: &mut [T], i: u32, value: T) {
    #[cfg(target_arch = "spirv")]
    // SAFETY: as in `read`.
    unsafe {
        use spirv_std::arch::IndexUnchecked;
        *buffer.index_unchecked_mut(i as usize) = value;
    }
    #[cfg(not(target_arch = "spirv"))]
    {
        buffer[i as usize] = value;
    }
}
