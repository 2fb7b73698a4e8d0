//! The rewrites and checks between the compiler's module and a committed one, a file each.

pub mod contraction;
pub mod debug;
pub mod forbidden;
pub mod inlining;
pub mod memory;
pub mod names;
pub mod pointers;

use eyerays_passes::{capability, dead, renumber, select};
use rspirv::binary::Assemble;
use rspirv::dr;

use crate::compile::FLOATS_AS_WRITTEN;
use crate::table::{Module, Policy};
use crate::{Error, Result};

/// A module with every rewrite done and every check passed.
#[derive(Debug)]
pub struct Finished {
    /// The module, for reflection.
    pub module: dr::Module,
    /// Names of the functions that were marked `#[inline(never)]` in the source.
    pub protected: Vec<String>,
}

impl Finished {
    /// The words of the module's file.
    pub fn words(&self) -> Vec<u32> {
        self.module.assemble()
    }
}

/// Cuts `table`'s module from the compiler's `words`.
pub fn finish(words: &[u32], table: &Module) -> Result<Finished> {
    let mut module = dr::load_words(words).map_err(|e| Error::Malformed(e.to_string()))?;
    debug::strip_lines(&mut module);
    select::entries(&mut module, |name| table.prefixes.iter().any(|prefix| name.starts_with(prefix)))?;
    if module.entry_points.is_empty() {
        return Err(Error::NoEntry(table.name));
    }
    dead::remove(&mut module);
    pointers::check(&module)?;
    if table.policy == Policy::Exact {
        forbidden::check(&module)?;
    }
    contraction::forbid(&mut module, table.policy);
    let protected = inlining::release(&mut module);
    inlining::require(&protected, table.protects)?;
    memory::to_glsl450(&mut module)?;
    // It has done its work.
    module.capabilities.retain(|inst| inst.operands[0].unwrap_capability() != FLOATS_AS_WRITTEN);
    capability::prune(&mut module);
    debug::strip_local_names(&mut module);
    renumber::compact(&mut module);
    Ok(Finished { module, protected })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compile;
    use crate::validate::{self, Validation};
    use eyerays_passes::testing::Kernel;

    #[test]
    fn both_modules_come_from_one() {
        let mut kernel = Kernel::new();
        kernel.capability(rspirv::spirv::Capability::VulkanMemoryModel);
        kernel.capability(compile::FLOATS_AS_WRITTEN);
        let root = kernel.protected(|b| {
            let x = b.load_input();
            let y = b.f_div(x, x);
            b.store_output(y);
        });
        kernel.name(root, "real::div");
        kernel.entry("entry::kernels::exact::a", |b| b.call(root));
        kernel.entry("entry::kernels::fast::a", |b| {
            let x = b.load_input();
            let y = b.f_div(x, x);
            b.store_output(y);
        });
        let words = kernel.module().assemble();
        for (name, policy, protected) in [("exact", Policy::Exact, vec!["real::div"]), ("fast", Policy::Fast, vec![])] {
            let prefixes: &[&str] = if name == "exact" { &["exact::"] } else { &["fast::"] };
            let table = Module { name, prefixes, policy, protects: &[] };
            let finished = finish(&words, &table).unwrap();
            assert_eq!(finished.protected, protected);
            let bytes = compile::bytes(&finished.words());
            let again = dr::load_bytes(&bytes).unwrap();
            assert_eq!(again.entry_points.len(), 1);
            assert!(matches!(validate::run(name, &bytes), Ok(Validation::Passed | Validation::Skipped)));
        }
    }
}
