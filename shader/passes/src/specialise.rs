//! Specialisation constants made plain ones.

use rspirv::dr::{Instruction, Module, Operand};
use rspirv::spirv::{Decoration, Op, Word};

/// Gives every specialisation constant, of 32 bits each, the value of its `SpecId` in `values`, or else its default, and makes
/// it a constant like any other: wgpu passes none to modules that it does not translate.
pub fn write(module: &mut Module, values: &[(u32, u32)]) {
    let ids: Vec<(Word, u32)> = module.annotations.iter().filter_map(spec_id).collect();
    for constant in &mut module.types_global_values {
        if constant.class.opcode != Op::SpecConstant {
            continue;
        }
        let spec_id = ids.iter().find(|(target, _)| Some(*target) == constant.result_id).map(|&(_, id)| id);
        let value = values.iter().find(|(id, _)| Some(*id) == spec_id).map(|&(_, value)| value);
        let operands = value.map_or_else(|| constant.operands.clone(), |value| vec![Operand::LiteralBit32(value)]);
        *constant = Instruction::new(Op::Constant, constant.result_type, constant.result_id, operands);
    }
    module.annotations.retain(|decoration| spec_id(decoration).is_none());
}

/// The target and the number of a decoration with a `SpecId`.
fn spec_id(decoration: &Instruction) -> Option<(Word, u32)> {
    match decoration.operands[..] {
        [Operand::IdRef(target), Operand::Decoration(Decoration::SpecId), Operand::LiteralBit32(id)] => {
            Some((target, id))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Kernel;

    #[test]
    fn constants_take_their_values_or_keep_their_defaults() {
        let mut kernel = Kernel::new();
        let ids = [(1, 7), (2, 8)].map(|(id, default)| kernel.spec_constant(id, default));
        let mut module = kernel.module();
        write(&mut module, &[(2, 99), (3, 5)]);
        let value = |id| {
            let constant = module.types_global_values.iter().find(|inst| inst.result_id == Some(id)).unwrap();
            (constant.class.opcode, constant.operands[0].unwrap_literal_bit32())
        };
        assert_eq!(ids.map(value), [(Op::Constant, 7), (Op::Constant, 99)]);
        assert!(module.annotations.is_empty());
    }
}
