//! The entry points of one module.

use rspirv::dr::{Module, Operand};

use crate::{Error, Result};

/// Keeps the entry points whose name begins with `prefix`, in order of their names. The compiler
/// names them by path; only the last segment stays.
pub fn entries(module: &mut Module, prefix: &'static str) -> Result<()> {
    module.entry_points.retain_mut(|entry| {
        let path = entry.operands[2].unwrap_literal_string();
        let name = path.rsplit("::").next().unwrap_or(path).to_owned();
        let keep = name.starts_with(prefix);
        entry.operands[2] = Operand::LiteralString(name);
        keep
    });
    if module.entry_points.is_empty() {
        return Err(Error::NoEntry(prefix));
    }
    let name = |entry: &rspirv::dr::Instruction| entry.operands[2].unwrap_literal_string().to_owned();
    module.entry_points.sort_by_key(name);
    match module.entry_points.windows(2).find(|pair| name(&pair[0]) == name(&pair[1])) {
        Some(pair) => Err(Error::DuplicateEntry(name(&pair[0]))),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pass::testing::Kernel;

    #[test]
    fn keeps_prefix_and_last_segment() {
        let mut kernel = Kernel::new();
        kernel.entry("entry::exact_b", |_| {});
        kernel.entry("entry::fast_a", |_| {});
        kernel.entry("entry::exact_a", |_| {});
        let mut module = kernel.module();
        entries(&mut module, "exact_").unwrap();
        let names: Vec<_> = module.entry_points.iter().map(|entry| entry.operands[2].unwrap_literal_string()).collect();
        assert_eq!(names, ["exact_a", "exact_b"]);
    }

    #[test]
    fn refuses_none_and_doubles() {
        let mut kernel = Kernel::new();
        kernel.entry("a::fast_x", |_| {});
        kernel.entry("b::fast_x", |_| {});
        let mut module = kernel.module();
        assert!(matches!(entries(&mut module.clone(), "exact_"), Err(Error::NoEntry("exact_"))));
        assert!(matches!(
            entries(&mut module, "fast_"),
            Err(Error::DuplicateEntry(name)) if name == "fast_x"
        ));
    }
}
