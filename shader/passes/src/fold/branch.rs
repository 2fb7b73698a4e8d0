//! Branches whose way is known.

use rspirv::dr::{Block, Function, Instruction, Module, Operand};
use rspirv::spirv::{Op, Word};

use super::blocks;
use super::constants::Constants;

/// Lets every branch whose condition is constant go its one way and removes the blocks that nothing reaches any more;
/// tells whether there was any.
pub fn fold(module: &mut Module) -> bool {
    let constants = Constants::of(module);
    let mut functions = std::mem::take(&mut module.functions);
    let mut any = false;
    for function in &mut functions {
        let mut folded = false;
        for index in 0..function.blocks.len() {
            folded |= straighten(function, index, &constants);
        }
        if folded {
            blocks::remove_unreachable(function, module);
        }
        any |= folded;
    }
    module.functions = functions;
    any
}

/// Lets a block's branch go its one way, if that is known and not yet so.
fn straighten(function: &mut Function, index: usize, constants: &Constants) -> bool {
    let block = &function.blocks[index];
    let Some(last) = block.instructions.last() else { return false };
    let Some(target) = way(last, constants) else { return false };
    if goes_back(function, index, last) {
        return false;
    }
    let merge = selection_merge(block);
    let is_switch = last.class.opcode == Op::Switch;
    if merge.is_some_and(|merge| is_switch || leaves_early(function, index, merge)) {
        return narrow(&mut function.blocks[index], target);
    }
    let instructions = &mut function.blocks[index].instructions;
    instructions.pop();
    if merge.is_some() {
        instructions.pop();
    }
    instructions.push(Instruction::new(Op::Branch, None, None, vec![Operand::IdRef(target)]));
    true
}

/// Whether a branch may go round a loop again: a loop must keep its one way back, even if it is never taken.
fn goes_back(function: &Function, index: usize, last: &Instruction) -> bool {
    let before: Vec<Word> = function.blocks[..=index].iter().map(blocks::label).collect();
    blocks::targets(last).any(|target| before.contains(&target))
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

/// Whether a branch without a selection of its own may leave a selection for its end. It is allowed to for the sake of
/// this selection alone.
fn leaves_early(function: &Function, header: usize, merge: Word) -> bool {
    function.blocks.iter().enumerate().any(|(index, block)| {
        let Some(last) = block.instructions.last() else { return false };
        let is_bare = index != header && last.class.opcode == Op::BranchConditional && !blocks::has_merge(block);
        is_bare && blocks::targets(last).any(|target| target == merge)
    })
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
