//! The entry points of one module.

use rspirv::dr::{Instruction, Module, Operand};

use crate::{Error, Result};

/// Keeps the entry points whose names `wanted` accepts, in order of their names. The compiler names them by path; what
/// is before and in the module `kernels` is left out.
///
/// # Errors
/// Two of them have one name.
pub fn entries(module: &mut Module, wanted: impl Fn(&str) -> bool) -> Result<()> {
    module.entry_points.retain_mut(|entry| {
        let path = entry.operands[2].unwrap_literal_string();
        let name = path.rsplit_once("kernels::").map_or(path, |(_, name)| name).to_owned();
        let keep = wanted(&name);
        entry.operands[2] = Operand::LiteralString(name);
        keep
    });
    let name = |entry: &Instruction| entry.operands[2].unwrap_literal_string().to_owned();
    module.entry_points.sort_by_key(name);
    match module.entry_points.windows(2).find(|pair| name(&pair[0]) == name(&pair[1])) {
        Some(pair) => Err(Error::DuplicateEntry(name(&pair[0]))),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Kernel;

    #[test]
    fn keeps_what_is_wanted_and_its_path_in_the_kernels() {
        let mut kernel = Kernel::new();
        kernel.entry("entry::kernels::exact::b", |_| {});
        kernel.entry("entry::kernels::fast::a", |_| {});
        kernel.entry("entry::kernels::exact::a", |_| {});
        let mut module = kernel.module();
        entries(&mut module, |name| name.starts_with("exact::")).unwrap();
        let names: Vec<_> = module.entry_points.iter().map(|entry| entry.operands[2].unwrap_literal_string()).collect();
        assert_eq!(names, ["exact::a", "exact::b"]);
    }

    #[test]
    fn refuses_doubles() {
        let mut kernel = Kernel::new();
        kernel.entry("a::kernels::fast_x", |_| {});
        kernel.entry("b::kernels::fast_x", |_| {});
        let doubles = entries(&mut kernel.module(), |_| true);
        assert_eq!(doubles, Err(Error::DuplicateEntry("fast_x".to_owned())));
    }
}
