//! Cuts single kernels out of a SPIR-V module: one entry point, its constants written in and folded, and nothing that
//! it does not reach. The build of the committed modules uses the same passes.
//!
//! Modules must be valid, as `spirv-val` has it: the passes may panic on others.
//!
//! A module holds the entry points of many kernels, each compiled for every effect. What a driver compiles takes time by
//! the size of what it is given, so it is given [`Kernel`]s.

pub mod bindings;
pub mod body;
pub mod capability;
pub mod dead;
pub mod error;
pub mod fold;
pub mod kernel;
pub mod reach;
pub mod renumber;
pub mod select;
pub mod slice;
pub mod specialise;
#[cfg(feature = "testing")]
pub mod testing;

pub use error::{Error, Result};
pub use kernel::{Kernel, Kernels};
