//! The committed SPIR-V modules, embedded so that an installed program carries its kernels.

/// Exact arithmetic, kernels `exact::*`. Every float instruction forbids contraction.
pub const EXACT: &[u8] = include_bytes!("../spirv/exact.spv");
/// Arithmetic at the device's own speed, kernels `fast::*`.
pub const FAST: &[u8] = include_bytes!("../spirv/fast.spv");
/// As [`EXACT`], methods that vote across a subgroup, kernels `subgroup_exact::*`.
pub const EXACT_SUBGROUP: &[u8] = include_bytes!("../spirv/exact_subgroup.spv");
/// As [`FAST`], methods that vote across a subgroup, kernels `subgroup_fast::*`.
pub const FAST_SUBGROUP: &[u8] = include_bytes!("../spirv/fast_subgroup.spv");
/// The kernel `numerics::evaluate`: what exact arithmetic is built from, see [`crate::numerics`].
pub const NUMERICS: &[u8] = include_bytes!("../spirv/numerics.spv");
