//! Single instructions of the device that the compiler has no other way to.

use core::arch::asm;

/// The number of FMin in GLSL.std.450, and of FMax.
macro_rules! extreme {
    ($name:ident, $number:literal, $what:literal) => {
        #[doc = $what]
        /// Of two zeros it may be either; NaN gives any number.
        #[inline(always)]
        pub fn $name(a: f32, b: f32) -> f32 {
            let mut result = 0.0;
            // SAFETY: pure arithmetic on two values.
            unsafe {
                asm!(
                    "%glsl = OpExtInstImport \"GLSL.std.450\"",
                    "%float = OpTypeFloat 32",
                    "%a = OpLoad _ {a}",
                    "%b = OpLoad _ {b}",
                    concat!("%result = OpExtInst %float %glsl ", $number, " %a %b"),
                    "OpStore {result} %result",
                    a = in(reg) &a,
                    b = in(reg) &b,
                    result = in(reg) &mut result,
                );
            }
            result
        }
    };
}

extreme!(lesser, "37", "The lesser of two numbers (FMin).");
extreme!(greater, "40", "The greater of two numbers (FMax).");
