//! The records of elements, one after the other.

use std::collections::VecDeque;
use std::io::{BufRead, ErrorKind, Read};

use ply_rs_bw::parser::{ParseError, Parser};
use ply_rs_bw::ply::{ElementDef, Encoding, PropertyAccess, PropertyDef, PropertyType};

use super::fault::{Checked, Fault};
use crate::scene_io::lines::MOST_LINE;

/// What follows a header.
pub(super) struct Records<R> {
    reader: R,
    encoding: Encoding,
    /// The number of the line that was read last.
    line: usize,
    text: Vec<u8>,
    /// Words of lines that hold more than a record, and the line of the first that did not end with one.
    words: VecDeque<String>,
    broken: usize,
}

impl<R: BufRead> Records<R> {
    /// The records after so many lines.
    pub fn new(reader: R, encoding: Encoding, line: usize) -> Self {
        Records { reader, encoding, line, text: Vec::new(), words: VecDeque::new(), broken: 0 }
    }

    /// Calls `take` with the number, counted from 0, and the record of each of an element's. Elements are read in the header's order.
    ///
    /// # Errors
    /// A record that is not what the header says, the end of the file, or what `take` refuses.
    pub fn each<E: PropertyAccess>(
        &mut self,
        element: &ElementDef,
        mut take: impl FnMut(usize, E) -> Checked<()>,
    ) -> Checked<()> {
        // Any number of records of nothing takes no byte.
        let has_bytes = self.encoding == Encoding::Ascii || !element.properties.is_empty();
        let count = if has_bytes { element.count } else { 0 };
        (0..count).try_for_each(|number| {
            let record = self.record(element, number)?;
            take(number, record)
        })?;
        // Other elements begin on a line of their own: else a number is missing or too many.
        if self.words.is_empty() { Ok(()) } else { Err(misfit(element, self.broken)) }
    }

    fn record<E: PropertyAccess>(&mut self, element: &ElementDef, number: usize) -> Checked<E> {
        let parser = Parser::<E>::new();
        if self.encoding == Encoding::Ascii {
            return self.text_record(&parser, element, number);
        }
        let reader = &mut self.reader;
        let record = match self.encoding {
            Encoding::BinaryBigEndian => parser.read_big_endian_element(reader, element),
            Encoding::BinaryLittleEndian | Encoding::Ascii => parser.read_little_endian_element(reader, element),
        };
        record.map_err(|error| of_numbers(&error, element, number))
    }

    /// A record of text, which most writers have on a line of its own.
    fn text_record<E: PropertyAccess>(
        &mut self,
        parser: &Parser<E>,
        element: &ElementDef,
        number: usize,
    ) -> Checked<E> {
        if self.words.is_empty() {
            let line = self.next_line()?.ok_or_else(|| ends(element, number))?;
            let line = line.ok_or(()).and_then(|line| parser.read_ascii_element(line, element).map_err(|_| ()));
            let record = line.ok();
            let count = self.text.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).count();
            // Words behind a record are ignored, unless they are whole records.
            let is_one = fixed(element).is_none_or(|one| one == 0 || count < 2 * one || count % one > 0);
            if let Some(record) = record.filter(|_| is_one) {
                return Ok(record);
            }
            self.broken = self.line;
            self.split();
        }
        let wanted = loop {
            match wanted(element, &self.words) {
                Some(wanted) if wanted <= self.words.len() => break wanted,
                _ => {
                    if self.next_line()?.flatten().is_none() {
                        return Err(misfit(element, self.broken));
                    }
                    self.split();
                }
            }
        };
        let record = self.words.drain(..wanted).collect::<Vec<_>>().join(" ");
        parser.read_ascii_element(&record, element).map_err(|_| misfit(element, self.broken))
    }

    /// Adds the words of the last line.
    fn split(&mut self) {
        self.words.extend(String::from_utf8_lossy(&self.text).split_ascii_whitespace().map(str::to_owned));
    }

    /// The next line, if there is one and if it is text.
    fn next_line(&mut self) -> Checked<Option<Option<&str>>> {
        self.text.clear();
        self.reader.by_ref().take(MOST_LINE as u64 + 1).read_until(b'\n', &mut self.text)?;
        self.line += 1;
        if self.text.len() > MOST_LINE {
            return Err(Fault::of_line(self.line, format!("a line has more than {MOST_LINE} bytes; break it")));
        }
        Ok((!self.text.is_empty()).then(|| str::from_utf8(&self.text).ok()))
    }
}

/// How many words a record has, if all have as many.
fn fixed(element: &ElementDef) -> Option<usize> {
    let is_scalar = |property: &PropertyDef| matches!(property.data_type, PropertyType::Scalar(_));
    element.properties.values().all(is_scalar).then_some(element.properties.len())
}

/// How many words a record has that begins with these, if they tell: a list begins with its length.
fn wanted(element: &ElementDef, words: &VecDeque<String>) -> Option<usize> {
    element.properties.values().try_fold(0usize, |at, property| match property.data_type {
        PropertyType::Scalar(_) => at.checked_add(1),
        PropertyType::List(..) => at.checked_add(1)?.checked_add(words.get(at)?.parse().unwrap_or(0)),
    })
}

fn misfit(element: &ElementDef, line: usize) -> Fault {
    let names: Vec<&str> = element.properties.keys().map(String::as_str).take(9).collect();
    Fault::of_line(line, format!("is not the {} of a {}; correct the line", names.join(" "), element.name))
}

fn of_numbers(error: &ParseError, element: &ElementDef, number: usize) -> Fault {
    match error.kind() {
        ErrorKind::UnexpectedEof => ends(element, number),
        ErrorKind::InvalidInput | ErrorKind::InvalidData => {
            format!("{} {number} is not what the header says; write the file again", element.name).into()
        }
        _ => format!("cannot be read: {error}").into(),
    }
}

fn ends(element: &ElementDef, number: usize) -> Fault {
    let ElementDef { name, count, .. } = element;
    format!("ends within {name} {number} of {count}, counted from 0; write the file again").into()
}
