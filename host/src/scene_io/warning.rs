//! What of a scene's files is drawn otherwise than they say.

use std::fmt::{self, Display};
use std::path::{Path, PathBuf};

use crate::error::Error;

/// A fault of a file that is read all the same. It displays as one line without a full stop, as an [`Error`] does.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Warning {
    /// What came of it.
    pub kind: WarningKind,
    /// The file.
    pub file: PathBuf,
    /// The line in it, from 1.
    pub line: Option<usize>,
    /// What is wrong there, what is done about it, and mostly a remedy.
    pub message: String,
}

/// What comes of a fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum WarningKind {
    /// A file that is named is not there or can't be read: what it is for is drawn without.
    Missing,
    /// A part of the file is not drawn.
    LeftOut,
    /// It is drawn with another value than the file has.
    Changed,
    /// Something that is said changes nothing.
    Idle,
}

impl Warning {
    /// Of a file.
    pub(super) fn new(kind: WarningKind, file: &Path, message: impl Into<String>) -> Self {
        Warning { kind, file: file.to_owned(), line: None, message: message.into() }
    }

    /// Of a fault that names its file, which is no reason to stop.
    pub(super) fn of(kind: WarningKind, error: &Error) -> Self {
        let (file, line) = error.place().unwrap_or((Path::new(""), None));
        Warning { kind, file: file.to_owned(), line, message: error.message() }
    }
}

impl Display for Warning {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Warning { file, line, message, .. } = self;
        match line {
            Some(line) => Error::line(file, *line, message.as_str()).fmt(out),
            None => Error::file(file, message.as_str()).fmt(out),
        }
    }
}
