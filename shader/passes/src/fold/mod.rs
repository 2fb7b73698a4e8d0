//! What constants decide: values that follow from them, branches that are always or never taken, and the code behind these.
//!
//! Only integers and conditions are computed. Floats stay as they are: a host's rounding is not the device's.

mod blocks;
mod branch;
mod composite;
mod constants;
mod evaluate;
mod flatten;
mod join;
mod value;

use composite::Globals;
use constants::Constants;
use rspirv::dr::Module;

use crate::dead;

/// Folds until nothing more follows, joins the blocks that then follow one another, and removes what is dead.
pub fn fold(module: &mut Module) {
    let mut functions = std::mem::take(&mut module.functions);
    let (mut constants, globals) = (Constants::of(module), Globals::of(module));
    // One after the other: a function has no values of another.
    for function in &mut functions {
        while value::fold(function, &mut constants, &globals) | branch::fold(function, &mut constants) {}
    }
    constants.finish(module);
    module.functions = functions;
    join::join(module);
    flatten::flatten(module);
    dead::remove(module);
}

#[cfg(test)]
mod tests;
