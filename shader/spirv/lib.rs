//! The committed SPIR-V modules, embedded so that an installed program carries its kernels. Apart from their sources, whose native
//! code need not be built anew when a module is.

/// Exact arithmetic, kernels `exact::*`, and `subgroup_exact::*` of methods that vote across a subgroup. Every float instruction
/// forbids contraction.
pub const EXACT: &[u8] = include_bytes!("exact.spv");
/// Arithmetic at the device's own speed, kernels `fast::*` and `subgroup_fast::*`.
pub const FAST: &[u8] = include_bytes!("fast.spv");
/// The kernel `numerics::evaluate`: what exact arithmetic is built from, see `numerics` of the kernels' own crate.
pub const NUMERICS: &[u8] = include_bytes!("numerics.spv");
