//! Numbers that are a lane by themselves.

/// Byte `i` of two words.
#[inline(always)]
pub fn byte(words: [u32; 2], i: u32) -> u32 {
    let word = if i < 4 { words[0] } else { words[1] };
    (word >> (8 * (i & 3))) & 255
}

/// The places of four children, of all at once (Ylitie et al. 2017, appendix).
#[inline(always)]
pub fn places(children: u32, inverted: u32) -> u32 {
    // Bits 3 and 4 are set from 24 on.
    let is_inner = ((children & (children << 1) & 0x1010_1010) >> 4) * 0xff;
    (children ^ ((inverted * 0x0101_0101) & is_inner)) & 0x1f1f_1f1f
}

/// Implements [`Lanes`](crate::real::Lanes) for a [`Scalar`](crate::real::Scalar): it is one lane of itself.
#[macro_export]
macro_rules! one_lane {
    ($type:ty) => {
        impl $crate::real::Lanes<$type> for $type {
            const COUNT: u32 = 1;

            #[inline(always)]
            fn all(x: $type) -> Self {
                x
            }
            #[inline(always)]
            fn of(number: impl Fn(usize) -> $type) -> Self {
                number(0)
            }
            #[inline(always)]
            fn indices(index: impl Fn(usize) -> u32) -> u32 {
                index(0)
            }
            #[inline(always)]
            fn lane(&self, _: usize) -> $type {
                *self
            }
            #[inline(always)]
            fn index_of(index: u32, _: usize) -> u32 {
                index
            }
            #[inline(always)]
            fn vectors(records: &[glam::UVec4]) -> $crate::real::V3<$type> {
                $crate::real::V3::splat($crate::data::numbers(records[0]))
            }
            #[inline(always)]
            fn bits(mask: bool) -> u32 {
                mask as u32
            }
            #[inline(always)]
            fn every(holds: bool) -> bool {
                holds
            }
        }
    };
}

/// Implements [`Octet`](crate::real::Octet) for such a number: one box at a time.
#[macro_export]
macro_rules! octet_of_one {
    ($type:ty) => {
        impl $crate::real::Octet<$type> for $type {
            #[inline(always)]
            fn bytes(words: [u32; 2], first: u32) -> Self {
                <$type as $crate::real::Real>::splat($crate::real::lane::byte(words, first) as f32)
            }
            type Kept = ();
            #[inline(always)]
            fn keep(self) {}
            #[inline(always)]
            fn kept(_: &(), _: u32) -> $type {
                <$type as $crate::real::Real>::splat(f32::MIN)
            }
            type Children = ([u32; 2], [u32; 2]);
            #[inline(always)]
            fn children(words: [u32; 2], inverted: u32) -> Self::Children {
                use $crate::real::lane::places;
                let bits = [(words[0] >> 5) & 0x0707_0707, (words[1] >> 5) & 0x0707_0707];
                (bits, [places(words[0], inverted), places(words[1], inverted)])
            }
            #[inline(always)]
            fn waiting(met: bool, (bits, places): &Self::Children, first: u32) -> u32 {
                use $crate::real::lane::byte;
                if met { byte(*bits, first) << byte(*places, first) } else { 0 }
            }
        }
    };
}

mod numbers {
    use crate::real::Fast;

    one_lane!(f32);
    one_lane!(Fast);
    #[cfg(not(target_arch = "spirv"))]
    one_lane!(f64);

    #[cfg(target_arch = "spirv")]
    octet_of_one!(f32);
    #[cfg(target_arch = "spirv")]
    octet_of_one!(Fast);
    #[cfg(not(target_arch = "spirv"))]
    octet_of_one!(f64);
}
