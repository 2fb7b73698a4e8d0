//! Selections whose sides compute a little: both sides are computed, and their values selected.
//!
//! A driver's compiler takes time by the blocks of a kernel, more than by its instructions, and would not branch there either.

use rustc_hash::{FxHashMap, FxHashSet};

use rspirv::dr::{Block, Function, Instruction, Module, Operand};
use rspirv::spirv::{Op, Word};

use super::{blocks, join};

/// The most instructions that are computed in vain. A picture takes as long with none, 12 and 40 of them, and the driver's compiler
/// takes least with 40 (an NVIDIA H100).
const MOST: usize = 40;

/// Flattens selections, the innermost first, until none is left that is small enough.
pub fn flatten(module: &mut Module) {
    let scalars = scalars(module);
    for function in &mut module.functions {
        while flatten_all(function, &scalars) {
            join::join_blocks(function);
        }
    }
}

/// The types whose values can be selected by one condition in every version of SPIR-V.
fn scalars(module: &Module) -> FxHashSet<Word> {
    let is_scalar = |inst: &&Instruction| matches!(inst.class.opcode, Op::TypeInt | Op::TypeFloat | Op::TypeBool);
    module.types_global_values.iter().filter(is_scalar).filter_map(|inst| inst.result_id).collect()
}

/// A selection that can be flattened.
struct Selection {
    condition: Word,
    /// Where the end's values come from if the condition holds, and if not: the labels of the two last blocks.
    sources: [Word; 2],
    /// The blocks of its sides.
    sides: Vec<usize>,
    end: usize,
}

/// Flattens every selection that is not part of another one that was; tells whether there was any.
fn flatten_all(function: &mut Function, scalars: &FxHashSet<Word>) -> bool {
    let map = Map::of(function);
    let mut touched = FxHashSet::default();
    let mut any = false;
    for header in 0..function.blocks.len() {
        let Some(selection) = map.selection(function, header, scalars) else { continue };
        let own = || selection.sides.iter().copied().chain([header, selection.end]);
        if own().any(|block| touched.contains(&block)) {
            continue;
        }
        touched.extend(own());
        apply(function, header, &selection);
        any = true;
    }
    function.blocks.retain(|block| !block.instructions.is_empty());
    any
}

/// The ways between the blocks of a function.
struct Map {
    indices: FxHashMap<Word, usize>,
    /// How many ways lead to a block.
    ways: FxHashMap<Word, usize>,
    /// Where a selection or loop ends or goes round.
    ends: FxHashMap<Word, usize>,
}

impl Map {
    fn of(function: &Function) -> Map {
        let mut map = Map { indices: FxHashMap::default(), ways: FxHashMap::default(), ends: FxHashMap::default() };
        for (index, block) in function.blocks.iter().enumerate() {
            map.indices.insert(blocks::label(block), index);
            block.instructions.last().into_iter().flat_map(blocks::targets).for_each(|to| {
                *map.ways.entry(to).or_default() += 1;
            });
            blocks::ends_named(block).for_each(|end| *map.ends.entry(end).or_default() += 1);
        }
        map
    }

    /// The selection that begins with a block, if both of its sides are small and nothing else leads to its end.
    fn selection(&self, function: &Function, header: usize, scalars: &FxHashSet<Word>) -> Option<Selection> {
        let block = &function.blocks[header];
        let [.., merge, branch] = &block.instructions[..] else { return None };
        if merge.class.opcode != Op::SelectionMerge || branch.class.opcode != Op::BranchConditional {
            return None;
        }
        let label = |operand: &Operand| operand.unwrap_id_ref();
        let end = label(&merge.operands[0]);
        let targets = [label(&branch.operands[1]), label(&branch.operands[2])];
        if targets[0] == targets[1] || self.ways.get(&end) != Some(&2) || self.ends.get(&end) != Some(&1) {
            return None;
        }
        let mut sides = Vec::new();
        let mut sources = targets;
        for (target, source) in targets.into_iter().zip(&mut sources) {
            if target == end {
                *source = blocks::label(block);
                continue;
            }
            let side = *self.indices.get(&target)?;
            let is_own = self.ways.get(&target) == Some(&1) && !self.ends.contains_key(&target);
            if !is_own || !is_plain(&function.blocks[side], end) {
                return None;
            }
            sides.push(side);
        }
        let end = *self.indices.get(&end)?;
        let computed: usize = sides.iter().map(|&side| function.blocks[side].instructions.len() - 1).sum();
        let chosen = phis(&function.blocks[end]);
        let can_choose = chosen.iter().all(|phi| phi.result_type.is_some_and(|kind| scalars.contains(&kind)));
        let condition = label(&branch.operands[0]);
        (computed <= MOST && can_choose).then_some(Selection { condition, sources, sides, end })
    }
}

/// The values that a block chooses by where it is reached from.
fn phis(block: &Block) -> &[Instruction] {
    let count = block.instructions.iter().take_while(|inst| inst.class.opcode == Op::Phi).count();
    &block.instructions[..count]
}

/// Does a block go on to `end` after instructions that may be computed in vain?
fn is_plain(block: &Block, end: Word) -> bool {
    let Some((last, rest)) = block.instructions.split_last() else { return false };
    let goes_on = last.class.opcode == Op::Branch && last.operands[0].unwrap_id_ref() == end;
    goes_on && rest.iter().all(is_pure)
}

/// Does it nothing but compute a value, whatever its operands are? No division of integers, which by zero may do anything.
fn is_pure(inst: &Instruction) -> bool {
    /// Of GLSL.std.450, those that return all of their result: `Modf` and `Frexp` write some of it.
    const WRITES: [u32; 2] = [35, 51];
    use Op::*;
    if inst.class.opcode == ExtInst {
        return matches!(inst.operands[1], Operand::LiteralExtInstInteger(number) if !WRITES.contains(&number));
    }
    matches!(
        inst.class.opcode,
        Bitcast
            | BitwiseAnd
            | BitwiseOr
            | BitwiseXor
            | Not
            | ShiftLeftLogical
            | ShiftRightLogical
            | ShiftRightArithmetic
            | IAdd
            | ISub
            | IMul
            | SNegate
            | FAdd
            | FSub
            | FMul
            | FNegate
            | Select
            | ConvertFToS
            | ConvertFToU
            | ConvertSToF
            | ConvertUToF
            | FOrdLessThan
            | FOrdLessThanEqual
            | FOrdGreaterThan
            | FOrdGreaterThanEqual
            | FOrdEqual
            | FOrdNotEqual
            | FUnordLessThan
            | FUnordLessThanEqual
            | FUnordGreaterThan
            | FUnordGreaterThanEqual
            | FUnordEqual
            | FUnordNotEqual
            | IEqual
            | INotEqual
            | SLessThan
            | SLessThanEqual
            | SGreaterThan
            | SGreaterThanEqual
            | ULessThan
            | ULessThanEqual
            | UGreaterThan
            | UGreaterThanEqual
            | LogicalAnd
            | LogicalOr
            | LogicalNot
            | LogicalEqual
            | LogicalNotEqual
            | CompositeExtract
            | CompositeConstruct
    )
}

/// Moves what the sides compute before the branch, which then goes on to the end, and selects there.
fn apply(function: &mut Function, header: usize, selection: &Selection) {
    let mut moved = Vec::new();
    for &side in &selection.sides {
        let mut instructions = std::mem::take(&mut function.blocks[side].instructions);
        instructions.pop();
        moved.append(&mut instructions);
    }
    let to = Operand::IdRef(blocks::label(&function.blocks[selection.end]));
    let instructions = &mut function.blocks[header].instructions;
    instructions.truncate(instructions.len() - 2);
    instructions.append(&mut moved);
    instructions.push(Instruction::new(Op::Branch, None, None, vec![to]));
    let end = &mut function.blocks[selection.end].instructions;
    for phi in end.iter_mut().take_while(|inst| inst.class.opcode == Op::Phi) {
        let from = |source: Word| {
            let pair = phi.operands.chunks(2).find(|pair| pair[1] == Operand::IdRef(source));
            pair.expect("a value from each way").first().cloned().expect("a pair")
        };
        let operands =
            vec![Operand::IdRef(selection.condition), from(selection.sources[0]), from(selection.sources[1])];
        *phi = Instruction::new(Op::Select, phi.result_type, phi.result_id, operands);
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{cut, folded};
    use super::*;
    use crate::testing::Body;
    use rspirv::spirv::MemoryAccess;

    /// A kernel's body that stores what another makes of a word and a number.
    fn storing(body: impl FnOnce(&mut Body, Word, Word) -> Word) -> impl FnOnce(&mut Body, Word) {
        |b, _| {
            let (word, x) = (b.load_counter(MemoryAccess::NONE), b.load_input());
            let value = body(b, word, x);
            b.store_output(value);
        }
    }

    /// What is left of such a kernel.
    fn left(body: impl FnOnce(&mut Body, Word, Word) -> Word) -> Vec<Op> {
        folded(0, storing(body))
    }

    fn branches(ops: &[Op]) -> usize {
        ops.iter().filter(|op| **op == Op::BranchConditional).count()
    }

    fn sum(b: &mut Body, x: Word, count: usize) -> Word {
        (0..count).fold(x, |sum, _| b.f_add(sum, x))
    }

    #[test]
    fn both_sides_are_computed_and_one_is_selected() {
        let ops = left(|b, word, x| b.number_if(word, 1, |b| b.f_add(x, x), |b| b.f_mul(x, x)));
        let loads = [Op::Load, Op::Load, Op::BitwiseAnd, Op::INotEqual];
        assert_eq!(ops, [&loads[..], &[Op::FAdd, Op::FMul, Op::Select, Op::Store]].concat());
        let ops = left(|b, word, x| b.number_unless(word, 1, x, |b| b.f_add(x, x)));
        assert_eq!(ops, [&loads[..], &[Op::FAdd, Op::Select, Op::Store]].concat());
    }

    #[test]
    fn the_condition_selects_its_own_side() {
        let operations = |body: fn(&mut Body, Word, Word) -> Word| {
            let module = rspirv::dr::load_words(cut(0, storing(body)).words()).unwrap();
            let all = &module.functions[0].blocks[0].instructions;
            let select = all.iter().find(|inst| inst.class.opcode == Op::Select).unwrap();
            let of = |operand: &Operand| {
                let from = all.iter().find(|inst| inst.result_id == Some(operand.unwrap_id_ref()));
                from.unwrap().class.opcode
            };
            [of(&select.operands[1]), of(&select.operands[2])]
        };
        assert_eq!(operations(|b, w, x| b.number_if(w, 1, |b| b.f_add(x, x), |b| b.f_mul(x, x))), [Op::FAdd, Op::FMul]);
        assert_eq!(operations(|b, w, x| b.number_unless(w, 1, x, |b| b.f_mul(x, x))), [Op::FMul, Op::Load]);
    }

    #[test]
    fn a_selection_within_another_is_flattened_first() {
        let ops = left(|b, word, x| {
            let inner = |b: &mut Body| b.number_if(word, 2, |b| b.f_add(x, x), |b| b.f_mul(x, x));
            b.number_if(word, 1, inner, |_| x)
        });
        assert_eq!((branches(&ops), ops.iter().filter(|op| **op == Op::Select).count()), (0, 2), "{ops:?}");
    }

    #[test]
    fn what_touches_memory_or_takes_long_or_is_no_number_stays_a_branch() {
        let stays = |body: &dyn Fn(&mut Body, Word, Word) -> Word| branches(&left(|b, w, x| body(b, w, x))) == 1;
        assert!(stays(&|b, w, x| b.number_if(w, 1, |b| b.load_input(), |_| x)));
        assert!(stays(&|b, w, x| {
            b.if_has(w, 1, |b| b.store_output(x));
            x
        }));
        assert!(stays(&|b, w, x| b.number_if(w, 1, |b| sum(b, x, MOST), |b| b.f_mul(x, x))));
        assert!(!stays(&|b, w, x| b.number_if(w, 1, |b| sum(b, x, MOST), |_| x)));
        assert!(stays(&|b, w, x| {
            let pair = b.pair_if(w, 1, |b| b.pair(x, x), |b| b.pair_with_sum(x));
            b.part(pair, 0)
        }));
    }

    #[test]
    fn loops_keep_their_branches() {
        let ops = left(|b, word, _| {
            let count = b.count_up_to(word, word);
            b.store_counter(count);
            b.load_input()
        });
        assert_eq!(branches(&ops), 2, "{ops:?}");
    }
}
