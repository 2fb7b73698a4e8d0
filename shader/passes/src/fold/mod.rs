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

use rspirv::dr::Module;

use crate::dead;

/// Folds until nothing more follows, joins the blocks that then follow one another, and removes what is dead.
pub fn fold(module: &mut Module) {
    while value::fold(module) | branch::fold(module) {}
    join::join(module);
    flatten::flatten(module);
    dead::remove(module);
}

#[cfg(test)]
mod tests;
