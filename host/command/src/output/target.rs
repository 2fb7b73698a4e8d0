//! What an output's path stands for.

use std::fs::{self, OpenOptions, Permissions};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use super::write_error;
use crate::error::{Error, Result};

/// What a path stands for before anything is written.
pub(super) enum Target {
    /// A file at `place` (links followed), there already if it has permissions.
    Regular { place: PathBuf, permissions: Option<Permissions> },
    /// A device, pipe or socket.
    Special,
}

impl Target {
    pub fn of(path: &Path) -> Result<Self> {
        let fault = |error: io::Error| Error::file(path, write_error(&error).message);
        match fs::metadata(path) {
            Ok(found) if found.is_dir() => Err(fault(ErrorKind::IsADirectory.into())),
            Ok(found) if found.is_file() => {
                // A rename would replace even a read-only file.
                OpenOptions::new().write(true).open(path).map_err(fault)?;
                Ok(Target::Regular {
                    place: fs::canonicalize(path).map_err(fault)?,
                    permissions: Some(found.permissions()),
                })
            }
            Ok(_) => Ok(Target::Special),
            Err(_) if path.as_os_str().is_empty() => Err(Error::new("the output's name is empty; name a file")),
            Err(error) if error.kind() == ErrorKind::NotFound => {
                let name = path.as_os_str().as_encoded_bytes();
                if name.last().is_some_and(|&c| std::path::is_separator(c.into())) {
                    return Err(fault(ErrorKind::IsADirectory.into()));
                }
                // What is renamed to it would replace the link, not make the file that it names.
                if fs::symlink_metadata(path).is_ok() {
                    let fault = "is a link to a file that does not exist; remove it or write elsewhere";
                    return Err(Error::file(path, fault.to_owned()));
                }
                Ok(Target::Regular { place: path.to_owned(), permissions: None })
            }
            Err(error) => Err(fault(error)),
        }
    }
}
