//! One kernel as a module of its own.

use rspirv::binary::Assemble;
use rspirv::dr::{self, Module, Operand};
use rspirv::spirv::{Decoration, StorageClass, Word};

use crate::slice::Sliced;
use crate::{Error, Result, fold, renumber, specialise};

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
        renumber::compact(&mut module);
        Ok(Kernel(module))
    }
}

/// A module of one entry point that holds what this reaches and nothing else.
#[derive(Debug, Clone)]
pub struct Kernel(Module);

impl Kernel {
    /// The words of the module's file.
    pub fn words(&self) -> Vec<u32> {
        self.0.assemble()
    }

    /// How many instructions its functions have.
    pub fn instructions(&self) -> usize {
        let functions = self.0.functions.iter();
        functions.flat_map(|f| &f.blocks).map(|block| block.instructions.len()).sum()
    }

    /// The bindings of the buffers that it reaches, in order.
    pub fn bindings(&self) -> Vec<u32> {
        let is_buffer = |id: &Word| {
            let variable = self.0.types_global_values.iter().find(|inst| inst.result_id == Some(*id));
            let class = variable.and_then(|inst| inst.operands.first());
            matches!(class, Some(Operand::StorageClass(StorageClass::StorageBuffer | StorageClass::Uniform)))
        };
        let of = |inst: &dr::Instruction| match inst.operands[..] {
            [Operand::IdRef(id), Operand::Decoration(Decoration::Binding), Operand::LiteralBit32(binding)] => {
                is_buffer(&id).then_some(binding)
            }
            _ => None,
        };
        let mut bindings: Vec<u32> = self.0.annotations.iter().filter_map(of).collect();
        bindings.sort_unstable();
        bindings
    }
}
