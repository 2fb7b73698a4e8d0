//! The bindings of a kernel's buffers.

use rspirv::dr::{Module, Operand};
use rspirv::spirv::{Decoration, StorageClass, Word};

/// Numbers the bindings of all buffers from 0 on, in their order, and returns what they were. Those that no instruction
/// reaches are gone before.
pub fn close_up(module: &mut Module) -> Vec<u32> {
    let buffers: Vec<Word> = module.types_global_values.iter().filter(is_buffer).filter_map(|i| i.result_id).collect();
    let mut bindings: Vec<u32> = Vec::new();
    each(module, &buffers, |binding| bindings.push(*binding));
    bindings.sort_unstable();
    let place = |old: &u32| bindings.binary_search(old).expect("it was seen");
    each(module, &buffers, |binding| *binding = place(binding) as u32);
    bindings
}

fn is_buffer(inst: &&rspirv::dr::Instruction) -> bool {
    let class = inst.operands.first();
    inst.class.opcode == rspirv::spirv::Op::Variable
        && matches!(class, Some(Operand::StorageClass(StorageClass::StorageBuffer | StorageClass::Uniform)))
}

fn each(module: &mut Module, buffers: &[Word], mut visit: impl FnMut(&mut u32)) {
    for inst in &mut module.annotations {
        if let [Operand::IdRef(id), Operand::Decoration(Decoration::Binding), Operand::LiteralBit32(binding)] =
            &mut inst.operands[..]
            && buffers.contains(id)
        {
            visit(binding);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Kernel;

    #[test]
    fn gaps_are_closed_in_order() {
        let mut kernel = Kernel::new();
        kernel.buffer(StorageClass::StorageBuffer, 0, 9);
        kernel.buffer(StorageClass::Uniform, 0, 2);
        kernel.buffer(StorageClass::StorageBuffer, 0, 5);
        let mut module = kernel.module();
        assert_eq!(close_up(&mut module), [2, 5, 9]);
        assert_eq!(close_up(&mut module), [0, 1, 2]);
    }
}
