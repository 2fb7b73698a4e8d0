//! Dead code: whatever no entry point needs.

use rustc_hash::{FxHashMap, FxHashSet};

use rspirv::dr::{Instruction, Module};
use rspirv::spirv::Word;

use crate::{body, reach};

/// Removes functions, instructions, globals, names and decorations that no entry point needs, and
/// the interface variables that an entry point does not reach.
pub fn remove(module: &mut Module) {
    loop {
        let before = module.all_inst_iter().count();
        functions(module);
        body::remove(module);
        interfaces(module);
        globals(module);
        if module.all_inst_iter().count() == before {
            return;
        }
    }
}

fn functions(module: &mut Module) {
    let roots: Vec<Word> = module.entry_points.iter().map(entry_function).collect();
    let live = reach::functions(module, roots.iter().copied());
    module.functions.retain(|function| function.def_id().is_some_and(|id| live.contains(&id)));
    module.execution_modes.retain(|mode| roots.contains(&mode.operands[0].unwrap_id_ref()));
}

fn interfaces(module: &mut Module) {
    let mut entries = std::mem::take(&mut module.entry_points);
    for entry in &mut entries {
        let used = reach::ids(module, entry_function(entry));
        let mut index = 0;
        entry.operands.retain(|operand| {
            index += 1;
            index <= 3 || operand.id_ref_any().is_none_or(|id| used.contains(&id))
        });
    }
    module.entry_points = entries;
}

fn globals(module: &mut Module) {
    let live = live_globals(module);
    let is_live = |inst: &Instruction| inst.result_id.is_none_or(|id| live.contains(&id));
    module.types_global_values.retain(is_live);
    module.ext_inst_imports.retain(is_live);
    let local: FxHashSet<Word> = module
        .functions
        .iter()
        .flat_map(|function| function.all_inst_iter())
        .filter_map(|inst| inst.result_id)
        .collect();
    let has_target = |inst: &Instruction| {
        let target = inst.operands[0].id_ref_any();
        target.is_some_and(|id| live.contains(&id) || local.contains(&id))
    };
    module.debug_names.retain(has_target);
    module.annotations.retain(has_target);
}

fn live_globals(module: &Module) -> FxHashSet<Word> {
    let definitions: FxHashMap<Word, &Instruction> =
        module.types_global_values.iter().filter_map(|inst| Some((inst.result_id?, inst))).collect();
    let bodies = module.functions.iter().flat_map(|f| f.all_inst_iter());
    let mut open: Vec<Word> =
        module.entry_points.iter().chain(&module.execution_modes).chain(bodies).flat_map(reach::mentioned).collect();
    let mut live = FxHashSet::default();
    while let Some(id) = open.pop() {
        if live.insert(id)
            && let Some(definition) = definitions.get(&id)
        {
            open.extend(reach::mentioned(definition));
        }
    }
    live
}

fn entry_function(entry: &Instruction) -> Word {
    entry.operands[1].unwrap_id_ref()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::select;
    use crate::testing::Kernel;
    use rspirv::spirv::Op;

    #[test]
    fn only_what_an_entry_needs_stays() {
        let mut kernel = Kernel::new();
        let called = kernel.protected(|b| {
            let x = b.load_input();
            b.store_output(x);
        });
        kernel.entry("fast_a", |b| {
            let one = b.constant_u32(1);
            b.store_counter(one);
        });
        kernel.entry("exact_a", |b| b.call(called));
        let mut module = kernel.module();
        select::entries(&mut module, |name| name.starts_with("exact_")).unwrap();
        remove(&mut module);
        assert_eq!(module.functions.len(), 2);
        assert_eq!(module.execution_modes.len(), 1);
        assert_eq!(module.entry_points[0].operands.len(), 3 + 2);
        assert!(module.ext_inst_imports.is_empty());
        let kinds: Vec<Op> = module.types_global_values.iter().map(|inst| inst.class.opcode).collect();
        assert!(!kinds.contains(&Op::Constant) && !kinds.contains(&Op::TypeInt));
    }
}
