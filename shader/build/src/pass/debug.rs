//! Debug information: the committed modules hold names, but no source and no path.

use std::collections::HashSet;

use rspirv::dr::Module;
use rspirv::spirv::Op;

/// Removes sources, file names and line numbers, which hold the builder's paths.
pub fn strip_lines(module: &mut Module) {
    let is_line = |op| matches!(op, Op::Line | Op::NoLine);
    module.debug_string_source.clear();
    module.debug_module_processed.clear();
    module.types_global_values.retain(|inst| !is_line(inst.class.opcode));
    for function in &mut module.functions {
        for block in &mut function.blocks {
            block.instructions.retain(|inst| !is_line(inst.class.opcode));
        }
    }
}

/// Removes the names of all but functions and globals, once no message needs them.
pub fn strip_local_names(module: &mut Module) {
    let globals = module.types_global_values.iter();
    let functions = module.functions.iter().filter_map(|f| f.def.as_ref());
    let named: HashSet<_> = globals.chain(functions).filter_map(|inst| inst.result_id).collect();
    module.debug_names.retain(|name| named.contains(&name.operands[0].unwrap_id_ref()));
}

#[cfg(test)]
mod tests {
    use super::*;
    use eyerays_passes::testing::Kernel;

    #[test]
    fn lines_and_local_names_go() {
        let mut kernel = Kernel::new();
        let file = kernel.file("/home/someone/kernel.rs");
        let mut local = 0;
        kernel.entry("exact_a", |b| {
            b.line(file);
            local = b.load_input();
            b.store_output(local);
        });
        kernel.name(local, "x");
        let mut module = kernel.module();
        strip_lines(&mut module);
        strip_local_names(&mut module);
        assert!(module.debug_string_source.is_empty());
        assert!(module.debug_names.is_empty());
        assert!(module.all_inst_iter().all(|inst| inst.class.opcode != Op::Line));
    }
}
