//! One kernel as a module of its own.

use rspirv::binary::Assemble;
use rspirv::dr::{self, Module, Operand};
use rspirv::spirv::{Decoration, StorageClass, Word};

use crate::{Error, Result, dead, fold, renumber, select, specialise};

/// A module of many kernels, parsed.
#[derive(Debug, Clone)]
pub struct Kernels(Module);

impl Kernels {
    /// Parses the bytes of a module's file.
    ///
    /// # Errors
    /// They are no SPIR-V module.
    pub fn parse(bytes: &[u8]) -> Result<Self> {
        dr::load_bytes(bytes).map(Kernels).map_err(|e| Error::Malformed(e.to_string()))
    }

    /// The names of the entry points.
    pub fn names(&self) -> Vec<String> {
        let entries = self.0.entry_points.iter();
        entries.map(|entry| entry.operands[2].unwrap_literal_string().to_owned()).collect()
    }

    /// The kernel of one entry point, with a value for each `SpecId` of its specialisation constants (the others keep
    /// their defaults) and every branch gone that these decide.
    ///
    /// # Errors
    /// There is no such entry point.
    pub fn cut(&self, entry: &str, constants: &[(u32, u32)]) -> Result<Kernel> {
        let mut module = self.0.clone();
        select::entries(&mut module, |name| name == entry)?;
        if module.entry_points.is_empty() {
            return Err(Error::NoEntry(entry.to_owned()));
        }
        dead::remove(&mut module);
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
