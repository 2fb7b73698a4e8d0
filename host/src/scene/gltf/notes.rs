//! What of a file is not drawn, each thing said once.

use std::collections::HashSet;
use std::path::Path;

/// The most warnings of a file: it comes from strangers.
const MOST: usize = 100;

/// The warnings of a file.
pub struct Notes<'p> {
    path: &'p Path,
    said: HashSet<String>,
    warnings: Vec<String>,
}

impl<'p> Notes<'p> {
    /// None yet, of the file.
    pub fn new(path: &'p Path) -> Self {
        Notes { path, said: HashSet::new(), warnings: Vec::new() }
    }

    /// Says it unless something of this kind is said already.
    pub fn once(&mut self, kind: &str, text: &str) {
        if self.warnings.len() < MOST && self.said.insert(kind.to_owned()) {
            self.warnings.push(format!("{}: {text}", self.path.display()));
        }
    }

    /// All of them, in the order in which they were found.
    pub fn finish(self) -> Vec<String> {
        self.warnings
    }
}
