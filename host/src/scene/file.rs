//! Opening what a user named.

use std::fs::{self, File};
use std::io::{ErrorKind, Read};
use std::path::Path;

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

/// The folder of a file; a bare name lies in the working directory.
pub fn folder(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}
