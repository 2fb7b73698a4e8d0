//! The committed SPIR-V modules, embedded so that an installed program carries its kernels.

/// Exact arithmetic, kernels `exact::*`, and `subgroup_exact::*` of methods that vote across a subgroup. Every float instruction
/// forbids contraction.
pub const EXACT: &[u8] = include_bytes!("../spirv/exact.spv");
/// Arithmetic at the device's own speed, kernels `fast::*` and `subgroup_fast::*`.
pub const FAST: &[u8] = include_bytes!("../spirv/fast.spv");
/// The kernel `numerics::evaluate`: what exact arithmetic is built from, see [`crate::numerics`].
pub const NUMERICS: &[u8] = include_bytes!("../spirv/numerics.spv");
