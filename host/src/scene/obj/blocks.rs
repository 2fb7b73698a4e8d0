//! Pieces of a file that end where a line does.

use std::io::Read;
use std::path::Path;

use super::super::file;
use super::super::lines::MOST_LINE;
use crate::error::{Error, Result};

/// How many bytes are read at a time.
#[derive(Clone, Copy)]
pub(super) struct Sizes {
    /// By all threads.
    pub window: usize,
    /// By one.
    pub block: usize,
}

impl Sizes {
    /// Far more than a line, and little beside what a mesh takes.
    pub const USUAL: Sizes = Sizes { window: 64 << 20, block: 1 << 20 };
}

/// The windows of a file.
pub(super) struct Windows<'p, R> {
    path: &'p Path,
    reader: R,
    size: usize,
    /// The beginning of the next window, which is that of a line.
    rest: Vec<u8>,
}

impl<'p, R: Read> Windows<'p, R> {
    /// The windows of what `reader` gives; errors name the file `path`.
    pub fn new(path: &'p Path, reader: R, size: usize) -> Self {
        Windows { path, reader, size, rest: Vec::new() }
    }

    /// The next window, if there is one.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn advance(&mut self) -> Result<Option<Vec<u8>>> {
        let mut text = std::mem::take(&mut self.rest);
        text.reserve(self.size);
        loop {
            let read = self.reader.by_ref().take(self.size as u64).read_to_end(&mut text);
            let read = read.map_err(|error| Error::file(self.path, file::explain(&error)))?;
            // A line that is too long is told where lines are read.
            if read < self.size || text.len() > MOST_LINE + self.size {
                break;
            }
            if let Some(end) = last_end(&text) {
                self.rest = text.split_off(end);
                break;
            }
        }
        Ok((!text.is_empty()).then_some(text))
    }
}

/// A window as blocks of about a size.
pub(super) fn of(mut window: &[u8], size: usize) -> Vec<&[u8]> {
    let mut blocks = Vec::with_capacity(window.len() / size + 1);
    while window.len() > size {
        let ends = (size..window.len()).find(|&end| is_end(&window[..end]));
        let (block, rest) = window.split_at(last_end(&window[..size]).or(ends).unwrap_or(window.len()));
        blocks.push(block);
        window = rest;
    }
    if !window.is_empty() {
        blocks.push(window);
    }
    blocks
}

/// Where the last line ends that no other continues.
fn last_end(text: &[u8]) -> Option<usize> {
    (0..text.len()).rev().map(|i| i + 1).find(|&end| is_end(&text[..end]))
}

/// Does the last line of a text end here?
fn is_end(text: &[u8]) -> bool {
    let Some((b'\n', line)) = text.split_last() else { return false };
    line.iter().rev().find(|&&byte| byte != b'\r') != Some(&b'\\')
}
