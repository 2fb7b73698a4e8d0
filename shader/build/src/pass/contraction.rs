//! `NoContraction`: a device must round each arithmetic result, not fuse two operations.

use std::collections::HashSet;

use eyerays_passes::reach;
use rspirv::dr::{Instruction, Module, Operand};
use rspirv::spirv::{Decoration, Op, Word};

use super::inlining;
use crate::table::Policy;

/// Decorates float arithmetic: all of it in an exact module, in a fast one that of protected
/// functions and of those they call.
pub fn forbid(module: &mut Module, policy: Policy) {
    let functions = match policy {
        Policy::Exact => module.functions.iter().filter_map(|f| f.def_id()).collect(),
        Policy::Fast => protected(module),
    };
    let decorations: Vec<Instruction> = module
        .functions
        .iter()
        .filter(|function| function.def_id().is_some_and(|id| functions.contains(&id)))
        .flat_map(|function| function.all_inst_iter())
        .filter(|inst| is_arithmetic(inst.class.opcode))
        .filter_map(|inst| inst.result_id)
        .map(no_contraction)
        .filter(|decoration| !module.annotations.contains(decoration))
        .collect();
    module.annotations.extend(decorations);
}

fn protected(module: &Module) -> HashSet<Word> {
    let marked = module
        .functions
        .iter()
        .filter(|function| inlining::is_protected(function))
        .filter_map(|function| function.def_id());
    reach::functions(module, marked).into_iter().collect()
}

fn no_contraction(id: Word) -> Instruction {
    let operands = vec![Operand::IdRef(id), Operand::Decoration(Decoration::NoContraction)];
    Instruction::new(Op::Decorate, None, None, operands)
}

/// Does an instruction round a float result? A negation does not, and a device that may not make it part of the
/// instruction that follows is up to 5 % slower (an NVIDIA H200).
pub fn is_arithmetic(op: Op) -> bool {
    matches!(
        op,
        Op::FAdd
            | Op::FSub
            | Op::FMul
            | Op::FDiv
            | Op::FRem
            | Op::FMod
            | Op::VectorTimesScalar
            | Op::MatrixTimesScalar
            | Op::VectorTimesMatrix
            | Op::MatrixTimesVector
            | Op::MatrixTimesMatrix
            | Op::OuterProduct
            | Op::Dot
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use eyerays_passes::testing::Kernel;

    fn decorated(policy: Policy) -> usize {
        let mut kernel = Kernel::new();
        let protected = kernel.protected(|b| {
            let x = b.load_input();
            b.f_mul(x, x);
        });
        kernel.entry("fast_a", |b| {
            let x = b.load_input();
            let y = b.f_add(x, x);
            let z = b.f_negate(y);
            b.store_output(z);
            b.call(protected);
        });
        let mut module = kernel.module();
        forbid(&mut module, policy);
        forbid(&mut module, policy);
        let is_decoration =
            |inst: &&Instruction| inst.operands.get(1) == Some(&Operand::Decoration(Decoration::NoContraction));
        module.annotations.iter().filter(is_decoration).count()
    }

    /// All that rounds: not the negation.
    #[test]
    fn exact_decorates_all() {
        assert_eq!(decorated(Policy::Exact), 2);
    }

    #[test]
    fn fast_decorates_protected() {
        assert_eq!(decorated(Policy::Fast), 1);
    }
}
