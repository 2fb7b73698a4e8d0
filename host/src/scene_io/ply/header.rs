//! The header of a mesh file: its encoding, and what its elements hold.

use std::collections::HashSet;
use std::io::{BufRead, Read};

use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::Header;

use super::element::Ignored;
use super::fault::{Checked, Fault};

/// Bytes of a header, most of them comments.
const MOST: u64 = 1 << 20;
/// Elements, of which each that is not read is warned of.
const MOST_ELEMENTS: usize = 64;

/// Keywords that its lines begin with.
const KEYWORDS: [&str; 7] = ["ply", "format", "comment", "obj_info", "element", "property", "end_header"];

/// What is found of it.
pub(super) struct Found {
    pub header: Header,
    /// How many lines it has.
    pub lines: usize,
    /// A warning of lines that are none of a header.
    pub stray: Option<String>,
}

/// Reads it.
///
/// # Errors
/// What is no header, ends within it, is too long, or names something twice.
pub(super) fn read(reader: &mut impl BufRead) -> Checked<Found> {
    let (text, stray) = without_strays(&text(reader)?);
    check_names(&text)?;
    let header = Parser::<Ignored>::new().read_header(&mut Reader::new(text.as_bytes()));
    Ok(Found { header: header.map_err(|error| fault(&error, &text))?, lines: text.lines().count(), stray })
}

/// The text with comments in place of lines that begin with no keyword, which some programs write of their own.
fn without_strays(text: &str) -> (String, Option<String>) {
    let is_stray = |line: &&str| !line.split_ascii_whitespace().next().is_some_and(|word| KEYWORDS.contains(&word));
    let strays: Vec<(usize, &str)> = (1..).zip(text.lines()).filter(|(_, line)| is_stray(line)).collect();
    let lines = text.lines().map(|line| if is_stray(&line) { "comment\n".into() } else { format!("{line}\n") });
    let warning = strays.first().map(|(number, line)| {
        let start: String = line.trim().chars().take(60).collect();
        let more = if strays.len() > 1 { format!(" and {} more", strays.len() - 1) } else { String::new() };
        format!("line {number} of its header, {start:?}{more}, is ignored: it begins with no keyword")
    });
    (lines.collect(), warning)
}

/// All of its lines. Comments need not be UTF-8.
fn text(reader: &mut impl BufRead) -> Checked<String> {
    let mut reader = reader.by_ref().take(MOST);
    let mut text = Vec::new();
    loop {
        let start = text.len();
        reader.read_until(b'\n', &mut text)?;
        let line = text[start..].trim_ascii();
        if start == 0 && line != b"ply" {
            return Err("is no PLY file: its first line is not \"ply\"; is it a mesh?".into());
        }
        if line == b"end_header" {
            return Ok(String::from_utf8_lossy(&text).into_owned());
        }
        if reader.limit() == 0 {
            return Err(format!("its header has more than {MOST} bytes; shorten it").into());
        }
        if text.len() == start {
            return Err("ends within its header; write it again".into());
        }
    }
}

/// Refuses what is there twice, of which the parser keeps one.
fn check_names(text: &str) -> Checked<()> {
    let (mut elements, mut properties) = (HashSet::new(), HashSet::new());
    for (number, line) in (1..).zip(text.lines()) {
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let (kind, name, is_new) = match words[..] {
            ["element", name, ..] => {
                properties.clear();
                ("element", name, elements.insert(name))
            }
            ["property", .., name] => ("property", name, properties.insert(name)),
            _ => continue,
        };
        if !is_new {
            return Err(Fault::of_line(number, format!("a second {kind} {name:?}; remove one")));
        }
        if elements.len() > MOST_ELEMENTS {
            return Err(Fault::of_line(number, format!("there are more than {MOST_ELEMENTS} elements; remove some")));
        }
    }
    Ok(())
}

fn fault(error: &ParseError, text: &str) -> Fault {
    let Some(line) = error.line() else {
        return "its header has no line \"format ascii 1.0\", or of binary_little_endian or binary_big_endian".into();
    };
    let words = text.lines().nth(line - 1).unwrap_or_default();
    let start: String = words.chars().take(60).collect();
    Fault::of_line(line, format!("{start:?} makes no sense here in a header; correct it"))
}
