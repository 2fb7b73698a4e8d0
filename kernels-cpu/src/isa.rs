//! The instruction sets that the kernels are compiled for.

use std::sync::LazyLock;

use eyerays_shader::real::{Native, Scalar, Task};

/// A set of instructions. The kernels are compiled once for each; all give the same bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Isa {
    /// What every processor of the target has.
    Baseline,
    /// Vectors of eight numbers and counting of bits.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// Vectors of sixteen numbers.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Isa {
    /// The ISAs that this processor has, the best last.
    pub fn here() -> Vec<Isa> {
        #[allow(unused_mut)]
        let mut isas = vec![Isa::Baseline];
        #[cfg(target_arch = "x86_64")]
        {
            use std::arch::is_x86_feature_detected as has;
            if has!("avx2") && has!("fma") && has!("bmi1") && has!("bmi2") && has!("lzcnt") && has!("popcnt") {
                isas.push(Isa::Avx2);
                if has!("avx512f") && has!("avx512vl") && has!("avx512bw") && has!("avx512dq") {
                    isas.push(Isa::Avx512);
                }
            }
        }
        isas
    }

    /// The best that this processor has.
    pub fn best() -> Isa {
        static BEST: LazyLock<Isa> = LazyLock::new(|| *Isa::here().last().expect("every processor has one"));
        *BEST
    }

    /// Runs a task over the numbers `R` with the instructions of this ISA, where they have any use for them.
    ///
    /// # Panics
    /// If the processor has not got them.
    #[inline]
    pub fn run<R: Scalar>(self, task: impl Task<R>) {
        match self {
            #[cfg(target_arch = "x86_64")]
            isa if R::VECTORISES && isa != Isa::Baseline => {
                assert!(isa.is_here(), "this processor has no {isa:?}");
                // SAFETY: the processor has the instructions.
                unsafe {
                    match isa {
                        Isa::Avx512 => avx512(task),
                        _ => avx2(task),
                    }
                }
            }
            _ => task.run::<Native>(),
        }
    }

    #[cfg(target_arch = "x86_64")]
    fn is_here(self) -> bool {
        // The ISAs are in order, and a better processor has all below.
        self == Isa::best() || Isa::here().contains(&self)
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn avx2<R: Scalar>(task: impl Task<R>) {
    // SAFETY: this function runs on no processor without its target features.
    unsafe { R::run_avx2(task) }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512bw,avx512dq,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn avx512<R: Scalar>(task: impl Task<R>) {
    // SAFETY: as above.
    unsafe { R::run_avx512(task) }
}
