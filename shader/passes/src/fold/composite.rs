//! Parts of composites that were put there before.

use std::collections::HashMap;

use rspirv::dr::{Instruction, Module, Operand};
use rspirv::spirv::{Op, Word};

/// The composites of a module that instructions make of parts.
pub struct Composites<'m> {
    made: HashMap<Word, &'m Instruction>,
    /// Vectors, whose parts may be vectors themselves, by their numbers of components.
    vectors: HashMap<Word, usize>,
}

impl<'m> Composites<'m> {
    /// Those of a module.
    pub fn of(module: &'m Module) -> Self {
        let mut this = Composites { made: HashMap::new(), vectors: HashMap::new() };
        let bodies =
            module.functions.iter().flat_map(|function| &function.blocks).flat_map(|block| &block.instructions);
        for inst in module.types_global_values.iter().chain(bodies) {
            let Some(id) = inst.result_id else { continue };
            match inst.class.opcode {
                Op::TypeVector => {
                    this.vectors.insert(id, literal(&inst.operands[1]) as usize);
                }
                Op::ConstantComposite | Op::CompositeConstruct | Op::CompositeInsert | Op::Phi => {
                    this.made.insert(id, inst);
                }
                _ => {}
            }
        }
        this
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
        let whole = from.result_type.and_then(|kind| self.vectors.get(&kind));
        if whole.is_some_and(|&components| components != from.operands.len()) {
            return None;
        }
        let part = from.operands.get(literal(&path[0]) as usize)?.id_ref_any()?;
        Some((part, &path[1..]))
    }
}

/// A search for a part, which forks at phis.
struct Search<'s, 'm> {
    composites: &'s Composites<'m>,
    /// Phis that were come by, and how many steps were left there: loops come back to them.
    seen: Vec<(Word, usize)>,
    /// What every way so far has led to.
    found: Option<Word>,
}

impl Search<'_, '_> {
    /// Follows all ways to the part at a path of a composite; none where it is not known, or they lead to several.
    ///
    /// One part on all ways is there wherever they join: it is older than any composite that holds it.
    fn part(&mut self, mut id: Word, mut path: &[Operand]) -> Option<()> {
        while !path.is_empty() {
            let from = self.composites.made.get(&id)?;
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
