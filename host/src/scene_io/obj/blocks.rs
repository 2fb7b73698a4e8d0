//! Pieces of a file that end where a line does.

use std::io::{self, Read};

use super::super::lines::MOST_LINE;

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

/// A file's text as windows of about a size, one after the other.
pub(super) struct Windows<R> {
    source: R,
    size: usize,
    /// Read, but behind the last end of a line.
    rest: Vec<u8>,
}

impl<R: Read> Windows<R> {
    /// The windows of what `source` gives.
    pub fn new(source: R, size: usize) -> Self {
        Windows { source, size, rest: Vec::new() }
    }

    /// Reads the next window in place of what is there; it is empty after the last. Only one that is longer
    /// than the longest line may end within a line.
    ///
    /// # Errors
    /// Those of the source.
    pub fn read(&mut self, window: &mut Vec<u8>) -> io::Result<()> {
        window.clear();
        window.append(&mut self.rest);
        loop {
            // At least doubled, so that a line of many windows is looked through few times.
            let wanted = self.size.saturating_sub(window.len()).max(window.len());
            let count = self.source.by_ref().take(wanted as u64).read_to_end(window)?;
            if count < wanted || window.len() > self.size + MOST_LINE {
                return Ok(());
            }
            if let Some(end) = last_end(window) {
                self.rest.extend_from_slice(&window[end..]);
                window.truncate(end);
                return Ok(());
            }
        }
    }
}

/// A text as blocks of about a size.
pub(super) fn of(mut text: &[u8], size: usize) -> Vec<&[u8]> {
    let mut blocks = Vec::with_capacity(text.len() / size + 1);
    while text.len() > size {
        let ends = (size..text.len()).find(|&end| is_end(&text[..end]));
        let (block, rest) = text.split_at(last_end(&text[..size]).or(ends).unwrap_or(text.len()));
        blocks.push(block);
        text = rest;
    }
    if !text.is_empty() {
        blocks.push(text);
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
