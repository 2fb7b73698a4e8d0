//! Protected functions: `#[inline(never)]` in the source, `DontInline` in the module.
//!
//! The mark keeps the compiler from mixing a function's arithmetic with its caller's, and tells the
//! other passes where arithmetic must be done as written. Once they have run, drivers may inline.

use rspirv::dr::{Function, Module, Operand};
use rspirv::spirv::FunctionControl;

use super::names::Names;

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
