//! One kernel as a module of its own.

use rustc_hash::FxHashSet;

use rspirv::binary::Assemble;
use rspirv::dr::{self, Instruction, Module, Operand};
use rspirv::spirv::{Op, Word};

use crate::slice::Sliced;
use crate::{Error, Result, bindings, capability, fold, renumber, specialise};

/// A module of many kernels.
#[derive(Debug, Clone)]
pub struct Kernels(Sliced);

impl Kernels {
    /// Reads the bytes of a module's file.
    ///
    /// # Errors
    /// They are no SPIR-V module.
    pub fn parse(bytes: &[u8]) -> Result<Self> {
        Sliced::new(bytes).map(Kernels)
    }

    /// The names of the entry points, sorted.
    pub fn names(&self) -> Vec<String> {
        self.0.names()
    }

    /// The kernel of one entry point, with a value for each `SpecId` of its specialisation constants (the others keep
    /// their defaults) and every branch gone that these decide.
    ///
    /// # Errors
    /// There is no such entry point, or its function is no SPIR-V.
    pub fn cut(&self, entry: &str, constants: &[(u32, u32)]) -> Result<Kernel> {
        let words = self.0.of_entry(entry)?;
        let mut module = dr::load_words(words).map_err(|e| Error::Malformed(e.to_string()))?;
        module.entry_points.retain(|declared| declared.operands[2] == Operand::LiteralString(entry.to_owned()));
        specialise::write(&mut module, constants);
        fold::fold(&mut module);
        capability::prune(&mut module);
        renumber::compact(&mut module);
        let bindings = bindings::close_up(&mut module);
        Ok(Kernel { module, bindings })
    }
}

/// A module of one entry point that holds what this reaches and nothing else.
#[derive(Debug, Clone)]
pub struct Kernel {
    module: Module,
    bindings: Vec<u32>,
}

impl Kernel {
    /// The words of the module's file.
    pub fn words(&self) -> Vec<u32> {
        self.module.assemble()
    }

    /// The paths of its functions in the source, as far as the module tells them.
    pub fn functions(&self) -> Vec<&str> {
        let ids: FxHashSet<Word> = self.module.functions.iter().filter_map(|function| function.def_id()).collect();
        let named =
            |inst: &Instruction| inst.class.opcode == Op::Name && ids.contains(&inst.operands[0].unwrap_id_ref());
        let names = self.module.debug_names.iter().filter(|inst| named(inst));
        names.map(|inst| inst.operands[1].unwrap_literal_string()).collect()
    }

    /// How many instructions its functions have.
    pub fn instructions(&self) -> usize {
        let functions = self.module.functions.iter();
        functions.flat_map(|f| &f.blocks).map(|block| block.instructions.len()).sum()
    }

    /// The bindings of the buffers that it reaches, in order. In its module they are numbered from 0 on: drivers want a
    /// layout without gaps.
    pub fn bindings(&self) -> &[u32] {
        &self.bindings
    }
}
