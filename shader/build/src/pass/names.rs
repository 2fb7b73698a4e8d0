//! Names for messages.

use std::collections::HashMap;

use rspirv::dr::{Function, Module};
use rspirv::spirv::{Op, Word};

/// The names that the source gives to functions.
pub struct Names<'a>(HashMap<Word, &'a str>);

impl<'a> Names<'a> {
    /// The names of `module`; an entry point's own name wins.
    pub fn of(module: &'a Module) -> Self {
        let debug = module
            .debug_names
            .iter()
            .filter(|inst| inst.class.opcode == Op::Name)
            .map(|inst| (&inst.operands[0], &inst.operands[1]));
        let entries = module.entry_points.iter().map(|inst| (&inst.operands[1], &inst.operands[2]));
        let pair = |(id, name): (&rspirv::dr::Operand, &'a rspirv::dr::Operand)| {
            (id.unwrap_id_ref(), name.unwrap_literal_string())
        };
        Names(debug.chain(entries).map(pair).collect())
    }

    /// The name of `id`, or its number.
    pub fn get(&self, id: Word) -> String {
        match self.0.get(&id) {
            Some(name) => name.to_string(),
            None => format!("%{id}"),
        }
    }

    /// The name of a function.
    pub fn function(&self, function: &Function) -> String {
        self.get(function.def_id().unwrap_or_default())
    }
}
