//! What the modules are made from, as one hash.

use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use crate::{Error, Result};

/// Dependencies whose code ends up in the modules.
const DEPENDENCIES: [&str; 3] = ["bytemuck", "glam", "spirv-std"];

/// The directory of the kernels' crate. What cargo says at run time goes first: builds of several
/// checkouts that share a target directory share binaries.
pub fn shader() -> PathBuf {
    let here = match std::env::var_os("CARGO_MANIFEST_DIR") {
        Some(here) => PathBuf::from(here),
        None => PathBuf::from(env!("CARGO_MANIFEST_DIR")),
    };
    here.parent().unwrap_or(&here).to_owned()
}

/// The directory of the committed modules.
pub fn spirv() -> PathBuf {
    shader().join("spirv")
}

/// SHA-256 over the sources of the kernels, of the passes and of this crate, their manifest, and the locked
/// versions of what they depend on. Line endings do not count; the order and the names of files do.
pub fn hash(shader: &Path) -> Result<String> {
    let mut files = vec![shader.join("Cargo.toml")];
    for folder in ["src", "build/src", "passes/src"] {
        collect(&shader.join(folder), &mut files)?;
    }
    let mut named: Vec<(String, PathBuf)> = files.into_iter().map(|path| (relative(&path, shader), path)).collect();
    named.sort();
    let mut digest = Sha256::new();
    for (name, path) in named {
        let bytes = std::fs::read(&path).map_err(Error::file("read", &path))?;
        field(&mut digest, name.as_bytes());
        field(&mut digest, &unix_lines(&bytes));
    }
    for name in DEPENDENCIES {
        field(&mut digest, name.as_bytes());
        field(&mut digest, locked(shader, name)?.as_bytes());
    }
    let digest = digest.finalize();
    Ok(digest.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// The version of `dependency` that the kernels' crate is locked to.
pub fn locked(shader: &Path, dependency: &str) -> Result<String> {
    let path = lock_file(shader)?;
    let text = std::fs::read_to_string(&path).map_err(Error::file("read", &path))?;
    let lock: toml::Table = toml::from_str(&text).map_err(|e| Error::record(&path, e))?;
    find_version(&lock, dependency)
        .ok_or_else(|| Error::record(&path, format!("the kernels do not depend on {dependency}")))
}

/// A dependency reads `name`, or `name version` where the lock file holds several.
fn find_version(lock: &toml::Table, dependency: &str) -> Option<String> {
    let packages = lock.get("package")?.as_array()?;
    let named = |name: &str| {
        let name = name.to_owned();
        move |package: &&toml::Value| package.get("name").and_then(|n| n.as_str()) == Some(&name)
    };
    let kernels = packages.iter().find(named("eyerays-shader"))?;
    let entry = kernels
        .get("dependencies")?
        .as_array()?
        .iter()
        .filter_map(|entry| entry.as_str())
        .find(|entry| entry.split(' ').next() == Some(dependency))?;
    match entry.split(' ').nth(1) {
        Some(version) => Some(version.to_owned()),
        None => {
            let package = packages.iter().find(named(dependency))?;
            Some(package.get("version")?.as_str()?.to_owned())
        }
    }
}

fn lock_file(shader: &Path) -> Result<PathBuf> {
    shader
        .ancestors()
        .map(|directory| directory.join("Cargo.lock"))
        .find(|path| path.is_file())
        .ok_or_else(|| Error::record(shader, "no Cargo.lock above; run cargo generate-lockfile"))
}

fn collect(directory: &Path, files: &mut Vec<PathBuf>) -> Result<()> {
    let fail = |e| Error::file("read", directory)(e);
    for entry in std::fs::read_dir(directory).map_err(fail)? {
        let path = entry.map_err(fail)?.path();
        if path.is_dir() {
            collect(&path, files)?;
        } else {
            files.push(path);
        }
    }
    Ok(())
}

fn relative(path: &Path, root: &Path) -> String {
    let path = path.strip_prefix(root).unwrap_or(path);
    let parts: Vec<_> = path.iter().map(|part| part.to_string_lossy()).collect();
    parts.join("/")
}

fn unix_lines(bytes: &[u8]) -> Vec<u8> {
    let mut unix = Vec::with_capacity(bytes.len());
    for (index, byte) in bytes.iter().enumerate() {
        if *byte != b'\r' || bytes.get(index + 1) != Some(&b'\n') {
            unix.push(*byte);
        }
    }
    unix
}

/// The length keeps two fields from running into one another.
fn field(digest: &mut Sha256, bytes: &[u8]) {
    digest.update((bytes.len() as u64).to_le_bytes());
    digest.update(bytes);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn line_endings_do_not_count() {
        assert_eq!(unix_lines(b"a\r\nb\rc\n\r"), b"a\nb\rc\n\r");
    }

    #[test]
    fn versions_of_the_kernels_win() {
        let lock = toml::from_str(
            "[[package]]\nname = 'glam'\nversion = '2.0.0'\n\
             [[package]]\nname = 'glam'\nversion = '1.0.0'\n\
             [[package]]\nname = 'bytemuck'\nversion = '3.0.0'\n\
             [[package]]\nname = 'eyerays-shader'\nversion = '0.1.0'\n\
             dependencies = ['bytemuck', 'glam 1.0.0']\n",
        )
        .unwrap();
        let version = |name| find_version(&lock, name);
        assert_eq!(version("glam").as_deref(), Some("1.0.0"));
        assert_eq!(version("bytemuck").as_deref(), Some("3.0.0"));
        assert_eq!(version("spirv-std"), None);
    }

    #[test]
    fn hashes_this_repository() {
        let hash = hash(&shader()).unwrap();
        assert_eq!(hash.len(), 64);
    }
}
