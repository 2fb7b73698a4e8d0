//! The records of elements, one after the other.

use std::io::{BufRead, ErrorKind, Read};

use ply_rs_bw::parser::{ParseError, Parser};
use ply_rs_bw::ply::{ElementDef, Encoding, PropertyAccess};

use super::fault::{Checked, Fault};
use crate::scene::lines::MOST_LINE;

/// What follows a header.
pub(super) struct Records<R> {
    reader: R,
    encoding: Encoding,
    /// The number of the line that was read last.
    line: usize,
    text: Vec<u8>,
}

impl<R: BufRead> Records<R> {
    /// The records after so many lines.
    pub fn new(reader: R, encoding: Encoding, line: usize) -> Self {
        Records { reader, encoding, line, text: Vec::new() }
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
        })
    }

    fn record<E: PropertyAccess>(&mut self, element: &ElementDef, number: usize) -> Checked<E> {
        let parser = Parser::<E>::new();
        let reader = &mut self.reader;
        let record = match self.encoding {
            Encoding::Ascii => {
                let end = || ends(element, number);
                let line = self.next_line()?.ok_or_else(end)?;
                return line.and_then(|line| parser.read_ascii_element(line, element).ok()).ok_or_else(|| {
                    let names: Vec<&str> = element.properties.keys().map(String::as_str).take(9).collect();
                    let text = format!("is not the {} of a {}; correct the line", names.join(" "), element.name);
                    Fault::of_line(self.line, text)
                });
            }
            Encoding::BinaryBigEndian => parser.read_big_endian_element(reader, element),
            Encoding::BinaryLittleEndian => parser.read_little_endian_element(reader, element),
        };
        record.map_err(|error| of_numbers(&error, element, number))
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
