//! The one error of the program: a line that names the file and the remedy.

use std::fmt::{self, Display};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

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

/// The most characters of a name or a message that are shown.
const MOST_SHOWN: usize = 1000;
/// How many of them are the last: the remedy stands at the end.
const LAST_SHOWN: usize = 300;

/// Escapes what would break the line or steer a terminal, and leaves out the middle of what would fill it: names
/// come from hostile files.
fn one_line(text: &str) -> String {
    // No character has more than four bytes, so that a text of millions need not be counted.
    if text.len() > 4 * MOST_SHOWN || text.chars().count() > MOST_SHOWN {
        let start: String = text.chars().take(MOST_SHOWN - LAST_SHOWN).collect();
        let end = text.char_indices().rev().nth(LAST_SHOWN - 1).map_or(0, |(at, _)| at);
        return format!("{} ... {}", printable(&start), printable(&text[end..]));
    }
    printable(text)
}

/// Escapes what would break a line or steer a terminal.
pub(crate) fn printable(text: &str) -> String {
    text.chars()
        .flat_map(|c| {
            let escaped: Box<dyn Iterator<Item = char>> =
                if c.is_control() { Box::new(c.escape_default()) } else { Box::new(std::iter::once(c)) };
            escaped
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_message_keeps_its_beginning_and_its_remedy() {
        for letter in ["a", "\u{1f600}", "\0"] {
            let message = format!("unknown key \"{}\"; did you mean \"size\"?", letter.repeat(1 << 20));
            let shown = Error::line(Path::new("a.toml"), 3, message).to_string();
            assert!(shown.starts_with("a.toml:3: unknown key \""), "{shown}");
            assert!(shown.contains(" ... ") && shown.ends_with("\"; did you mean \"size\"?"), "{shown}");
            assert!(shown.len() < 8 * MOST_SHOWN, "{} bytes", shown.len());
        }
        let whole = "a".repeat(MOST_SHOWN);
        assert_eq!(Error::new(whole.as_str()).to_string(), whole);
    }
}
