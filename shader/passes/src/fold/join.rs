//! Blocks that follow one another without a choice.

use rustc_hash::{FxHashMap, FxHashSet};

use rspirv::dr::{Block, Function, Module};
use rspirv::spirv::{Op, Word};

use super::blocks;

/// Makes one block of two where the first always goes on to the second, and nothing else does: what remains of a selection
/// whose way is known is then no longer seen.
pub fn join(module: &mut Module) {
    module.functions.iter_mut().for_each(join_blocks);
}

/// [`join`] in one function.
pub fn join_blocks(function: &mut Function) {
    let followers = followers(function);
    let mut rest: Vec<Option<Block>> = std::mem::take(&mut function.blocks).into_iter().map(Some).collect();
    let mut joined = FxHashMap::default();
    for index in 0..rest.len() {
        let Some(mut block) = rest[index].take() else { continue };
        let name = blocks::label(&block);
        while let Some(follower) = only_way(&block).and_then(|target| followers.get(&target)) {
            let Some(next) = rest[*follower].take() else { break };
            joined.insert(blocks::label(&next), name);
            block.instructions.pop();
            block.instructions.extend(next.instructions);
        }
        function.blocks.push(block);
    }
    for phi in
        function.blocks.iter_mut().flat_map(|block| &mut block.instructions).filter(|inst| inst.class.opcode == Op::Phi)
    {
        for source in phi.operands.iter_mut().skip(1).step_by(2).filter_map(|operand| operand.id_ref_any_mut()) {
            *source = *joined.get(source).unwrap_or(source);
        }
    }
}

/// Where a block goes that chooses nothing and begins nothing.
fn only_way(block: &Block) -> Option<Word> {
    let last = block.instructions.last()?;
    (last.class.opcode == Op::Branch && !blocks::has_merge(block)).then(|| last.operands[0].unwrap_id_ref())
}

/// The blocks, by label, that a single other one goes to, and where no selection or loop ends or goes round.
fn followers(function: &Function) -> FxHashMap<Word, usize> {
    let mut ways: FxHashMap<Word, u32> = FxHashMap::default();
    let mut ends = FxHashSet::default();
    for block in &function.blocks {
        block
            .instructions
            .last()
            .into_iter()
            .flat_map(blocks::targets)
            .for_each(|to| *ways.entry(to).or_default() += 1);
        ends.extend(blocks::ends_named(block));
    }
    let follows = |block: &Block| {
        let name = blocks::label(block);
        let chooses_value = block.instructions.first().is_some_and(|inst| inst.class.opcode == Op::Phi);
        !chooses_value && ways.get(&name) == Some(&1) && !ends.contains(&name)
    };
    let blocks = function.blocks.iter().enumerate();
    blocks.filter(|(_, block)| follows(block)).map(|(index, block)| (blocks::label(block), index)).collect()
}
