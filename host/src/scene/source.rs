//! A TOML text that knows its lines.

use std::path::Path;

use toml::de::DeTable;

use super::table::Table;
use crate::error::{Error, Result};

/// A TOML text and the file it came from.
#[derive(Clone, Copy)]
pub struct Source<'s> {
    path: &'s Path,
    text: &'s str,
}

impl<'s> Source<'s> {
    /// A text and the file that errors name.
    pub fn new(path: &'s Path, text: &'s str) -> Self {
        Source { path, text }
    }

    /// The file's tables. The error is a fault of the syntax or a key given twice.
    pub fn parse(self) -> Result<Table<'s>> {
        let table = DeTable::parse(self.text).map_err(|error| {
            let at = error.span().map_or(0, |span| span.start);
            self.fault(at, error.message())
        })?;
        Ok(Table::new(self, "the file", 0, table.into_inner()))
    }

    /// A fault at byte `at`.
    pub fn fault(self, at: usize, message: impl Into<String>) -> Error {
        let before = self.text.as_bytes().iter().take(at);
        let line = 1 + before.filter(|&&byte| byte == b'\n').count();
        Error::line(self.path, line, message)
    }
}
