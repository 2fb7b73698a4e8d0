//! Ids: dense, in order of appearance, so that removed debug information leaves no trace.

use rustc_hash::FxHashMap;

use rspirv::dr::{Instruction, Module};
use rspirv::spirv::Word;

/// Renumbers every id and sets the module's bound.
pub fn compact(module: &mut Module) {
    let mut numbers = Numbers(FxHashMap::default());
    for inst in module.all_inst_iter_mut() {
        numbers.renumber(inst);
    }
    if let Some(header) = &mut module.header {
        header.bound = numbers.bound();
    }
}

struct Numbers(FxHashMap<Word, Word>);

impl Numbers {
    fn bound(&self) -> Word {
        self.0.len() as Word + 1
    }

    fn renumber(&mut self, inst: &mut Instruction) {
        let operands = inst.operands.iter_mut().filter_map(|operand| operand.id_ref_any_mut());
        for id in inst.result_type.iter_mut().chain(inst.result_id.iter_mut()).chain(operands) {
            let next = self.bound();
            *id = *self.0.entry(*id).or_insert(next);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Kernel;
    use rspirv::binary::Assemble;

    #[test]
    fn is_dense_and_idempotent() {
        let mut kernel = Kernel::new();
        for _ in 0..100 {
            kernel.unused_id();
        }
        kernel.entry("exact_a", |b| {
            let x = b.load_input();
            b.store_output(x);
        });
        let mut module = kernel.module();
        compact(&mut module);
        let first = module.assemble();
        let bound = module.header.as_ref().unwrap().bound;
        let ids = module.all_inst_iter().filter(|i| i.result_id.is_some());
        assert_eq!(ids.count() as Word + 1, bound);
        compact(&mut module);
        assert_eq!(module.assemble(), first);
    }
}
