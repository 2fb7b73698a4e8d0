//! The validating reader between a mesh file and tobj.

use std::io::{self, BufRead, Read};
use std::path::Path;

use super::budget::Budget;
use super::lines::Lines;
use super::statement::{Found, State};
use crate::error::{Error, Result};

/// Reads as the text that tobj is given, made a block at a time from the lines of the file.
pub struct Checked<'p, R> {
    lines: Lines<'p, R>,
    state: State<'p>,
    taken: usize,
    fault: Option<Error>,
}

impl<'p, R: BufRead> Checked<'p, R> {
    /// The text of the lines that `reader` gives, of a mesh within the budget.
    pub fn new(path: &'p Path, reader: R, budget: Budget) -> Self {
        Checked { lines: Lines::new(path, reader), state: State::new(path, budget), taken: 0, fault: None }
    }

    /// What was found once the text is read, or the fault that ended it.
    pub fn finish(self) -> Result<Found> {
        match self.fault {
            Some(fault) => Err(fault),
            None => self.state.finish(),
        }
    }

    fn refill(&mut self) -> Result<()> {
        const BLOCK: usize = 1 << 16;
        self.state.text.clear();
        self.taken = 0;
        while self.state.text.len() < BLOCK {
            match self.lines.advance()? {
                None => break,
                Some((number, line)) => self.state.line(number, line)?,
            }
        }
        Ok(())
    }
}

impl<R: BufRead> BufRead for Checked<'_, R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.taken == self.state.text.len()
            && let Err(fault) = self.refill()
        {
            self.fault = Some(fault);
            return Err(io::Error::from(io::ErrorKind::InvalidData));
        }
        Ok(&self.state.text[self.taken..])
    }

    fn consume(&mut self, bytes: usize) {
        self.taken += bytes;
    }
}

impl<R: BufRead> Read for Checked<'_, R> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let count = self.fill_buf()?.read(into)?;
        self.consume(count);
        Ok(count)
    }
}
