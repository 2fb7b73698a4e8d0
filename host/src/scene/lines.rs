//! Counted lines of a Wavefront file that nobody vouches for.

use std::io::{self, BufRead};

use super::Unplaced;

/// The lines of a file: without their ends, a byte order mark or comments, and joined where a
/// backslash continues one.
pub struct Lines<R> {
    reader: R,
    line: Vec<u8>,
    next: usize,
}

impl<R: BufRead> Lines<R> {
    /// The lines of what `reader` gives.
    pub fn new(reader: R) -> Self {
        Lines { reader, line: Vec::new(), next: 1 }
    }

    /// Reads the next line, if there is one, and its number from 1.
    pub fn advance(&mut self) -> io::Result<Option<(usize, &[u8])>> {
        self.line.clear();
        let start = self.next;
        loop {
            if self.reader.read_until(b'\n', &mut self.line)? == 0 {
                break;
            }
            if self.next == 1 && self.line.starts_with(b"\xef\xbb\xbf") {
                self.line.drain(..3);
            }
            self.next += 1;
            while let Some(b'\n' | b'\r') = self.line.last() {
                self.line.pop();
            }
            // A comment may hold any bytes: old exporters wrote names in local encodings.
            if self.line.trim_ascii_start().starts_with(b"#") {
                self.line.clear();
            }
            if self.line.last() != Some(&b'\\') {
                break;
            }
            self.line.pop();
            self.line.push(b' ');
        }
        Ok((self.next > start).then_some((start, &self.line)))
    }
}

/// A line's keyword and the rest of it, both trimmed; `None` for a blank line.
///
/// # Errors
/// The line is not UTF-8.
pub fn split(line: &[u8]) -> Unplaced<Option<(&str, &str)>> {
    let Ok(text) = std::str::from_utf8(line) else {
        return Err("this is not UTF-8 text; save the file as UTF-8".into());
    };
    let text = text.trim();
    let (keyword, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    Ok((!keyword.is_empty()).then_some((keyword, rest.trim_start())))
}

/// The words of a statement's rest, up to a comment. A name may hold a `#`, so names are taken whole.
pub fn words(rest: &str) -> impl Iterator<Item = &str> {
    rest.split_whitespace().take_while(|word| !word.starts_with('#'))
}

/// A finite number.
///
/// # Errors
/// The word is no number, or one that single precision cannot hold.
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
        let mut lines = Lines::new(text);
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
    fn numbers_are_finite() {
        assert_eq!(number("v", "1e38"), Ok(1e38));
        for word in ["1e39", "nan", "inf", "1,5", ""] {
            assert!(number("v", word).is_err(), "{word}");
        }
    }
}
