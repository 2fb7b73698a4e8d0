//! Single instructions of the device that the compiler has no other way to.

use core::arch::asm;

/// An instruction of GLSL.std.450 by its number.
macro_rules! instruction {
    ($name:ident, $number:literal, $what:literal, $($operand:ident)*) => {
        #[doc = $what]
        #[inline(always)]
        pub fn $name($($operand: f32),*) -> f32 {
            let mut result = 0.0;
            // SAFETY: pure arithmetic on values.
            unsafe {
                asm!(
                    "%glsl = OpExtInstImport \"GLSL.std.450\"",
                    "%float = OpTypeFloat 32",
                    $(concat!("%", stringify!($operand), " = OpLoad _ {", stringify!($operand), "}"),)*
                    concat!("%result = OpExtInst %float %glsl ", $number, $(" %", stringify!($operand)),*),
                    "OpStore {result} %result",
                    $($operand = in(reg) &$operand,)*
                    result = in(reg) &mut result,
                );
            }
            result
        }
    };
}

instruction!(lesser, "37", "FMin: of two zeros it may be either; NaN gives any number.", a b);
instruction!(greater, "40", "FMax, with the same licence.", a b);
instruction!(fused, "50", "Fma: `a * b + c`, rounded once or twice.", a b c);
