//! A reader that gives up: no more is read of an image's file than its header accounts for.

use std::cell::Cell;
use std::io::{self, BufRead, ErrorKind, Read, Seek, SeekFrom};
use std::rc::Rc;

/// How many bytes may still be read; shared, so that it can grow once the image's size is known.
#[derive(Clone)]
pub struct Allowance(Rc<Cell<u64>>);

impl Allowance {
    /// So many bytes.
    pub fn new(bytes: u64) -> Self {
        Allowance(Rc::new(Cell::new(bytes)))
    }

    /// So many bytes more.
    pub fn add(&self, bytes: u64) {
        self.0.set(self.0.get().saturating_add(bytes));
    }
}

/// Reads as its inner reader, up to an allowance; beyond it there is an error and no end of the file, since decoders
/// would call that a truncated file.
pub struct Bounded<R> {
    inner: R,
    left: Allowance,
}

impl<R> Bounded<R> {
    /// A reader of no more than the allowance.
    pub fn new(inner: R, left: Allowance) -> Self {
        Bounded { inner, left }
    }
}

impl<R: BufRead> BufRead for Bounded<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        let left = usize::try_from(self.left.0.get()).unwrap_or(usize::MAX);
        let buffer = self.inner.fill_buf()?;
        if left == 0 && !buffer.is_empty() {
            return Err(ErrorKind::FileTooLarge.into());
        }
        Ok(&buffer[..buffer.len().min(left)])
    }

    fn consume(&mut self, bytes: usize) {
        self.left.0.set(self.left.0.get() - bytes as u64);
        self.inner.consume(bytes);
    }
}

impl<R: BufRead> Read for Bounded<R> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let count = self.fill_buf()?.read(into)?;
        self.consume(count);
        Ok(count)
    }
}

impl<R: Seek> Seek for Bounded<R> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.inner.seek(to)
    }
}
