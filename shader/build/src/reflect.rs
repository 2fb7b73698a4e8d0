//! What the host must know of a module: entry points, their bindings, constants to specialise.

use std::collections::HashSet;

use eyerays_passes::reach;
use rspirv::dr::{Instruction, Module, Operand};
use rspirv::spirv::{BuiltIn, Decoration, ExecutionMode, Op, StorageClass, Word};

use crate::manifest::{Constant, Entry};
use crate::pass::names::Names;
use crate::{Error, Result};

/// The entry points of a module, in its order.
pub fn entries(module: &Module) -> Result<Vec<Entry>> {
    module.entry_points.iter().map(|e| entry(module, e)).collect()
}

/// The constants that the host may overwrite, by their `SpecId`.
pub fn constants(module: &Module) -> Vec<Constant> {
    let names = Names::of(module);
    let constant = |inst: &Instruction| {
        let id = inst.result_id?;
        let default = match inst.class.opcode {
            Op::SpecConstant => inst.operands[0].unwrap_literal_bit32(),
            Op::SpecConstantTrue => 1,
            Op::SpecConstantFalse => 0,
            _ => return None,
        };
        Some(Constant { id: decoration(module, id, Decoration::SpecId)?, name: names.get(id), default })
    };
    let mut constants: Vec<_> = module.types_global_values.iter().filter_map(constant).collect();
    constants.sort_by_key(|constant| constant.id);
    constants
}

/// The capabilities that a module declares, by name.
pub fn capabilities(module: &Module) -> Vec<String> {
    let name = |inst: &Instruction| format!("{:?}", inst.operands[0].unwrap_capability());
    module.capabilities.iter().map(name).collect()
}

fn entry(module: &Module, inst: &Instruction) -> Result<Entry> {
    let function = inst.operands[1].unwrap_id_ref();
    let mut entry = Entry {
        name: inst.operands[2].unwrap_literal_string().to_owned(),
        workgroup: workgroup(module, function)?,
        subgroup: uses_subgroup(module, function),
        reads: Vec::new(),
        writes: Vec::new(),
        uniforms: Vec::new(),
    };
    let interface: HashSet<Word> = inst.operands[3..].iter().filter_map(|operand| operand.id_ref_any()).collect();
    for variable in &module.types_global_values {
        if let Some(id) = variable.result_id
            && interface.contains(&id)
        {
            bind(module, variable, id, &mut entry)?;
        }
    }
    for bindings in [&mut entry.reads, &mut entry.writes, &mut entry.uniforms] {
        bindings.sort_unstable();
    }
    Ok(entry)
}

fn bind(module: &Module, variable: &Instruction, id: Word, entry: &mut Entry) -> Result<()> {
    let list = match variable.operands[0].unwrap_storage_class() {
        StorageClass::Uniform => &mut entry.uniforms,
        StorageClass::StorageBuffer if is_read_only(module, id) => &mut entry.reads,
        StorageClass::StorageBuffer => &mut entry.writes,
        _ => return Ok(()),
    };
    let set = decoration(module, id, Decoration::DescriptorSet);
    let binding = decoration(module, id, Decoration::Binding);
    match (set, binding) {
        (Some(0), Some(binding)) => list.push(binding),
        _ => {
            let name = &entry.name;
            let problem = format!("`{name}` binds a buffer outside descriptor set 0");
            return Err(Error::Malformed(problem));
        }
    }
    Ok(())
}

fn workgroup(module: &Module, function: Word) -> Result<[u32; 3]> {
    let local_size = Operand::ExecutionMode(ExecutionMode::LocalSize);
    let mode = module
        .execution_modes
        .iter()
        .find(|mode| mode.operands[0] == Operand::IdRef(function) && mode.operands[1] == local_size)
        .ok_or_else(|| Error::Malformed("an entry point without a workgroup size".into()))?;
    Ok([2, 3, 4].map(|index| mode.operands[index].unwrap_literal_bit32()))
}

fn uses_subgroup(module: &Module, function: Word) -> bool {
    let reached = reach::functions(module, [function]);
    let votes = module
        .functions
        .iter()
        .filter(|function| function.def_id().is_some_and(|id| reached.contains(&id)))
        .flat_map(|function| function.all_inst_iter())
        .any(|inst| inst.class.opname.starts_with("GroupNonUniform"));
    let mentioned = reach::ids(module, function);
    votes
        || module.annotations.iter().any(|inst| {
            let subgroup =
                [BuiltIn::SubgroupSize, BuiltIn::SubgroupId, BuiltIn::NumSubgroups, BuiltIn::SubgroupLocalInvocationId];
            let target = inst.operands[0].id_ref_any();
            target.is_some_and(|id| mentioned.contains(&id))
                && matches!(inst.operands.last(), Some(Operand::BuiltIn(b)) if subgroup.contains(b))
        })
}

fn is_read_only(module: &Module, id: Word) -> bool {
    let operands = [Operand::IdRef(id), Operand::Decoration(Decoration::NonWritable)];
    module.annotations.iter().any(|inst| inst.operands == operands)
}

fn decoration(module: &Module, id: Word, kind: Decoration) -> Option<u32> {
    let inst = module
        .annotations
        .iter()
        .find(|inst| inst.operands[0] == Operand::IdRef(id) && inst.operands[1] == Operand::Decoration(kind))?;
    match inst.operands.get(2)? {
        Operand::LiteralBit32(value) => Some(*value),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eyerays_passes::testing::Kernel;

    #[test]
    fn finds_bindings_and_constants() {
        let mut kernel = Kernel::new();
        kernel.buffer(StorageClass::StorageBuffer, 0, 3);
        let read = kernel.buffer(StorageClass::StorageBuffer, 0, 1);
        kernel.decorate(read, Decoration::NonWritable);
        kernel.buffer(StorageClass::Uniform, 0, 2);
        let features = kernel.spec_constant(1, 7);
        kernel.name(features, "features");
        kernel.entry("exact_a", |_| {});
        kernel.entry("exact_b", |b| b.ballot_count());
        let module = kernel.module();
        let constant = Constant { id: 1, name: "features".into(), default: 7 };
        assert_eq!(constants(&module), [constant]);
        let entries = entries(&module).unwrap();
        assert_eq!(entries[0].workgroup, [32, 1, 1]);
        assert_eq!(entries[0].reads, [1]);
        assert_eq!(entries[0].writes, [3]);
        assert_eq!(entries[0].uniforms, [2]);
        assert_eq!([entries[0].subgroup, entries[1].subgroup], [false, true]);
    }

    #[test]
    fn refuses_other_sets() {
        let mut kernel = Kernel::new();
        kernel.buffer(StorageClass::StorageBuffer, 1, 0);
        kernel.entry("exact_a", |_| {});
        assert!(entries(&kernel.module()).is_err());
    }
}
