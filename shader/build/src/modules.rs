//! The committed modules, made from the sources.

use std::path::Path;
use std::time::Instant;

use crate::compiler::{Compiler, hex};
use crate::manifest::{self, FORMAT, Manifest, Toolchain};
use crate::table::{MODULES, Module, Policy};
use crate::validate::Validation;
use crate::{Error, Result, compile, pass, reflect, source, validate};

/// The most bytes that all modules may hold.
pub const SIZE_LIMIT: usize = 12 << 20;

/// A fresh build.
#[derive(Clone, Debug)]
pub struct Build {
    /// The record of the build.
    pub manifest: Manifest,
    /// The files by name.
    pub files: Vec<(String, Vec<u8>)>,
    /// Were the modules validated?
    pub validation: Validation,
}

/// Compiles the crate at `shader` and makes every module of the table.
pub fn build(compiler: &Compiler, shader: &Path) -> Result<Build> {
    // Hashed first: a source that changes meanwhile makes the modules stale, not wrong.
    let source = source::hash(shader)?;
    let toolchain = Toolchain {
        rustc: compiler.version()?,
        spirv_std: source::locked(shader, "spirv-std")?,
        codegen: compiler.codegen_hash()?,
    };
    let (exact, fast) = std::thread::scope(|scope| {
        let compile = |policy| timed(policy, || compile::compile(compiler, shader, policy));
        let fast = scope.spawn(move || compile(Policy::Fast));
        (compile(Policy::Exact), fast.join().expect("it does not panic"))
    });
    let (exact, fast) = (exact?, fast?);
    let mut build = Build {
        manifest: Manifest { format: FORMAT, source, toolchain, modules: Vec::new() },
        files: Vec::new(),
        validation: Validation::Passed,
    };
    for module in &MODULES {
        let words = if module.policy == Policy::Exact { &exact } else { &fast };
        build.add(module, words)?;
    }
    build.check_size()?;
    Ok(build)
}

/// Says how long the compiler takes.
fn timed<T>(policy: Policy, compile: impl FnOnce() -> T) -> T {
    let (start, name) = (Instant::now(), policy.feature());
    eprintln!("compiling {name} precision, which takes some minutes");
    let compiled = compile();
    eprintln!("compiled {name} precision in {:.0} s", start.elapsed().as_secs_f32());
    compiled
}

impl Build {
    fn add(&mut self, module: &Module, words: &[u32]) -> Result<()> {
        let finished = pass::finish(words, module)?;
        let bytes = compile::bytes(&finished.words());
        if validate::run(module.name, &bytes)? == Validation::Skipped {
            self.validation = Validation::Skipped;
        }
        self.manifest.modules.push(manifest::Module {
            name: module.name.into(),
            file: module.file(),
            sha256: hex(&bytes),
            bytes: bytes.len(),
            capabilities: reflect::capabilities(&finished.module),
            constants: reflect::constants(&finished.module),
            entries: reflect::entries(&finished.module)?,
            protected: finished.protected,
        });
        self.files.push((module.file(), bytes));
        Ok(())
    }

    fn check_size(&self) -> Result<()> {
        let bytes = self.files.iter().map(|(_, bytes)| bytes.len()).sum();
        if bytes > SIZE_LIMIT {
            let limit = SIZE_LIMIT;
            return Err(Error::TooLarge { bytes, limit });
        }
        Ok(())
    }
}
