//! What the implementations for one lane share.

/// What every [`Real`](crate::real::Real) of one lane has in common: its mask is a `bool`, its indices are `u32`.
#[macro_export]
macro_rules! alone {
    () => {
        type Mask = bool;
        type Index = u32;

        #[inline(always)]
        fn sieve(mask: bool, numbers: [Self; 5], mut test: impl FnMut([f32; 5]) -> bool) -> bool {
            use $crate::real::Scalar;
            let [a, b, c, d, e] = numbers;
            mask && test([a.to_f32(), b.to_f32(), c.to_f32(), d.to_f32(), e.to_f32()])
        }

        #[inline(always)]
        fn select(mask: bool, a: Self, b: Self) -> Self {
            if mask { a } else { b }
        }
        #[inline(always)]
        fn index(i: u32) -> u32 {
            i
        }
        #[inline(always)]
        fn equals(i: u32, other: u32) -> bool {
            i == other
        }
        #[inline(always)]
        fn precedes(i: u32, other: u32) -> bool {
            i < other
        }
        #[inline(always)]
        fn select_index(mask: bool, a: u32, b: u32) -> u32 {
            if mask { a } else { b }
        }
    };
}

/// What every [`Scalar`](crate::real::Scalar) has in common for which there are no registers: packets of one lane, and the given lanes for the
/// boxes and triangles of wide nodes.
#[macro_export]
macro_rules! no_registers {
    ($eight:ty, $four:ty) => {
        #[cfg(not(target_arch = "spirv"))]
        type Eight = $eight;
        #[cfg(not(target_arch = "spirv"))]
        type Four = $four;
        #[cfg(not(target_arch = "spirv"))]
        type Packet = Self;
    };
}
