//! Parts of composites that were put there before.

use rustc_hash::FxHashMap;

use rspirv::dr::{Function, Instruction, Module, Operand};
use rspirv::spirv::{Op, Word};

/// What a module's types and constants say of composites.
pub struct Globals<'m> {
    made: FxHashMap<Word, &'m Instruction>,
    /// Vectors, whose parts may be vectors themselves, by their numbers of components.
    vectors: FxHashMap<Word, usize>,
}

impl<'m> Globals<'m> {
    /// Those of a module.
    pub fn of(module: &'m Module) -> Self {
        let globals = &module.types_global_values;
        let vectors = globals.iter().filter(|inst| inst.class.opcode == Op::TypeVector);
        let vectors = vectors.filter_map(|inst| Some((inst.result_id?, literal(&inst.operands[1]) as usize))).collect();
        Globals { made: made(globals), vectors }
    }
}

/// The composites of a function that instructions make of parts.
pub struct Composites<'f> {
    globals: &'f Globals<'f>,
    made: FxHashMap<Word, &'f Instruction>,
}

fn made<'i>(instructions: impl IntoIterator<Item = &'i Instruction>) -> FxHashMap<Word, &'i Instruction> {
    let makes = |inst: &&Instruction| {
        matches!(inst.class.opcode, Op::ConstantComposite | Op::CompositeConstruct | Op::CompositeInsert | Op::Phi)
    };
    instructions.into_iter().filter(makes).filter_map(|inst| Some((inst.result_id?, inst))).collect()
}

impl<'f> Composites<'f> {
    /// Those of a function.
    pub fn of(function: &'f Function, globals: &'f Globals<'f>) -> Self {
        Composites { globals, made: made(function.blocks.iter().flat_map(|block| &block.instructions)) }
    }

    fn made(&self, id: Word) -> Option<&'f Instruction> {
        self.made.get(&id).or_else(|| self.globals.made.get(&id)).copied()
    }

    /// The id of what an instruction takes out of a composite, if it was put there as it is, whichever way led there.
    pub fn part(&self, extract: &Instruction) -> Option<Word> {
        let whole = extract.operands[0].id_ref_any()?;
        let mut search = Search { composites: self, seen: Vec::new(), found: None };
        search.part(whole, &extract.operands[1..])?;
        search.found
    }

    /// The first step into a composite of parts.
    fn given<'p>(&self, from: &Instruction, path: &'p [Operand]) -> Option<(Word, &'p [Operand])> {
        let whole = from.result_type.and_then(|kind| self.globals.vectors.get(&kind));
        if whole.is_some_and(|&components| components != from.operands.len()) {
            return None;
        }
        let part = from.operands.get(literal(&path[0]) as usize)?.id_ref_any()?;
        Some((part, &path[1..]))
    }
}

/// A search for a part, which forks at phis.
struct Search<'s> {
    composites: &'s Composites<'s>,
    /// Phis that were come by, and how many steps were left there: loops come back to them.
    seen: Vec<(Word, usize)>,
    /// What every way so far has led to.
    found: Option<Word>,
}

impl Search<'_> {
    /// Follows all ways to the part at a path of a composite; none where it is not known, or they lead to several.
    ///
    /// One part on all ways is there wherever they join: it is older than any composite that holds it.
    fn part(&mut self, mut id: Word, mut path: &[Operand]) -> Option<()> {
        while !path.is_empty() {
            let from = self.composites.made(id)?;
            (id, path) = match from.class.opcode {
                Op::Phi => return self.fork(id, from, path),
                Op::CompositeInsert => inserted(from, path)?,
                _ => self.composites.given(from, path)?,
            };
        }
        (*self.found.get_or_insert(id) == id).then_some(())
    }

    fn fork(&mut self, id: Word, phi: &Instruction, path: &[Operand]) -> Option<()> {
        if self.seen.contains(&(id, path.len())) {
            return Some(());
        }
        self.seen.push((id, path.len()));
        phi.operands.iter().step_by(2).try_for_each(|source| self.part(source.id_ref_any()?, path))
    }
}

/// The step into what was inserted, or past it; none where it covers only some of what is asked for.
fn inserted<'p>(from: &Instruction, path: &'p [Operand]) -> Option<(Word, &'p [Operand])> {
    let place = &from.operands[2..];
    if path.starts_with(place) {
        Some((from.operands[0].id_ref_any()?, &path[place.len()..]))
    } else if place.starts_with(path) {
        None
    } else {
        Some((from.operands[1].id_ref_any()?, path))
    }
}

fn literal(operand: &Operand) -> u32 {
    match operand {
        Operand::LiteralBit32(value) => *value,
        _ => u32::MAX,
    }
}
