//! Values that follow from constants.

use rustc_hash::FxHashMap;

use rspirv::dr::{Function, Instruction};
use rspirv::spirv::{Op, Word};

use super::composite::{Composites, Globals};
use super::constants::Constants;
use super::evaluate::{Known, evaluate};

/// Replaces what is known by constants and by what it is the same as; tells whether there was anything.
pub fn fold(function: &mut Function, constants: &mut Constants, globals: &Globals<'_>) -> bool {
    let composites = Composites::of(function, globals);
    let mut known = Replacements::default();
    for inst in function.blocks.iter().flat_map(|block| &block.instructions) {
        if let Some((id, with)) = replacement(inst, constants, &composites, &known) {
            known.0.insert(id, with);
        }
    }
    known.apply(function);
    !known.0.is_empty()
}

/// An instruction's result, and what may stand for it.
fn replacement(
    inst: &Instruction,
    constants: &mut Constants,
    composites: &Composites<'_>,
    known: &Replacements,
) -> Option<(Word, Word)> {
    let (id, kind) = (inst.result_id?, inst.result_type?);
    if inst.class.opcode == Op::CompositeExtract {
        return composites.part(inst).map(|part| (id, known.of(part)));
    }
    match evaluate(inst, |id| constants.value(known.of(id)))? {
        Known::Value(value) => constants.folds(kind).then(|| (id, constants.id(kind, value))),
        // What stands for itself only goes round a loop that is never entered.
        Known::Same(other) => Some((id, known.of(other))).filter(|(id, other)| id != other),
    }
}

/// By the id that goes, the id that stands for it.
#[derive(Default)]
struct Replacements(FxHashMap<Word, Word>);

impl Replacements {
    fn of(&self, mut id: Word) -> Word {
        while let Some(&next) = self.0.get(&id) {
            id = next;
        }
        id
    }

    fn apply(&self, function: &mut Function) {
        if self.0.is_empty() {
            return;
        }
        for block in &mut function.blocks {
            block.instructions.retain(|inst| inst.result_id.is_none_or(|id| !self.0.contains_key(&id)));
            let operands = block.instructions.iter_mut().flat_map(|inst| &mut inst.operands);
            for id in operands.filter_map(|operand| operand.id_ref_any_mut()) {
                *id = self.of(*id);
            }
        }
    }
}
