//! `shader/spirv/manifest.toml`: what the committed modules hold and what they were made from.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::{Error, Result};

/// The manifest's name within `shader/spirv`.
pub const FILE: &str = "manifest.toml";
/// The version of the records below.
pub const FORMAT: u32 = 1;

const HEADER: &str = "# Written by `cargo run -p eyerays-spirv --release`; do not edit.\n\n";

/// The whole file.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// [`FORMAT`] at the time of writing.
    pub format: u32,
    /// [`crate::source::hash`] of what the modules were made from.
    pub source: String,
    /// What made them.
    pub toolchain: Toolchain,
    /// The modules, in the order of [`crate::table::MODULES`].
    #[serde(rename = "module")]
    pub modules: Vec<Module>,
}

/// A compiler, by its versions.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Toolchain {
    /// What `rustc -V` says.
    pub rustc: String,
    /// Version of `spirv-std`, and so of rust-gpu.
    pub spirv_std: String,
    /// SHA-256 of the code generator's file: the same generator writes the same bytes.
    pub codegen: String,
}

/// One committed file.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Module {
    /// Name of the module.
    pub name: String,
    /// Its file beside the manifest.
    pub file: String,
    /// SHA-256 of the file.
    pub sha256: String,
    /// Size of the file.
    pub bytes: usize,
    /// The capabilities that it declares.
    pub capabilities: Vec<String>,
    /// Functions whose arithmetic is done as written even in a fast module.
    pub protected: Vec<String>,
    /// Constants that the host may overwrite.
    #[serde(rename = "constant", default)]
    pub constants: Vec<Constant>,
    /// Entry points, by name.
    #[serde(rename = "entry")]
    pub entries: Vec<Entry>,
}

/// An entry point.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// Its name in the module.
    pub name: String,
    /// Lanes of a workgroup.
    pub workgroup: [u32; 3],
    /// Does it vote, or read the subgroup's size?
    pub subgroup: bool,
    /// Bindings of the storage buffers that it only reads.
    pub reads: Vec<u32>,
    /// Bindings of the storage buffers that it may write.
    pub writes: Vec<u32>,
    /// Bindings of uniform buffers.
    pub uniforms: Vec<u32>,
}

/// A specialisation constant; a boolean counts as 0 or 1.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Constant {
    /// Its `SpecId`.
    pub id: u32,
    /// Its name in the source.
    pub name: String,
    /// Its value unless overwritten.
    pub default: u32,
}

impl Manifest {
    /// Reads the manifest of `directory`.
    pub fn read(directory: &Path) -> Result<Self> {
        let path = directory.join(FILE);
        let text = std::fs::read_to_string(&path).map_err(Error::file("read", &path))?;
        let manifest: Manifest = toml::from_str(&text).map_err(|e| Error::record(&path, e))?;
        if manifest.format != FORMAT {
            let problem = format!("format {} is not {FORMAT}", manifest.format);
            return Err(Error::record(&path, problem));
        }
        Ok(manifest)
    }

    /// The text of the file.
    pub fn text(&self) -> Result<String> {
        let body = toml::to_string(self).map_err(|e| Error::record(Path::new(FILE), e))?;
        Ok(format!("{HEADER}{body}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn survives_a_round_trip() {
        let manifest = Manifest {
            format: FORMAT,
            source: "0".into(),
            toolchain: Toolchain { rustc: "rustc 1".into(), spirv_std: "0.10.0".into(), codegen: "1".into() },
            modules: vec![Module {
                name: "exact".into(),
                file: "exact.spv".into(),
                sha256: "2".into(),
                bytes: 3,
                capabilities: vec!["Shader".into()],
                protected: vec![],
                constants: vec![Constant { id: 1, name: "flags".into(), default: 0 }],
                entries: vec![Entry {
                    name: "exact_a".into(),
                    workgroup: [32, 1, 1],
                    subgroup: true,
                    reads: vec![0],
                    writes: vec![1, 2],
                    uniforms: vec![],
                }],
            }],
        };
        let text = manifest.text().unwrap();
        assert_eq!(toml::from_str::<Manifest>(&text).unwrap(), manifest);
    }
}
