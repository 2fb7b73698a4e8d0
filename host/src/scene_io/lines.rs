//! Numbered lines of an untrusted Wavefront file.

use std::borrow::Cow;
use std::io::{BufRead, Read};
use std::path::Path;

use super::file;
use crate::error::{Error, Result};
use crate::scene::Unplaced;

/// The most bytes of a line, with those that continue it: enough for a face of 100,000 corners.
pub const MOST_LINE: usize = 4 << 20;

/// What is said of lines whose [`text`] is no UTF-8.
pub const NOT_UTF8: &str = "not UTF-8 text: read as Latin-1; save the file as UTF-8";

/// The lines of a file: without their ends, a byte order mark or comments, and joined where a
/// backslash continues one.
pub struct Lines<'p, R> {
    path: &'p Path,
    reader: R,
    line: Vec<u8>,
    next: usize,
}

impl<'p, R: BufRead> Lines<'p, R> {
    /// The lines of what `reader` gives; errors name the file `path`.
    pub fn new(path: &'p Path, reader: R) -> Self {
        Lines::after(path, reader, 0)
    }

    /// The same of a file's rest, before which there are so many lines.
    pub fn after(path: &'p Path, reader: R, lines: usize) -> Self {
        Lines { path, reader, line: Vec::new(), next: lines + 1 }
    }

    /// How many lines were read, those before included.
    pub fn count(&self) -> usize {
        self.next - 1
    }

    /// Reads the next line, if there is one, and its number from 1.
    ///
    /// # Errors
    /// The file cannot be read, or the line has more than [`MOST_LINE`] bytes.
    pub fn advance(&mut self) -> Result<Option<(usize, &[u8])>> {
        self.line.clear();
        let start = self.next;
        let mut blank = true;
        while let Some(from) = self.append(start)? {
            // A comment may hold any bytes: old exporters wrote names in local encodings.
            if blank && self.line[from..].trim_ascii_start().starts_with(b"#") {
                self.line.clear();
            }
            if self.line.last() != Some(&b'\\') {
                break;
            }
            self.line.pop();
            blank &= self.line[from..].trim_ascii_start().is_empty();
            self.line.push(b' ');
        }
        Ok((self.next > start).then_some((start, &self.line)))
    }

    /// Appends the bytes up to the next line end, if there are any, and returns where they begin. `start` is the
    /// number of the line that they belong to.
    fn append(&mut self, start: usize) -> Result<Option<usize>> {
        let from = self.line.len();
        // One more than is allowed tells a line that is too long from one that just fits.
        let room = (MOST_LINE + 1 - from) as u64;
        let read = self.reader.by_ref().take(room).read_until(b'\n', &mut self.line);
        if read.map_err(|error| Error::file(self.path, file::explain(&error)))? == 0 {
            return Ok(None);
        }
        if self.line.len() > MOST_LINE {
            let fault = format!("the line has more than {MOST_LINE} bytes; split it, if this is a text file at all");
            return Err(Error::line(self.path, start, fault));
        }
        if self.next == 1 && self.line.starts_with(b"\xef\xbb\xbf") {
            self.line.drain(..3);
        }
        self.next += 1;
        while self.line.len() > from && matches!(self.line.last(), Some(b'\n' | b'\r')) {
            self.line.pop();
        }
        Ok(Some(from))
    }
}

/// The text of a line; one that is not UTF-8 is owned, and taken for Latin-1, in which old exporters wrote names:
/// different bytes stay different text.
pub fn text(line: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(line) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => Cow::Owned(line.iter().map(|&byte| char::from(byte)).collect()),
    }
}

/// A line's keyword and the rest of it, both trimmed; `None` for a blank line.
pub fn split(line: &str) -> Option<(&str, &str)> {
    let line = line.trim();
    let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    (!keyword.is_empty()).then_some((keyword, rest.trim_start()))
}

/// The words of a statement's rest, up to a comment. A name may hold a `#`, so names are taken whole.
pub fn words(rest: &str) -> impl Iterator<Item = &str> {
    rest.split_whitespace().take_while(|word| !word.starts_with('#'))
}

/// A finite number.
///
/// # Errors
/// The word is not a number, or one that single precision can't hold.
pub fn number(key: &str, word: &str) -> Unplaced<f32> {
    match word.parse::<f32>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) => Err(format!("{key} holds {word}, which is no finite number below 3.4e38; correct it")),
        Err(_) => Err(format!("{key} holds {word:?}, which is no number; correct it")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &[u8]) -> Vec<(usize, Vec<u8>)> {
        let mut lines = Lines::new(Path::new("a.obj"), text);
        let mut all = Vec::new();
        while let Some((number, line)) = lines.advance().unwrap() {
            all.push((number, line.to_owned()));
        }
        all
    }

    #[test]
    fn lines_are_counted_across_ends_marks_comments_and_continuations() {
        let text = b"\xef\xbb\xbfa\r\n# c\xff \\\nf 1 \\\n2 3\n\nlast";
        let want = [(1, &b"a"[..]), (2, b""), (3, b"f 1  2 3"), (5, b""), (6, b"last")];
        assert_eq!(read(text), want.map(|(n, line)| (n, line.to_owned())));
        assert!(read(b"").is_empty());
        assert_eq!(read(b"x\\"), [(1, b"x ".to_vec())]);
    }

    #[test]
    fn a_line_may_have_four_mebibytes_and_no_more_however_it_is_joined() {
        let blanks = vec![b' '; MOST_LINE - 1];
        assert_eq!(read(&[&blanks[..], b"\nv"].concat()).len(), 2);
        let long = [b"v\n", &blanks[..], b"12"].concat();
        let joined = [b"v\n", &blanks[..], b"\\\nv 1\n"].concat();
        for text in [long, joined] {
            let mut lines = Lines::new(Path::new("a.obj"), &text[..]);
            lines.advance().unwrap();
            let error = lines.advance().unwrap_err();
            assert_eq!(error.place().and_then(|(_, line)| line), Some(2), "{error}");
            assert!(error.message().contains("4194304 bytes"), "{error}");
        }
    }

    #[test]
    fn a_million_continuations_take_no_longer_than_their_bytes() {
        let text = b"\\\n".repeat(1 << 20);
        let start = std::time::Instant::now();
        assert_eq!(read(&text).len(), 1);
        assert!(start.elapsed().as_secs() < 10);
    }

    #[test]
    fn text_that_is_not_utf8_is_latin1() {
        assert_eq!(text("d\u{e6}k".as_bytes()), "d\u{e6}k");
        assert_eq!(text(b"d\xe6k"), "d\u{e6}k");
    }

    #[test]
    fn numbers_are_finite() {
        assert_eq!(number("v", "1e38"), Ok(1e38));
        for word in ["1e39", "nan", "inf", "1,5", ""] {
            assert!(number("v", word).is_err(), "{word}");
        }
    }
}
