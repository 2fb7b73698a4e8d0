//! Compresses the modules, which would be a quarter of a program otherwise.

use std::fs::{File, read, read_to_string};
use std::io::Write;
use std::path::Path;

use flate2::Compression;
use flate2::write::ZlibEncoder;

fn main() -> std::io::Result<()> {
    let output = std::env::var_os("OUT_DIR").expect("cargo sets it");
    for name in ["exact.spv", "fast.spv"] {
        println!("cargo::rerun-if-changed={name}");
        let file = File::create(Path::new(&output).join(name).with_extension("zlib"))?;
        let mut encoder = ZlibEncoder::new(file, Compression::best());
        encoder.write_all(&read(name)?)?;
        encoder.finish()?;
    }
    println!("cargo::rerun-if-changed=manifest.toml");
    let manifest = read_to_string("manifest.toml")?;
    let source = manifest.lines().find_map(|line| line.strip_prefix("source = ")).expect("the manifest has it");
    println!("cargo::rustc-env=EYERAYS_SOURCE={}", source.trim_matches('"'));
    Ok(())
}
