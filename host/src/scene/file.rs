//! Opening what a user named, and what a file names in turn.

use std::fs::{self, File};
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

use super::Unplaced;

/// The largest mesh file that is read, in bytes.
pub const MOST_MESH: u64 = 4 << 30;
/// The largest scene or material file that is read, in bytes.
pub const MOST_TEXT: u64 = 64 << 20;

/// Opens a regular file of 1 to `most` bytes. The error is a fault and its remedy, for the caller
/// to say whose line named the file.
///
/// The kind is asked for before the file is opened, since opening a pipe would wait for a writer.
pub fn open(path: &Path, most: u64) -> Unplaced<File> {
    let kind = fs::metadata(path).map_err(|error| explain(&error))?;
    if kind.is_dir() {
        return Err("this is a folder; name a file in it".into());
    }
    if !kind.is_file() {
        return Err("this is no regular file; copy its contents into one".into());
    }
    if kind.len() == 0 {
        return Err("the file is empty; was it written to the end?".into());
    }
    if kind.len() > most {
        return Err(format!("the file holds {} bytes and {most} is the most that is read; split it", kind.len()));
    }
    File::open(path).map_err(|error| explain(&error))
}

/// The bytes of a file that [`open`] accepts.
pub fn read(path: &Path, most: u64) -> Unplaced<Vec<u8>> {
    let mut bytes = Vec::new();
    open(path, most)?.take(most).read_to_end(&mut bytes).map_err(|error| explain(&error))?;
    Ok(bytes)
}

/// An operating system's error as a fault and a remedy.
pub fn explain(error: &std::io::Error) -> String {
    match error.kind() {
        ErrorKind::NotFound => "there is no such file; check the path".into(),
        ErrorKind::PermissionDenied => "no permission to read it; change its mode or owner".into(),
        _ => format!("it cannot be read: {error}"),
    }
}

/// The path of a file that another file names, inside that file's `folder`.
///
/// Meshes and materials come from strangers, so a name that [`downward`] refuses or that passes through a link to
/// the outside is refused.
pub fn inside(folder: &Path, name: &str) -> Unplaced<PathBuf> {
    let path = folder.join(downward(name)?);
    match (path.canonicalize(), real_folder(folder).canonicalize()) {
        (Ok(real), Ok(root)) if !real.starts_with(&root) => Err(outside(name)),
        // What does not exist cannot lead outside; opening it reports it.
        _ => Ok(path),
    }
}

/// A name with slashes between folders, for the backslashes that Windows writes. One that is absolute or climbs
/// with `..` is refused, even if it comes back.
pub fn downward(name: &str) -> Unplaced<String> {
    let slashed = name.replace('\\', "/");
    let drive = slashed.as_bytes().get(1) == Some(&b':');
    let step = |part: &str| match part {
        ".." => -1,
        "" | "." => 0,
        _ => 1,
    };
    let mut depths = slashed.split('/').scan(0, |depth, part| {
        *depth += step(part);
        Some(*depth)
    });
    if drive || slashed.starts_with('/') || depths.any(|depth| depth < 0) {
        return Err(outside(name));
    }
    if slashed.split('/').any(|part| part == "..") {
        return Err(format!("{name:?} goes back by \"..\"; name the file without it"));
    }
    Ok(slashed)
}

fn outside(name: &str) -> String {
    format!("{name:?} lies outside this file's folder; copy it next to this file")
}

/// The folder of a file; a bare name lies in the working directory.
pub fn folder(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

fn real_folder(folder: &Path) -> &Path {
    if folder.as_os_str().is_empty() { Path::new(".") } else { folder }
}
