//! Pieces of a file that end where a line does.

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
