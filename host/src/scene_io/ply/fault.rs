//! What is wrong with a mesh file, and on which line if that is known.

use std::io;
use std::path::Path;

use crate::error::Error;

/// A sentence about a file.
pub(super) struct Fault {
    line: Option<usize>,
    text: String,
}

pub(super) type Checked<T> = std::result::Result<T, Fault>;

impl Fault {
    pub fn of_line(line: usize, text: String) -> Self {
        Fault { line: Some(line), text }
    }

    pub fn of(self, path: &Path) -> Error {
        match self.line {
            Some(line) => Error::line(path, line, self.text),
            None => Error::file(path, self.text),
        }
    }
}

impl From<String> for Fault {
    fn from(text: String) -> Self {
        Fault { line: None, text }
    }
}

impl From<&str> for Fault {
    fn from(text: &str) -> Self {
        text.to_owned().into()
    }
}

impl From<io::Error> for Fault {
    fn from(error: io::Error) -> Self {
        format!("cannot be read: {error}").into()
    }
}
