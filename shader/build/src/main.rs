//! Compiles the kernels and writes or checks `shader/spirv`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use eyerays_spirv::compiler::Compiler;
use eyerays_spirv::modules::{Build, build};
use eyerays_spirv::validate::Validation;
use eyerays_spirv::{Result, output, source};

/// Compiles the kernels to the SPIR-V modules in shader/spirv.
///
/// Without a toolchain and a code generator, rust-gpu's own are installed first.
#[derive(Parser)]
#[command(version)]
struct Arguments {
    /// The rustup toolchain that runs the code generator.
    #[arg(long, env = "EYERAYS_SPIRV_TOOLCHAIN", value_name = "NAME")]
    toolchain: Option<String>,
    /// The code generator, `rustc_codegen_spirv`; by default lib/rust-gpu of the toolchain.
    #[arg(long, env = "EYERAYS_SPIRV_CODEGEN", value_name = "PATH")]
    codegen: Option<PathBuf>,
    /// Compare with the committed modules; write nothing.
    #[arg(long)]
    check: bool,
}

fn main() -> ExitCode {
    match run(Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: Arguments) -> Result<()> {
    let shader = source::shader();
    let compiler = Compiler::resolve(arguments.toolchain, arguments.codegen, &shader)?;
    let build = build(&compiler, &shader)?;
    if arguments.check {
        output::check(&source::spirv(), &build)?;
    } else {
        output::write(&source::spirv(), &build)?;
    }
    report(&build);
    Ok(())
}

fn report(build: &Build) {
    for module in &build.manifest.modules {
        let (entries, bytes) = (module.entries.len(), module.bytes);
        println!("{}: {entries} entry points, {bytes} bytes", module.file);
    }
    if build.validation == Validation::Skipped {
        println!("note: not validated, since spirv-val is not on the PATH");
    }
}
