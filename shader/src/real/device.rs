//! Single instructions of the device that the compiler can't emit otherwise.

use core::arch::asm;

/// An instruction of GLSL.std.450 by its number.
macro_rules! instruction {
    ($name:ident, $number:literal, $type:ty, $id:literal, $spirv:literal, $what:literal, $($operand:ident)*) => {
        #[doc = $what]
        #[inline(always)]
        pub fn $name($($operand: $type),*) -> $type {
            let mut result = <$type>::default();
            // SAFETY: pure arithmetic on values.
            unsafe {
                asm!(
                    "%glsl = OpExtInstImport \"GLSL.std.450\"",
                    concat!($id, " = ", $spirv),
                    $(concat!("%", stringify!($operand), " = OpLoad _ {", stringify!($operand), "}"),)*
                    concat!("%result = OpExtInst ", $id, " %glsl ", $number, $(" %", stringify!($operand)),*),
                    "OpStore {result} %result",
                    $($operand = in(reg) &$operand,)*
                    result = in(reg) &mut result,
                );
            }
            result
        }
    };
}

macro_rules! of_floats {
    ($name:ident, $number:literal, $what:literal, $($operand:ident)*) => {
        instruction!($name, $number, f32, "%float", "OpTypeFloat 32", $what, $($operand)*);
    };
}
macro_rules! of_integers {
    ($name:ident, $number:literal, $what:literal) => {
        instruction!($name, $number, i32, "%int", "OpTypeInt 32 1", $what, a b);
    };
}

of_floats!(magnitude, "4", "FAbs: no instruction at all where operands have a sign of their own.", x);
of_floats!(lesser, "37", "FMin: of two zeros it may be either; NaN gives any number.", a b);
of_floats!(greater, "40", "FMax, with the same licence.", a b);
of_floats!(inverse_root, "32", "InverseSqrt: within 2 units in the last place.", x);
of_floats!(fused, "50", "Fma: `a * b + c`, rounded once or twice.", a b c);
of_integers!(lesser_integer, "39", "SMin.");
of_integers!(greater_integer, "42", "SMax.");

/// The greatest, if it is not negative; else some negative number.
///
/// As integers: the bits of numbers that are not negative have the same order, and those of negative ones
/// are less. A GPU may have an instruction for three of them (NVIDIA from Hopper on: 5 to 10 % of a traversal).
#[inline(always)]
pub fn greatest(a: f32, b: f32, c: f32, d: f32) -> f32 {
    let [a, b, c, d] = [a.to_bits() as i32, b.to_bits() as i32, c.to_bits() as i32, d.to_bits() as i32];
    f32::from_bits(greater_integer(greater_integer(greater_integer(a, b), c), d) as u32)
}

/// The least, if none is negative; else some negative number, or -0 if that is among them.
#[inline(always)]
pub fn least(a: f32, b: f32, c: f32, d: f32) -> f32 {
    let [a, b, c, d] = [a.to_bits() as i32, b.to_bits() as i32, c.to_bits() as i32, d.to_bits() as i32];
    f32::from_bits(lesser_integer(lesser_integer(lesser_integer(a, b), c), d) as u32)
}
