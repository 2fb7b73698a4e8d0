//! From a file to its JSON and to the bytes that come with it.

use std::ops::Range;

use crate::scene::Unplaced;
use crate::scene_io::file;

/// Where in a file its JSON is, and the binary chunk if there is one.
pub struct Container {
    pub json: Range<usize>,
    pub chunk: Option<Range<usize>>,
}

/// How every binary file begins.
pub const MAGIC: &[u8] = b"glTF";
const JSON: &[u8] = b"JSON";
const BINARY: &[u8] = b"BIN\0";
/// Magic, version and length.
const HEADER: usize = 12;

/// The bytes that tell how long the JSON is.
pub const START: usize = HEADER + 8;

/// Refuses a file for its first bytes and its length, before the rest of it is read.
///
/// # Errors
/// A binary file of another version or longer than it is, and more JSON than [`file::MOST_TEXT`].
pub fn check(start: &[u8], length: u64) -> Unplaced<()> {
    if !start.starts_with(MAGIC) {
        return check_json(length);
    }
    check_version(start)?;
    match (word(start, 8), word(start, HEADER)) {
        (Some(claimed), Some(json)) if claimed as u64 <= length => check_json(json as u64),
        _ => Err(ends()),
    }
}

fn check_json(length: u64) -> Unplaced<()> {
    let most = file::MOST_TEXT;
    if length > most {
        return Err(format!("the JSON holds {length} bytes and {most} is the most that is read; split the file"));
    }
    Ok(())
}

fn check_version(bytes: &[u8]) -> Unplaced<()> {
    match word(bytes, 4) {
        Some(2) => Ok(()),
        Some(version) => Err(format!("this is a binary glTF of version {version}; convert it to version 2")),
        None => Err(ends()),
    }
}

fn ends() -> String {
    "the file ends early; was it written to the end?".to_owned()
}

/// Finds the chunks of a binary file, or takes all of it for JSON. It goes by the first bytes: names may lie.
///
/// # Errors
/// Another version, a file that ends early, no JSON, or more of it than [`file::MOST_TEXT`].
pub fn open(bytes: &[u8]) -> Unplaced<Container> {
    let container =
        if bytes.starts_with(MAGIC) { chunks(bytes)? } else { Container { json: 0..bytes.len(), chunk: None } };
    check_json(container.json.len() as u64)?;
    Ok(container)
}

fn chunks(bytes: &[u8]) -> Unplaced<Container> {
    check_version(bytes)?;
    let length = word(bytes, 8).ok_or_else(ends)?;
    let bytes = bytes.get(..length).ok_or_else(ends)?;
    let (json, kind) = chunk(bytes, HEADER)?.ok_or_else(ends)?;
    if kind != JSON {
        return Err("its first chunk is not JSON; write the file again".into());
    }
    // The format pads chunks to four bytes, and their lengths count the padding.
    let next = chunk(bytes, json.end)?;
    let chunk = next.and_then(|(range, kind)| (kind == BINARY).then_some(range));
    Ok(Container { json, chunk })
}

/// The place and the kind of the chunk at an offset; nothing at the end.
fn chunk(bytes: &[u8], at: usize) -> Unplaced<Option<(Range<usize>, &[u8])>> {
    let (Some(length), Some(kind)) = (word(bytes, at), bytes.get(at + 4..at + 8)) else { return Ok(None) };
    let start = at + 8;
    match start.checked_add(length) {
        Some(end) if end <= bytes.len() => Ok(Some((start..end, kind))),
        _ => Err(format!("a chunk claims {length} bytes, and the file ends before; was it written to the end?")),
    }
}

fn word(bytes: &[u8], at: usize) -> Option<usize> {
    let word = bytes.get(at..)?.first_chunk::<4>()?;
    usize::try_from(u32::from_le_bytes(*word)).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_refused_by_its_first_bytes_before_the_rest_is_read() {
        let start =
            |json: u32| [MAGIC, &2u32.to_le_bytes(), &(1u32 << 30).to_le_bytes(), &json.to_le_bytes(), JSON].concat();
        assert_eq!(check(&start(1000), 1 << 30), Ok(()));
        assert_eq!(check(b"{\"asset\"", file::MOST_TEXT), Ok(()));
        let too_much = "and 67108864 is the most that is read; split the file";
        assert!(check(&start(1 << 27), 1 << 30).unwrap_err().ends_with(too_much));
        assert!(check(b"{", file::MOST_TEXT + 1).unwrap_err().ends_with(too_much));
        assert_eq!(check(&start(1000), 1 << 20), Err(ends()));
    }
}
