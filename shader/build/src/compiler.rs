//! The rust-gpu compiler: a rustup toolchain and the code generator that fits it.

use std::path::{Path, PathBuf};
use std::process::Command;

use cargo_gpu_install::install::Install;
use sha2::{Digest, Sha256};

use crate::error::one_line;
use crate::{Error, Result};

/// The toolchain that a code generator is run with when only the generator is named.
pub const DEFAULT_TOOLCHAIN: &str = "rust-gpu";

/// A compiler that is present.
#[derive(Clone, Debug)]
pub struct Compiler {
    /// Name of the rustup toolchain.
    pub toolchain: String,
    /// Path of `rustc_codegen_spirv`.
    pub codegen: PathBuf,
}

impl Compiler {
    /// The compiler that the arguments name; with none, rust-gpu's own, installed first if need be.
    pub fn resolve(toolchain: Option<String>, codegen: Option<PathBuf>, shader: &Path) -> Result<Self> {
        if toolchain.is_none() && codegen.is_none() {
            return Self::install(shader);
        }
        Self::find(toolchain, codegen)
    }

    /// The compiler that the arguments name, which must be installed. A toolchain may carry its
    /// code generator in `lib/rust-gpu`.
    pub fn find(toolchain: Option<String>, codegen: Option<PathBuf>) -> Result<Self> {
        let toolchain = toolchain.unwrap_or_else(|| DEFAULT_TOOLCHAIN.into());
        let sysroot = rustc(&toolchain, &["--print", "sysroot"])?;
        let codegen = match codegen {
            Some(path) => path,
            None => Path::new(&sysroot).join("lib/rust-gpu").join(library()),
        };
        if !codegen.is_file() {
            let path = codegen.display();
            return Err(Error::Compiler(format!("no code generator at {path}")));
        }
        Ok(Compiler { toolchain, codegen })
    }

    /// rust-gpu's own toolchain and code generator for the `spirv-std` that `shader` locks.
    fn install(shader: &Path) -> Result<Self> {
        let installed = Install::from_shader_crate(shader.to_owned()).run().map_err(|e| {
            // The output of rustup that follows has been shown already.
            let text = format!("{e:#}");
            let cause = one_line(text.split("-- stdout").next().unwrap_or_default());
            Error::Compiler(format!("its installation failed ({cause})"))
        })?;
        Ok(Compiler { toolchain: installed.toolchain_channel, codegen: installed.rustc_codegen_spirv_location })
    }

    /// The first line of `rustc -V`.
    pub fn version(&self) -> Result<String> {
        rustc(&self.toolchain, &["-V"])
    }

    /// SHA-256 of the code generator's file.
    pub fn codegen_hash(&self) -> Result<String> {
        let bytes = std::fs::read(&self.codegen).map_err(Error::file("read", &self.codegen))?;
        Ok(hex(&bytes))
    }
}

/// SHA-256 of `bytes` in hexadecimal.
pub fn hex(bytes: &[u8]) -> String {
    let digest = Sha256::digest(bytes);
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn library() -> String {
    use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
    format!("{DLL_PREFIX}rustc_codegen_spirv{DLL_SUFFIX}")
}

fn rustc(toolchain: &str, arguments: &[&str]) -> Result<String> {
    // A cargo that was told its toolchain passes that on, and it would win over `+toolchain`.
    let output = Command::new("rustup")
        .args(["run", toolchain, "rustc"])
        .args(arguments)
        .env_remove("RUSTUP_TOOLCHAIN")
        .env_remove("RUSTC")
        .output()
        .map_err(|e| Error::Compiler(format!("rustup does not start ({e})")))?;
    let text = String::from_utf8_lossy(&output.stdout);
    match text.lines().next() {
        Some(line) if output.status.success() => Ok(line.to_owned()),
        _ => Err(Error::Compiler(format!("rustup has no working toolchain `{toolchain}`"))),
    }
}
