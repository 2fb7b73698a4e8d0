//! The directory of the committed modules.

use std::path::Path;

use crate::manifest::{self, Manifest};
use crate::modules::Build;
use crate::{Error, Result};

/// What makes the modules anew.
pub const COMMAND: &str = "cargo run -p eyerays-spirv --release";

/// Writes a build to `directory`, the manifest last. Each file appears whole or not at all.
pub fn write(directory: &Path, build: &Build) -> Result<()> {
    std::fs::create_dir_all(directory).map_err(Error::file("create", directory))?;
    for (name, bytes) in &build.files {
        replace(directory, name, bytes)?;
    }
    replace(directory, manifest::FILE, build.manifest.text()?.as_bytes())
}

/// Fails on the first file in `directory` that differs from a build. The toolchain's record may
/// differ, since another machine's generator can write the same modules.
pub fn check(directory: &Path, build: &Build) -> Result<()> {
    for (name, bytes) in &build.files {
        let path = directory.join(name);
        let committed = std::fs::read(&path).map_err(Error::file("read", &path))?;
        if committed != *bytes {
            return Err(Error::Stale(path));
        }
    }
    let mut committed = Manifest::read(directory)?;
    committed.toolchain = build.manifest.toolchain.clone();
    if committed != build.manifest {
        return Err(Error::Stale(directory.join(manifest::FILE)));
    }
    Ok(())
}

fn replace(directory: &Path, name: &str, bytes: &[u8]) -> Result<()> {
    let path = directory.join(name);
    let temporary = directory.join(format!("{name}.{}.tmp", std::process::id()));
    std::fs::write(&temporary, bytes).map_err(Error::file("write", &temporary))?;
    std::fs::rename(&temporary, &path).map_err(Error::file("replace", &path))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::manifest::{FORMAT, Toolchain};
    use crate::validate::Validation;

    fn build(bytes: &[u8], codegen: &str) -> Build {
        Build {
            manifest: Manifest {
                format: FORMAT,
                source: "0".into(),
                toolchain: Toolchain { rustc: "rustc 1".into(), spirv_std: "0.10.0".into(), codegen: codegen.into() },
                modules: Vec::new(),
            },
            files: vec![("exact.spv".into(), bytes.to_vec())],
            validation: Validation::Passed,
        }
    }

    #[test]
    fn what_is_written_is_fresh() {
        let name = format!("eyerays-spirv-{}", std::process::id());
        let directory = std::env::temp_dir().join(name);
        write(&directory, &build(b"old", "a")).unwrap();
        write(&directory, &build(b"new", "a")).unwrap();
        assert!(check(&directory, &build(b"new", "b")).is_ok());
        let stale = check(&directory, &build(b"other", "a"));
        assert!(matches!(stale, Err(Error::Stale(path)) if path.ends_with("exact.spv")));
        let files = std::fs::read_dir(&directory).unwrap().count();
        assert_eq!(files, 2, "temporary files stay behind");
        std::fs::remove_dir_all(&directory).unwrap();
    }
}
