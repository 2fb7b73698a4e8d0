//! A TOML text that knows its lines.

use std::path::Path;
use std::rc::Rc;

use toml::de::DeTable;

use super::budget::Budget;
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

    /// The file's tables. The error is a fault of the syntax, a key given twice, or more values than there is memory for.
    pub fn parse(&self, budget: &Budget) -> Result<Table<'s>> {
        let fits = budget.check_bytes(memory(self.text));
        fits.map_err(|why| Error::file(self.path, format!("its values may {why}; write fewer")))?;
        let table = DeTable::parse(self.text).map_err(|error| {
            let at = error.span().map_or(0, |span| span.start);
            self.fault(at, error.message())
        })?;
        Ok(Table::new(self.clone(), "the file", 0, table.into_inner()))
    }

    /// Part of the text.
    pub fn part(&self, span: std::ops::Range<usize>) -> &'s str {
        self.text.get(span).unwrap_or_default()
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

/// What a TOML text may take of memory at most while it is parsed, in bytes: lists of `0,` took 156 a comma. Tables take
/// more, by their keys. What takes less than a megabyte is none to refuse a scene for.
pub fn memory(text: &str) -> u64 {
    const VALUE: u64 = 512;
    const LITTLE: u64 = 1 << 20;
    let values = text.bytes().filter(|byte| matches!(byte, b',' | b'=' | b'[' | b'{' | b'.')).count() as u64;
    (values * VALUE + 2 * text.len() as u64).saturating_sub(LITTLE)
}

fn line_ends(text: &[u8]) -> usize {
    text.iter().filter(|&&byte| byte == b'\n').count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene_io::tests::budget;

    #[test]
    fn values_that_there_is_no_memory_for_are_refused_before_they_are_parsed() {
        let text = format!("a = [{}]\n", "0,".repeat(100_000));
        let parse = |bytes| Source::new(Path::new("a.toml"), &text).parse(&budget(bytes)).map(drop);
        let refused = parse(10_000_000).unwrap_err().to_string();
        assert!(refused.starts_with("a.toml: its values may take about 50 MB of memory, and "), "{refused}");
        assert_eq!(parse(100_000_000), Ok(()));
        assert_eq!(Source::new(Path::new("a.toml"), "a = [0, 1]").parse(&budget(0)).map(drop), Ok(()));
    }
}
