//! The blocks of a function and the ways between them.

use std::collections::BTreeSet;

use rustc_hash::{FxHashMap, FxHashSet};

use rspirv::dr::{Block, Function, Instruction, Operand};
use rspirv::spirv::{Op, Word};

use super::constants::Constants;

/// The blocks that a block's last instruction may go to.
pub fn targets(last: &Instruction) -> impl Iterator<Item = Word> {
    let labels: Vec<Word> = match last.class.opcode {
        Op::Branch => vec![last.operands[0].unwrap_id_ref()],
        Op::BranchConditional => last.operands[1..3].iter().map(|label| label.unwrap_id_ref()).collect(),
        Op::Switch => last.operands[1..].iter().filter_map(|operand| operand.id_ref_any()).collect(),
        _ => Vec::new(),
    };
    labels.into_iter()
}

/// Whether a selection or a loop begins with the block.
pub fn has_merge(block: &Block) -> bool {
    merge(block).is_some()
}

/// The blocks where a selection or loop ends that begins with this one, and where the loop goes round.
pub fn ends_named(block: &Block) -> impl Iterator<Item = Word> {
    merge(block).into_iter().flat_map(|merge| merge.operands.iter().filter_map(|operand| operand.id_ref_any()))
}

fn merge(block: &Block) -> Option<&Instruction> {
    let before = block.instructions.iter().rev().nth(1)?;
    matches!(before.class.opcode, Op::SelectionMerge | Op::LoopMerge).then_some(before)
}

/// Removes the blocks that are not reached. Where a selection or loop goes on that is left by no way, and where a loop
/// goes round that never does, a block must stay; it is emptied.
pub fn remove_unreachable(function: &mut Function, constants: &mut Constants) {
    let reached = reached(function);
    let ends = ends(function, &reached);
    function.blocks.retain_mut(|block| {
        let label = label(block);
        match ends.get(&label) {
            _ if reached.contains(&label) => true,
            Some(end) => {
                block.instructions = vec![end.clone()];
                true
            }
            None => false,
        }
    });
    prune_phis(function, &reached, constants);
}

/// The id that branches to a block name.
pub fn label(block: &Block) -> Word {
    block.label.as_ref().and_then(|label| label.result_id).unwrap_or_default()
}

fn reached(function: &Function) -> FxHashSet<Word> {
    let by_label: FxHashMap<Word, &Block> = function.blocks.iter().map(|block| (label(block), block)).collect();
    let mut open: Vec<Word> = function.blocks.first().map(label).into_iter().collect();
    let mut reached = FxHashSet::default();
    while let Some(id) = open.pop() {
        if reached.insert(id) {
            open.extend(by_label.get(&id).and_then(|block| block.instructions.last()).into_iter().flat_map(targets));
        }
    }
    reached
}

/// The blocks that must stay though they are not reached, and what they then consist of.
fn ends(function: &Function, reached: &FxHashSet<Word>) -> FxHashMap<Word, Instruction> {
    let mut ends = FxHashMap::default();
    for block in function.blocks.iter().filter(|block| reached.contains(&label(block))) {
        let Some(merge) = merge(block) else { continue };
        let unreachable = Instruction::new(Op::Unreachable, None, None, Vec::new());
        ends.entry(merge.operands[0].unwrap_id_ref()).or_insert(unreachable);
        if merge.class.opcode == Op::LoopMerge {
            let back = Instruction::new(Op::Branch, None, None, vec![Operand::IdRef(label(block))]);
            // A loop must keep its way back, even where a selection ends, too.
            ends.insert(merge.operands[1].unwrap_id_ref(), back);
        }
    }
    ends
}

/// Forgets values that come from no predecessor; from an emptied one comes no value in particular.
fn prune_phis(function: &mut Function, reached: &FxHashSet<Word>, constants: &mut Constants) {
    let mut sources: FxHashMap<Word, BTreeSet<Word>> = FxHashMap::default();
    for block in &function.blocks {
        for target in block.instructions.last().into_iter().flat_map(targets) {
            sources.entry(target).or_default().insert(label(block));
        }
    }
    for block in &mut function.blocks {
        let Some(from) = sources.get(&label(block)) else { continue };
        for phi in block.instructions.iter_mut().filter(|inst| inst.class.opcode == Op::Phi) {
            let mut kept = Vec::with_capacity(phi.operands.len());
            let mut open = from.clone();
            for pair in phi.operands.chunks(2) {
                let source = pair[1].unwrap_id_ref();
                if reached.contains(&source) && open.remove(&source) {
                    kept.extend_from_slice(pair);
                }
            }
            // An emptied block may go where it did not before.
            for source in open {
                let undefined = constants.undefined(phi.result_type);
                kept.extend([Operand::IdRef(undefined), Operand::IdRef(source)]);
            }
            phi.operands = kept;
        }
    }
}
