//! Warnings that are given once a file.

use std::fmt::Display;
use std::path::Path;

use super::{Warning, WarningKind};
use crate::error::Error;

/// What is reported once a file: where it happened first, and how often it did.
#[derive(Debug, Default)]
pub struct Tally {
    first: Option<(usize, String)>,
    count: usize,
}

impl Tally {
    /// Notes one more on a line, counted from 1.
    pub fn add(&mut self, line: usize, what: impl Display) {
        self.first.get_or_insert_with(|| (line, what.to_string()));
        self.count += 1;
    }

    /// Adds those of later lines.
    pub fn append(&mut self, later: Tally) {
        self.first = self.first.take().or(later.first);
        self.count += later.count;
    }

    /// The warning, if there was anything: what was first, how many more, and `why`.
    pub fn warn(&self, kind: WarningKind, path: &Path, why: &str) -> Option<Warning> {
        self.fault(path, why).map(|fault| Warning::of(kind, &fault))
    }

    /// As [`Tally::warn`], for when it is an error.
    pub fn fault(&self, path: &Path, why: &str) -> Option<Error> {
        let (line, what) = self.first.as_ref()?;
        let more = match self.count - 1 {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        Some(Error::line(path, *line, format!("{what}{more} {why}")))
    }
}
