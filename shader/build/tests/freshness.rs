//! Are the committed modules what the sources give?

use std::path::PathBuf;

use eyerays_spirv::compiler::Compiler;
use eyerays_spirv::manifest::Manifest;
use eyerays_spirv::{modules, output, source};

fn manifest() -> Manifest {
    let command = output::COMMAND;
    Manifest::read(&source::spirv()).unwrap_or_else(|error| panic!("{error}; run: {command}"))
}

#[test]
fn sources_have_not_changed() {
    let (command, manifest) = (output::COMMAND, manifest());
    let hash = source::hash(&source::shader()).unwrap();
    assert!(manifest.source == hash, "shader/spirv is older than the sources; run: {command}");
}

#[test]
fn committed_files_are_whole() {
    let directory = source::spirv();
    for module in manifest().modules {
        let bytes = std::fs::read(directory.join(&module.file)).unwrap();
        let hash = eyerays_spirv::compiler::hex(&bytes);
        assert_eq!(hash, module.sha256, "{}", module.file);
    }
}

/// Other generators may write other bytes, so only the manifest's own decides.
#[test]
fn the_same_compiler_gives_the_same_bytes() {
    let (directory, manifest) = (source::spirv(), manifest());
    let compiler = Compiler::find(
        std::env::var("EYERAYS_SPIRV_TOOLCHAIN").ok(),
        std::env::var_os("EYERAYS_SPIRV_CODEGEN").map(PathBuf::from),
    );
    let compiler = match compiler {
        Ok(compiler) if compiler.codegen_hash().unwrap() == manifest.toolchain.codegen => compiler,
        Ok(_) => return eprintln!("skipped: the compiler present is not the manifest's"),
        Err(error) => return eprintln!("skipped: {error}"),
    };
    modules::build(&compiler, &source::shader())
        .and_then(|build| output::check(&directory, &build))
        .unwrap_or_else(|error| panic!("{error}"));
}
