//! What a function reaches.

use rustc_hash::{FxHashMap, FxHashSet};

use rspirv::dr::{Function, Instruction, Module};
use rspirv::spirv::{Op, Word};

/// Every id that an instruction mentions but its own.
pub fn mentioned(inst: &Instruction) -> impl Iterator<Item = Word> {
    inst.result_type.into_iter().chain(inst.operands.iter().filter_map(|operand| operand.id_ref_any()))
}

/// The functions that those in `roots` call, and `roots`.
pub fn functions(module: &Module, roots: impl IntoIterator<Item = Word>) -> FxHashSet<Word> {
    let by_id: FxHashMap<Word, &Function> =
        module.functions.iter().filter_map(|function| Some((function.def_id()?, function))).collect();
    let mut reached = FxHashSet::default();
    let mut open: Vec<Word> = roots.into_iter().collect();
    while let Some(id) = open.pop() {
        if let Some(function) = by_id.get(&id)
            && reached.insert(id)
        {
            open.extend(callees(function));
        }
    }
    reached
}

/// Every id that the functions reached from `root` mention.
pub fn ids(module: &Module, root: Word) -> FxHashSet<Word> {
    let reached = functions(module, [root]);
    module
        .functions
        .iter()
        .filter(|function| function.def_id().is_some_and(|id| reached.contains(&id)))
        .flat_map(|function| function.all_inst_iter())
        .flat_map(mentioned)
        .collect()
}

fn callees(function: &Function) -> impl Iterator<Item = Word> {
    function
        .all_inst_iter()
        .filter(|inst| inst.class.opcode == Op::FunctionCall)
        .map(|inst| inst.operands[0].unwrap_id_ref())
}
