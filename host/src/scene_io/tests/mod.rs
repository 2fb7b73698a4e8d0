//! Tests of loading: what must be refused, and what must come out right.

mod bump;
mod curves;
mod displace;
mod effect;
mod finish;
mod gltf;
mod hostile;
mod medium;
mod mesh;
mod mtl;
mod obj;
mod object;
mod ply;
mod round;
mod shipped;
mod spectrum;
mod subdivide;
mod textures;
mod toml;

use std::fs;
use std::path::PathBuf;

use tempfile::TempDir;

use super::Warning;
use super::budget::Budget;
use crate::error::{Error, Result};
use crate::memory::Room;
use crate::scene::Scene;

/// A folder of files that is gone after the test.
pub struct Folder(TempDir);

impl Folder {
    pub fn new(files: &[(&str, &[u8])]) -> Self {
        let folder = Folder(tempfile::tempdir().unwrap());
        for (name, content) in files {
            fs::write(folder.path(name), content).unwrap();
        }
        folder
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn load(&self, name: &str) -> Result<(Scene, Vec<String>)> {
        super::load(&self.path(name)).map(|(scene, warnings)| (scene, said(&warnings)))
    }

    /// The error of a scene that must be refused.
    pub fn refuse(&self, name: &str) -> Error {
        let error = self.load(name).expect_err("accepted");
        assert!(!error.to_string().contains('\n'), "{error}");
        error
    }
}

/// Memory for so many bytes of a scene.
pub fn budget(bytes: u64) -> Budget {
    Budget::new(Room { bytes, limit: "the test" })
}

/// Asserts where and why a file is refused.
pub fn assert_refused(error: &Error, file: &str, line: Option<usize>, why: &str) {
    let (path, of_line) = error.place().unwrap_or_else(|| panic!("no file: {error}"));
    assert_eq!(path.file_name(), Some(file.as_ref()), "{error}");
    assert_eq!(of_line, line, "{error}");
    assert!(error.message().contains(why), "{error}, wanted: {why}");
}

/// One triangle.
pub const TRIANGLE: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// Warnings as users see them.
pub fn said(warnings: &[Warning]) -> Vec<String> {
    warnings.iter().map(Warning::to_string).collect()
}

/// The one warning of what is read.
fn warning(warnings: &[String]) -> &str {
    let [warning] = warnings else { panic!("{warnings:?}") };
    warning
}
