//! Compiles the kernels to SPIR-V and turns the compiler's module into the committed ones.
//!
//! `shader/` is compiled once; [`table::MODULES`] says which modules are cut from the result and
//! what each promises; [`pass`] holds the rewrites and checks; [`manifest`] records what was made
//! from what, so that a test can tell a stale module.

pub mod compile;
pub mod compiler;
pub mod error;
pub mod manifest;
pub mod modules;
pub mod output;
pub mod pass;
pub mod reflect;
pub mod source;
pub mod table;
pub mod validate;

pub use error::{Error, Result};
