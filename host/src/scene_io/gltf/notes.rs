//! What of a file is not drawn, each thing said once.

use std::collections::HashSet;
use std::path::Path;

use super::super::{Warning, WarningKind};

/// The most warnings of a file: it comes from strangers.
const MOST: usize = 100;

/// The warnings of a file.
pub struct Notes<'p> {
    path: &'p Path,
    said: HashSet<String>,
    warnings: Vec<Warning>,
}

impl<'p> Notes<'p> {
    /// None yet, of the file.
    pub fn new(path: &'p Path) -> Self {
        Notes { path, said: HashSet::new(), warnings: Vec::new() }
    }

    /// Says that a part is not drawn, unless something is said already of what it is about.
    pub fn left_out(&mut self, what: &str, text: &str) {
        self.once(WarningKind::LeftOut, what, text);
    }

    /// Says that something is drawn otherwise than the file has it, unless something is said already of what it is about.
    pub fn changed(&mut self, what: &str, text: &str) {
        self.once(WarningKind::Changed, what, text);
    }

    /// Says that something that the file names is not there, unless something is said already of what it is about.
    pub fn missing(&mut self, what: &str, text: &str) {
        self.once(WarningKind::Missing, what, text);
    }

    fn once(&mut self, kind: WarningKind, what: &str, text: &str) {
        if self.warnings.len() < MOST && self.said.insert(what.to_owned()) {
            self.warnings.push(Warning::new(kind, self.path, text));
        }
    }

    /// All of them, in the order in which they were found.
    pub fn finish(self) -> Vec<Warning> {
        self.warnings
    }
}
