//! Branches whose way is known.

use rspirv::dr::{Block, Function, Instruction, Operand};
use rspirv::spirv::{Op, Word};
use rustc_hash::{FxHashMap, FxHashSet};

use super::blocks;
use super::constants::Constants;

/// Lets every branch whose condition is constant go its one way and removes the blocks that nothing reaches any more;
/// tells whether there was any.
pub fn fold(function: &mut Function, constants: &mut Constants) -> bool {
    let places = Places::of(function);
    let mut folded = false;
    for (index, block) in function.blocks.iter_mut().enumerate() {
        folded |= straighten(block, index, &places, constants);
    }
    if folded {
        blocks::remove_unreachable(function, constants);
    }
    folded
}

/// What must be known of a function's other blocks where one is straightened.
struct Places {
    /// The blocks in their order, by label.
    order: FxHashMap<Word, usize>,
    /// Where branches without a selection of their own go.
    bare: FxHashSet<Word>,
}

impl Places {
    fn of(function: &Function) -> Places {
        let order = function.blocks.iter().enumerate().map(|(index, block)| (blocks::label(block), index)).collect();
        let is_bare = |block: &&Block| !blocks::has_merge(block);
        let last = function.blocks.iter().filter(is_bare).filter_map(|block| block.instructions.last());
        let bare = last.filter(|last| last.class.opcode == Op::BranchConditional).flat_map(blocks::targets).collect();
        Places { order, bare }
    }

    /// Whether a branch of a block may go round a loop again: a loop must keep its one way back, even if it is never taken.
    fn goes_back(&self, index: usize, last: &Instruction) -> bool {
        blocks::targets(last).any(|target| self.order.get(&target).is_some_and(|&at| at <= index))
    }
}

/// Lets a block's branch go its one way, if that is known and not yet so.
fn straighten(block: &mut Block, index: usize, places: &Places, constants: &Constants) -> bool {
    let Some(last) = block.instructions.last() else { return false };
    let Some(target) = way(last, constants) else { return false };
    if places.goes_back(index, last) {
        return false;
    }
    let merge = selection_merge(block);
    let is_switch = last.class.opcode == Op::Switch;
    // A branch without a selection of its own may leave a selection for its end, for the sake of this selection alone.
    if merge.is_some_and(|merge| is_switch || places.bare.contains(&merge)) {
        return narrow(block, target);
    }
    block.instructions.pop();
    if merge.is_some() {
        block.instructions.pop();
    }
    block.instructions.push(Instruction::new(Op::Branch, None, None, vec![Operand::IdRef(target)]));
    true
}

/// Where a conditional branch or switch goes, if that is constant.
fn way(last: &Instruction, constants: &Constants) -> Option<Word> {
    let value = || constants.value(last.operands[0].unwrap_id_ref());
    let label = |i: usize| last.operands[i].unwrap_id_ref();
    match last.class.opcode {
        Op::BranchConditional => Some(if value()? != 0 { label(1) } else { label(2) }),
        Op::Switch => {
            let value = value()?;
            let case = last.operands[2..].chunks(2).find(|case| case[0] == Operand::LiteralBit32(value));
            Some(case.map_or_else(|| label(1), |case| case[1].unwrap_id_ref()))
        }
        _ => None,
    }
}

/// The block where a selection ends that begins with this one.
fn selection_merge(block: &Block) -> Option<Word> {
    let before = block.instructions.iter().rev().nth(1)?;
    (before.class.opcode == Op::SelectionMerge).then(|| before.operands[0].unwrap_id_ref())
}

/// Leaves a selection in place whose branch goes one way; tells whether it went more.
fn narrow(block: &mut Block, target: Word) -> bool {
    let Some(last) = block.instructions.last_mut() else { return false };
    let to = Operand::IdRef(target);
    let operands = match last.class.opcode {
        Op::Switch => vec![last.operands[0].clone(), to],
        _ => vec![last.operands[0].clone(), to.clone(), to],
    };
    std::mem::replace(&mut last.operands, operands.clone()) != operands
}
