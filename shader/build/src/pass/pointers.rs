//! Pointers: drivers crash on one that lives in a struct, and naga refuses it.

use std::collections::HashMap;

use rspirv::dr::{Instruction, Module};
use rspirv::spirv::{Op, Word};

use super::names::Names;
use crate::{Error, Result};

/// Fails when a struct, an array or a variable holds a pointer, or when a pointer is chosen at run
/// time. Run it after dead code is gone.
pub fn check(module: &Module) -> Result<()> {
    let names = Names::of(module);
    let types: HashMap<Word, &Instruction> =
        module.types_global_values.iter().filter_map(|inst| Some((inst.result_id?, inst))).collect();
    let is_pointer = |id: Word| types.get(&id).is_some_and(|inst| inst.class.opcode == Op::TypePointer);
    for inst in &module.types_global_values {
        let holds =
            matches!(inst.class.opcode, Op::TypeStruct | Op::TypeArray | Op::TypeRuntimeArray | Op::TypePointer);
        let mut members = inst.operands.iter().filter_map(|o| o.id_ref_any());
        if let (true, true, Some(id)) = (holds, members.any(is_pointer), inst.result_id) {
            let (function, name) = (user(module, &types, id), names.get(id));
            let function = function.map_or("the module".into(), |id| names.get(id));
            return Err(Error::Pointer(format!("`{function}` keeps a pointer in `{name}` ({})", inst.class.opname)));
        }
    }
    for function in &module.functions {
        let chosen = function
            .all_inst_iter()
            .find(|inst| matches!(inst.class.opcode, Op::Phi | Op::Select) && inst.result_type.is_some_and(is_pointer));
        if chosen.is_some() {
            let name = names.function(function);
            return Err(Error::Pointer(format!("`{name}` chooses a pointer at run time")));
        }
    }
    Ok(())
}

/// A function that mentions type `id`, or a pointer to it.
fn user(module: &Module, types: &HashMap<Word, &Instruction>, id: Word) -> Option<Word> {
    let uses = |mentioned: Word| {
        let pointee = types.get(&mentioned).and_then(|inst| inst.operands.get(1));
        mentioned == id || pointee.and_then(|operand| operand.id_ref_any()) == Some(id)
    };
    module
        .functions
        .iter()
        .find(|function| {
            let mut types = function.all_inst_iter().filter_map(|inst| inst.result_type);
            types.any(uses)
        })?
        .def_id()
}

#[cfg(test)]
mod tests {
    use super::*;
    use eyerays_passes::dead;
    use eyerays_passes::testing::Kernel;

    #[test]
    fn dead_composites_pass_live_ones_fail() {
        for live in [false, true] {
            let mut kernel = Kernel::new();
            kernel.entry("exact_a", |b| b.pointer_struct(live));
            let mut module = kernel.module();
            assert!(check(&module).is_err());
            dead::remove(&mut module);
            assert_eq!(check(&module).is_err(), live);
        }
    }
}
