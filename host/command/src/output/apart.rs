//! Outputs that would replace what is still needed.

use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

use super::Destination;
use crate::error::{Error, Result};

/// What the JSON of a binary glTF begins with where a command of ours wrote it, but for the command's name.
const GENERATOR: &str = r#"{"asset":{"generator":""#;
/// The bytes in front of the JSON of a binary glTF.
const GLTF_HEAD: usize = 20;

/// Refuses an output that is a file which the command reads, and two outputs that are one file, however their paths are
/// spelled and through links.
///
/// # Errors
/// One that names both.
pub fn check_apart(outputs: &[Destination], inputs: impl IntoIterator<Item = impl AsRef<Path>>) -> Result<()> {
    let files = || outputs.iter().filter_map(Destination::file);
    for input in inputs {
        let input = input.as_ref();
        if let Some(output) = files().find(|output| is_same(output, input)) {
            let fault = format!("would replace the input {}; name another file", input.display());
            return Err(Error::file(output, fault));
        }
    }
    for (i, output) in files().enumerate() {
        if let Some(earlier) = files().take(i).find(|earlier| is_same(output, earlier)) {
            let fault = format!("is the same file as the output {}; name another one", earlier.display());
            return Err(Error::file(output, fault));
        }
    }
    Ok(())
}

/// Refuses to replace a file that does not begin with the comment of the command that writes such files, or as a binary
/// glTF with that command as its generator. `option` names the output.
///
/// # Errors
/// One that names the file.
pub fn check_own(path: &Path, command: &str, option: &str) -> Result<()> {
    let marks = [(0, "# "), (GLTF_HEAD, GENERATOR)];
    let own = marks.iter().any(|&(skipped, mark)| begins_with(path, skipped, &format!("{mark}{command}")));
    if path.is_file() && !own {
        let fault = format!("was not written by {command} and would be lost; move it, or give {option} another name");
        return Err(Error::file(path, fault));
    }
    Ok(())
}

/// Whether this stands in the file behind so many bytes.
fn begins_with(path: &Path, skipped: usize, mark: &str) -> bool {
    let mut start = vec![0; skipped + mark.len()];
    File::open(path).and_then(|mut file| file.read_exact(&mut start)).is_ok() && &start[skipped..] == mark.as_bytes()
}

fn is_same(a: &Path, b: &Path) -> bool {
    let is_special = |path| fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir());
    // A device holds nothing to be lost, and opening a pipe would wait.
    if is_special(a) || is_special(b) {
        return false;
    }
    // What is not there yet cannot be opened, but has a place.
    same_file::is_same_file(a, b).unwrap_or_else(|_| place(a).is_some_and(|a| Some(a) == place(b)))
}

/// The path without links and detours.
fn place(path: &Path) -> Option<PathBuf> {
    fs::canonicalize(path).ok().or_else(|| {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Some(fs::canonicalize(folder).ok()?.join(path.file_name()?))
    })
}
