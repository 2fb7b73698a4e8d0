//! The Vulkan memory model, which rust-gpu declares, as GLSL450, whose features wgpu enables.

use std::collections::HashMap;

use rspirv::dr::{Instruction, Module, Operand};
use rspirv::spirv::{AddressingModel, Capability, MemoryAccess, MemoryModel, MemorySemantics, Op, Scope, Word};

use crate::{Error, Result};

/// Rewrites the model, the scopes that need it (a queue family becomes the device) and the flags
/// that only it knows. Constants that are used elsewhere keep their value.
pub fn to_glsl450(module: &mut Module) -> Result<()> {
    module.capabilities.retain(|inst| {
        let capability = inst.operands[0].unwrap_capability();
        capability != Capability::VulkanMemoryModel && capability != Capability::VulkanMemoryModelDeviceScope
    });
    module.extensions.retain(|inst| inst.operands[0].unwrap_literal_string() != "SPV_KHR_vulkan_memory_model");
    if let Some(model) = &mut module.memory_model {
        model.operands =
            vec![Operand::AddressingModel(AddressingModel::Logical), Operand::MemoryModel(MemoryModel::GLSL450)];
    }
    replace_constants(module)?;
    for function in &mut module.functions {
        for inst in function.all_inst_iter_mut() {
            strip_access(inst);
        }
    }
    Ok(())
}

/// What a scope or a set of semantics becomes.
fn glsl450(operand: &Operand, value: u32) -> u32 {
    let vulkan_only = MemorySemantics::OUTPUT_MEMORY
        | MemorySemantics::MAKE_AVAILABLE
        | MemorySemantics::MAKE_VISIBLE
        | MemorySemantics::VOLATILE;
    match operand {
        Operand::IdScope(_) if value == Scope::QueueFamily as u32 => Scope::Device as u32,
        Operand::IdMemorySemantics(_) => value & !vulkan_only.bits(),
        _ => value,
    }
}

fn replace_constants(module: &mut Module) -> Result<()> {
    let values: HashMap<Word, (Word, u32)> = module
        .types_global_values
        .iter()
        .filter(|inst| inst.class.opcode == Op::Constant)
        .filter_map(|inst| match inst.operands[0] {
            Operand::LiteralBit32(value) => Some((inst.result_id?, (inst.result_type?, value))),
            _ => None,
        })
        .collect();
    let mut fresh = Fresh { bound: module.header.as_ref().map_or(1, |header| header.bound), constants: Vec::new() };
    let bodies = module.functions.iter_mut();
    for inst in bodies.flat_map(|function| function.all_inst_iter_mut()) {
        for operand in &mut inst.operands {
            let (Operand::IdScope(id) | Operand::IdMemorySemantics(id)) = *operand else {
                continue;
            };
            let (kind, old) =
                *values.get(&id).ok_or_else(|| Error::Malformed("a memory scope that is no constant".into()))?;
            let new = glsl450(operand, old);
            if new != old
                && let Some(id) = operand.id_ref_any_mut()
            {
                *id = fresh.get(kind, new);
            }
        }
    }
    module.types_global_values.extend(fresh.constants);
    if let Some(header) = &mut module.header {
        header.bound = fresh.bound;
    }
    Ok(())
}

/// Constants that no other instruction uses.
struct Fresh {
    bound: Word,
    constants: Vec<Instruction>,
}

impl Fresh {
    fn get(&mut self, kind: Word, value: u32) -> Word {
        let operands = vec![Operand::LiteralBit32(value)];
        let same = |inst: &&Instruction| inst.result_type == Some(kind) && inst.operands == operands;
        if let Some(id) = self.constants.iter().find(same).and_then(|i| i.result_id) {
            return id;
        }
        let id = self.bound;
        self.bound += 1;
        let constant = Instruction::new(Op::Constant, Some(kind), Some(id), operands);
        self.constants.push(constant);
        id
    }
}

/// Drops the Vulkan model's flags from a load, a store or a copy. The operands of the flags that
/// stay precede those of the flags that go.
fn strip_access(inst: &mut Instruction) {
    let vulkan_only =
        MemoryAccess::MAKE_POINTER_AVAILABLE | MemoryAccess::MAKE_POINTER_VISIBLE | MemoryAccess::NON_PRIVATE_POINTER;
    let mut stripped = false;
    for operand in &mut inst.operands {
        if let Operand::MemoryAccess(access) = operand {
            stripped |= access.intersects(vulkan_only);
            access.remove(vulkan_only);
        }
    }
    if stripped {
        inst.operands.retain(|operand| {
            !matches!(operand, Operand::IdScope(_)) && *operand != Operand::MemoryAccess(MemoryAccess::NONE)
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eyerays_passes::testing::Kernel;

    #[test]
    fn rewrites_scopes_only() {
        let mut kernel = Kernel::new();
        kernel.entry("exact_a", |b| {
            let five = b.constant_u32(5);
            let semantics = b.constant_u32(0x2000 | 0x48);
            b.atomic_increment(five, semantics);
            let x = b.load_counter(MemoryAccess::NON_PRIVATE_POINTER);
            let sum = b.i_add(x, five);
            b.store_counter(sum);
        });
        let mut module = kernel.module();
        to_glsl450(&mut module).unwrap();
        let value = |id: Word| {
            let mut globals = module.types_global_values.iter();
            let constant = globals.find(|inst| inst.result_id == Some(id)).unwrap();
            constant.operands[0].unwrap_literal_bit32()
        };
        for inst in module.functions[0].all_inst_iter() {
            match inst.class.opcode {
                Op::AtomicIAdd => {
                    assert_eq!(value(inst.operands[1].unwrap_id_scope()), 1);
                    assert_eq!(value(inst.operands[2].unwrap_id_memory_semantics()), 0x48);
                }
                Op::IAdd => assert_eq!(value(inst.operands[1].unwrap_id_ref()), 5),
                Op::Load => assert_eq!(inst.operands.len(), 1),
                _ => {}
            }
        }
        let model = module.memory_model.unwrap();
        assert_eq!(model.operands[1], MemoryModel::GLSL450.into());
    }
}
