//! The kernels as one module, fresh from the compiler.

use std::path::Path;

use spirv_builder::{Capability, ShaderPanicStrategy, SpirvBuilder, SpirvMetadata};

use crate::compiler::Compiler;
use crate::error::one_line;
use crate::table::Policy;
use crate::{Error, Result};

/// The Vulkan version whose SPIR-V is written.
pub const TARGET: &str = "spirv-unknown-vulkan1.2";

/// Declared while compiling only. The code generator runs `spirv-opt`, which folds float
/// arithmetic ((a - b) + b becomes a, a * b + a * c becomes a * (b + c), x / 3 becomes x * 0.333)
/// unless a float-controls capability is present; `NoContraction` comes too late to prevent that.
pub const FLOATS_AS_WRITTEN: Capability = Capability::SignedZeroInfNanPreserve;

/// The device's scope is for atomics; `pass::memory` drops what only the Vulkan memory model knows.
const CAPABILITIES: [Capability; 6] = [
    Capability::GroupNonUniform,
    Capability::GroupNonUniformVote,
    Capability::GroupNonUniformBallot,
    Capability::GroupNonUniformArithmetic,
    Capability::VulkanMemoryModelDeviceScope,
    FLOATS_AS_WRITTEN,
];

/// What the code generator reads from the environment beside its arguments.
const FORBIDDEN_VARIABLES: [&str; 3] = ["RUSTGPU_CODEGEN_ARGS", "RUSTGPU_RUSTFLAGS", "RUSTGPU_CARGOFLAGS"];

/// Compiles the kernels of a policy, of the crate at `shader`; the words hold every entry point and all debug names.
pub fn compile(compiler: &Compiler, shader: &Path, policy: Policy) -> Result<Vec<u32>> {
    for name in FORBIDDEN_VARIABLES {
        if std::env::var_os(name).is_some() {
            return Err(Error::Environment(name));
        }
    }
    let mut builder = SpirvBuilder::new(shader, TARGET);
    builder.rustc_codegen_spirv_location = Some(compiler.codegen.clone());
    builder.toolchain_overwrite = Some(compiler.toolchain.clone());
    builder.shader_crate_features.default_features = false;
    builder.shader_crate_features.features = vec![policy.feature().into()];
    // Cargo lets one compiler at a time into a folder.
    builder.target_dir_path = Some(format!("spirv-builder/{}", policy.feature()).into());
    builder.capabilities = CAPABILITIES.to_vec();
    builder.shader_panic_strategy = ShaderPanicStrategy::SilentExit;
    // Names make messages readable, whatever the profile says of debug information.
    builder.spirv_metadata = SpirvMetadata::Full;
    let failed = |e: &dyn std::fmt::Display| Error::Compile(one_line(&e.to_string()));
    let result = builder.build().map_err(|e| failed(&e))?;
    let path = result.module.unwrap_single();
    let bytes = std::fs::read(path).map_err(Error::file("read", path))?;
    words(&bytes)
}

/// The words of a module's file.
pub fn words(bytes: &[u8]) -> Result<Vec<u32>> {
    let (words, rest) = bytes.as_chunks::<4>();
    if !rest.is_empty() {
        return Err(Error::Malformed("a file of broken words".into()));
    }
    Ok(words.iter().map(|word| u32::from_le_bytes(*word)).collect())
}

/// The bytes of a module's file.
pub fn bytes(words: &[u32]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}
