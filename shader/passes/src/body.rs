//! Dead instructions within a function: pure ones whose result nothing needs, and stores to a
//! local variable that is never read.

use rustc_hash::{FxHashMap, FxHashSet};

use rspirv::dr::{Function, Instruction, Module, Operand};
use rspirv::spirv::{GlslStd450Op, MemoryAccess, Op, StorageClass, Word};

use crate::reach;

/// Removes the dead instructions of every function.
pub fn remove(module: &mut Module) {
    let glsl = glsl_set(module);
    for function in &mut module.functions {
        let live = Liveness::of(function, glsl);
        let keep: Vec<Vec<bool>> =
            function.blocks.iter().map(|block| block.instructions.iter().map(|i| live.keeps(i)).collect()).collect();
        for (block, keep) in function.blocks.iter_mut().zip(keep) {
            let mut keep = keep.into_iter();
            block.instructions.retain(|_| keep.next() == Some(true));
        }
    }
}

/// The id of the GLSL.std.450 instructions.
pub fn glsl_set(module: &Module) -> Option<Word> {
    let is_glsl = |inst: &&Instruction| inst.operands[0].unwrap_literal_string() == "GLSL.std.450";
    module.ext_inst_imports.iter().find(is_glsl)?.result_id
}

/// What a function needs.
struct Liveness {
    glsl: Option<Word>,
    /// The local variable that a pointer leads to.
    bases: FxHashMap<Word, Word>,
    live: FxHashSet<Word>,
}

impl Liveness {
    fn of(function: &Function, glsl: Option<Word>) -> Self {
        let mut this = Liveness { glsl, bases: bases(function), live: FxHashSet::default() };
        this.mark(function);
        this
    }

    fn keeps(&self, inst: &Instruction) -> bool {
        if let Some(base) = self.stored(inst) {
            return self.live.contains(&base);
        }
        let is_live = inst.result_id.is_none_or(|id| self.live.contains(&id));
        is_live || !is_pure(inst, self.glsl)
    }

    /// The local variable that a store writes, if it is one.
    fn stored(&self, inst: &Instruction) -> Option<Word> {
        let is_store = inst.class.opcode == Op::Store && !is_volatile(inst);
        is_store.then(|| self.bases.get(&inst.operands[0].unwrap_id_ref()).copied())?
    }

    fn mark(&mut self, function: &Function) {
        let mut definitions: FxHashMap<Word, Vec<&Instruction>> = FxHashMap::default();
        let mut open = Vec::new();
        for inst in function.all_inst_iter() {
            if let Some(base) = self.stored(inst) {
                // A variable that is read needs all that is stored to it.
                definitions.entry(base).or_default().push(inst);
            } else if is_pure(inst, self.glsl) {
                definitions.entry(inst.result_id.unwrap_or_default()).or_default().push(inst);
            } else {
                open.extend(reach::mentioned(inst));
            }
        }
        while let Some(id) = open.pop() {
            if self.live.insert(id) {
                let needed = definitions.get(&id).into_iter().flatten();
                open.extend(needed.flat_map(|inst| reach::mentioned(inst)));
            }
        }
    }
}

fn bases(function: &Function) -> FxHashMap<Word, Word> {
    let mut bases = FxHashMap::default();
    for inst in function.all_inst_iter() {
        let Some(id) = inst.result_id else { continue };
        let base = match inst.class.opcode {
            Op::Variable if inst.operands[0] == StorageClass::Function.into() => Some(id),
            Op::AccessChain | Op::InBoundsAccessChain => bases.get(&inst.operands[0].unwrap_id_ref()).copied(),
            _ => None,
        };
        bases.extend(base.map(|base| (id, base)));
    }
    bases
}

fn is_volatile(inst: &Instruction) -> bool {
    inst.operands
        .iter()
        .any(|operand| matches!(operand, Operand::MemoryAccess(access) if access.contains(MemoryAccess::VOLATILE)))
}

/// Has an instruction no effect but its result?
fn is_pure(inst: &Instruction, glsl: Option<Word>) -> bool {
    let op = inst.class.opcode;
    match op {
        Op::Load => !is_volatile(inst),
        Op::ExtInst => is_pure_extended(inst, glsl),
        Op::Undef
        | Op::Variable
        | Op::AccessChain
        | Op::InBoundsAccessChain
        | Op::ArrayLength
        | Op::CopyLogical
        | Op::Phi => true,
        _ => [
            (Op::VectorExtractDynamic, Op::Transpose),
            (Op::ConvertFToU, Op::Bitcast),
            (Op::SNegate, Op::SMulExtended),
            (Op::Any, Op::FUnordGreaterThanEqual),
            (Op::ShiftRightLogical, Op::BitCount),
        ]
        .iter()
        .any(|&(first, last)| (first as u32..=last as u32).contains(&(op as u32))),
    }
}

fn is_pure_extended(inst: &Instruction, glsl: Option<Word>) -> bool {
    let Operand::LiteralExtInstInteger(number) = inst.operands[1] else {
        return false;
    };
    let writes = matches!(GlslStd450Op::from_u32(number), None | Some(GlslStd450Op::Modf | GlslStd450Op::Frexp));
    inst.operands[0].id_ref_any() == glsl && !writes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Body, Kernel};

    /// The instructions that remain of a body, its return aside.
    fn remaining(body: impl FnOnce(&mut Body)) -> Vec<Op> {
        let mut kernel = Kernel::new();
        kernel.entry("exact_a", body);
        let mut module = kernel.module();
        remove(&mut module);
        let block = &module.functions[0].blocks[0];
        let ops = block.instructions.iter().map(|inst| inst.class.opcode);
        ops.filter(|op| *op != Op::Return).collect()
    }

    #[test]
    fn chains_of_unused_results_go() {
        let ops = remaining(|b| {
            let x = b.load_input();
            let y = b.f_mul(x, x);
            b.glsl(GlslStd450Op::FAbs, y);
        });
        assert_eq!(ops, []);
    }

    #[test]
    fn effects_and_what_they_need_stay() {
        let ops = remaining(|b| {
            let x = b.load_input();
            let y = b.f_mul(x, x);
            b.f_add(y, y);
            b.store_output(y);
            let one = b.constant_u32(1);
            b.atomic_increment(one, one);
        });
        assert_eq!(ops, [Op::Load, Op::FMul, Op::Store, Op::AtomicIAdd]);
    }

    #[test]
    fn variables_that_are_only_written_go() {
        let body = |read| {
            move |b: &mut Body| {
                let x = b.load_input();
                b.local(x, read);
            }
        };
        assert_eq!(remaining(body(false)), []);
        let kept = [Op::Load, Op::Variable, Op::Store, Op::Load, Op::Store];
        assert_eq!(remaining(body(true)), kept);
    }

    #[test]
    fn volatile_loads_stay() {
        let ops = remaining(|b| {
            b.load_counter(MemoryAccess::VOLATILE);
        });
        assert_eq!(ops, [Op::Load]);
    }
}
