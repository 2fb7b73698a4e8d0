//! The integer and boolean constants of a module.

use rustc_hash::FxHashMap;

use rspirv::dr::{Instruction, Module, Operand};
use rspirv::spirv::{Op, Word};

/// What a type's values are, of those that are folded.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Bool,
    Int,
}

/// Constants by id and by value; a condition is 0 or 1.
#[derive(Default)]
pub struct Constants {
    kinds: FxHashMap<Word, Kind>,
    values: FxHashMap<Word, u32>,
    ids: FxHashMap<(Word, u32), Word>,
    undefined: FxHashMap<Option<Word>, Word>,
    new: Vec<Instruction>,
    bound: Word,
}

impl Constants {
    /// Those of a module.
    pub fn of(module: &Module) -> Self {
        let bound = module.header.as_ref().map_or(0, |header| header.bound);
        let mut this = Constants { bound, ..Constants::default() };
        for inst in &module.types_global_values {
            let Some(id) = inst.result_id else { continue };
            match inst.class.opcode {
                Op::TypeBool => drop(this.kinds.insert(id, Kind::Bool)),
                Op::TypeInt if inst.operands[0] == Operand::LiteralBit32(32) => {
                    this.kinds.insert(id, Kind::Int);
                }
                Op::Undef => drop(this.undefined.insert(inst.result_type, id)),
                _ => this.note(inst, id),
            }
        }
        this
    }

    fn note(&mut self, inst: &Instruction, id: Word) {
        let Some(kind) = inst.result_type.filter(|kind| self.kinds.contains_key(kind)) else { return };
        let value = match inst.class.opcode {
            Op::Constant => inst.operands[0].unwrap_literal_bit32(),
            Op::ConstantTrue => 1,
            Op::ConstantFalse | Op::ConstantNull => 0,
            _ => return,
        };
        self.values.insert(id, value);
        self.ids.entry((kind, value)).or_insert(id);
    }

    /// The value of a constant.
    pub fn value(&self, id: Word) -> Option<u32> {
        self.values.get(&id).copied()
    }

    /// Whether values of a type are folded.
    pub fn folds(&self, kind: Word) -> bool {
        self.kinds.contains_key(&kind)
    }

    /// The constant of a type that [`Constants::folds`] and a value: a new one if the module has none.
    pub fn id(&mut self, kind: Word, value: u32) -> Word {
        if let Some(&id) = self.ids.get(&(kind, value)) {
            return id;
        }
        let id = self.bound;
        self.bound += 1;
        let (op, operands) = match (self.kinds[&kind], value) {
            (Kind::Int, _) => (Op::Constant, vec![Operand::LiteralBit32(value)]),
            (Kind::Bool, 0) => (Op::ConstantFalse, Vec::new()),
            (Kind::Bool, _) => (Op::ConstantTrue, Vec::new()),
        };
        self.new.push(Instruction::new(op, Some(kind), Some(id), operands));
        self.values.insert(id, value);
        self.ids.insert((kind, value), id);
        id
    }

    /// No value in particular of a type.
    pub fn undefined(&mut self, kind: Option<Word>) -> Word {
        let (new, bound) = (&mut self.new, &mut self.bound);
        *self.undefined.entry(kind).or_insert_with(|| {
            let id = *bound;
            *bound += 1;
            new.push(Instruction::new(Op::Undef, kind, Some(id), Vec::new()));
            id
        })
    }

    /// Adds the new constants to the module that these are of.
    pub fn finish(self, module: &mut Module) {
        module.types_global_values.extend(self.new);
        if let Some(header) = &mut module.header {
            header.bound = self.bound;
        }
    }
}
