//! A TOML text that knows its lines.

use std::path::Path;
use std::rc::Rc;

use toml::de::DeTable;

use super::table::Table;
use crate::error::{Error, Result};

/// A TOML text and the file it came from.
#[derive(Clone)]
pub struct Source<'s> {
    path: &'s Path,
    text: &'s str,
    /// How many lines end before each block of [`BLOCK`] bytes: many faults of a long text are placed in no time.
    ends: Rc<[usize]>,
}

const BLOCK: usize = 1 << 12;

impl<'s> Source<'s> {
    /// A text and the file that errors name.
    pub fn new(path: &'s Path, text: &'s str) -> Self {
        let blocks = text.as_bytes().chunks(BLOCK);
        let ends = blocks.scan(0, |ends, block| Some(std::mem::replace(ends, *ends + line_ends(block))));
        Source { path, text, ends: ends.collect() }
    }

    /// The file's tables. The error is a fault of the syntax or a key given twice.
    pub fn parse(&self) -> Result<Table<'s>> {
        let table = DeTable::parse(self.text).map_err(|error| {
            let at = error.span().map_or(0, |span| span.start);
            self.fault(at, error.message())
        })?;
        Ok(Table::new(self.clone(), "the file", 0, table.into_inner()))
    }

    /// A fault at byte `at`.
    pub fn fault(&self, at: usize, message: impl Into<String>) -> Error {
        let at = at.min(self.text.len());
        let block = (at / BLOCK).min(self.ends.len().saturating_sub(1));
        let before = self.ends.get(block).copied().unwrap_or_default();
        let line = 1 + before + line_ends(&self.text.as_bytes()[block * BLOCK..at]);
        Error::line(self.path, line, message)
    }
}

fn line_ends(text: &[u8]) -> usize {
    text.iter().filter(|&&byte| byte == b'\n').count()
}
