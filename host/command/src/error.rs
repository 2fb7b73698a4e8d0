//! The one error of the program: a line that names the file and the remedy.

use std::fmt::{self, Display};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use eyerays::line::one_line;
pub(crate) use eyerays::line::{printable, steers};

use crate::remedy;

/// The result of everything that can fail on what the user gave.
pub type Result<T> = std::result::Result<T, Error>;

/// What was wrong, where, and what to do about it. It displays as one line:
/// `scenes/cornell.toml:12: unknown key "colour"; did you mean "color"?`.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub struct Error {
    /// The file, if one is to blame.
    pub file: Option<PathBuf>,
    /// The line in it, from 1.
    pub line: Option<usize>,
    /// The fault and its remedy, without a full stop.
    pub message: String,
}

impl Error {
    /// A fault that no file is to blame for.
    pub fn new(message: impl Into<String>) -> Self {
        Error { file: None, line: None, message: message.into() }
    }

    /// A fault of a file.
    pub fn file(file: &Path, message: impl Into<String>) -> Self {
        Error { file: Some(file.to_owned()), line: None, message: message.into() }
    }

    /// A fault of one line of a file, counted from 1.
    pub fn line(file: &Path, line: usize, message: impl Into<String>) -> Self {
        Error { file: Some(file.to_owned()), line: Some(line), message: message.into() }
    }
}

impl From<eyerays::error::Error> for Error {
    fn from(error: eyerays::error::Error) -> Self {
        let (file, line) = error.place().unzip();
        Error { file: file.map(Path::to_owned), line: line.flatten(), message: remedy::worded(&error) }
    }
}

/// Refuses the first of an option's numbers that is out of range.
pub(crate) fn within<T: Display + PartialOrd>(option: &str, values: &[T], range: RangeInclusive<T>) -> Result<()> {
    match values.iter().find(|value| !range.contains(value)) {
        Some(value) => {
            let (least, most) = range.into_inner();
            Err(Error::new(format!("{option} {value} is not within {least} to {most}")))
        }
        None => Ok(()),
    }
}

impl Error {
    /// The same fault, of this file if it names none.
    pub fn of(self, file: &Path) -> Self {
        Error { file: self.file.or_else(|| Some(file.to_owned())), ..self }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(file) = &self.file {
            write!(out, "{}", one_line(&file.to_string_lossy()))?;
            if let Some(line) = self.line {
                write!(out, ":{line}")?;
            }
            out.write_str(": ")?;
        }
        out.write_str(&one_line(&self.message))
    }
}
