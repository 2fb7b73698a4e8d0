//! Protected functions: `#[inline(never)]` in the source, `DontInline` in the module.
//!
//! The mark keeps the compiler from mixing a function's arithmetic with its caller's, and tells the
//! other passes where arithmetic must be done as written. Once they have run, drivers may inline.

use rspirv::dr::{Function, Module, Operand};
use rspirv::spirv::FunctionControl;

use super::names::Names;
use crate::{Error, Result};

/// Is the function marked?
pub fn is_protected(function: &Function) -> bool {
    function
        .def
        .as_ref()
        .is_some_and(|def| def.operands[0].unwrap_function_control().contains(FunctionControl::DONT_INLINE))
}

/// Removes the marks; returns the names of the functions that had one, in order.
pub fn release(module: &mut Module) -> Vec<String> {
    let names = Names::of(module);
    let marked = module.functions.iter().filter(|f| is_protected(f));
    let mut protected: Vec<String> = marked.map(|f| names.function(f)).collect();
    protected.sort();
    for function in &mut module.functions {
        if let Some(def) = &mut function.def {
            def.operands[0] = Operand::FunctionControl(FunctionControl::NONE);
        }
    }
    protected
}

/// Fails unless each of `wanted`, the end of a path, is among the protected functions. Their names
/// may end in generic arguments.
pub fn require(protected: &[String], wanted: &[&'static str]) -> Result<()> {
    let path = |name: &str| name.split("::<").next().unwrap_or(name).to_owned();
    let is_there = |end: &str| {
        protected.iter().map(|name| path(name)).any(|path| {
            let rest = path.strip_suffix(end);
            rest.is_some_and(|rest| rest.is_empty() || rest.ends_with("::"))
        })
    };
    match wanted.iter().find(|end| !is_there(end)) {
        Some(end) => Err(Error::Unprotected(end)),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eyerays_passes::testing::Kernel;

    #[test]
    fn releases_and_names() {
        let mut kernel = Kernel::new();
        let function = kernel.protected(|_| {});
        kernel.entry("exact_a", |b| b.call(function));
        let mut module = kernel.module();
        assert_eq!(release(&mut module), [format!("%{function}")]);
        assert!(!module.functions.iter().any(is_protected));
    }

    #[test]
    fn requires_whole_segments() {
        let protected = ["a::real::soft::div".into(), "a::edge_on::<f32>".into()];
        assert!(require(&protected, &["soft::div", "edge_on"]).is_ok());
        assert!(require(&protected, &["oft::div"]).is_err());
        assert!(require(&protected, &["soft"]).is_err());
    }
}
