//! URIs of buffers and images: data in the file itself, or the name of a file beside it.

use std::borrow::Cow;
use std::path::PathBuf;

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};

use crate::scene::Unplaced;
use crate::scene_io::neighbours::Neighbours;

/// With or without padding: writers differ.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

/// What a URI leads to.
pub enum Target {
    /// The bytes of a `data:` URI.
    Bytes(Vec<u8>),
    /// A file in the folder or below.
    File(PathBuf),
    /// No file of this name that may be read.
    Missing(String),
}

/// Follows a URI of a file that has these neighbours. The error does not say whose URI it is.
///
/// # Errors
/// Data that is not base64, an address of a network, or a name that is no text.
pub fn follow(uri: &str, neighbours: &Neighbours) -> Unplaced<Target> {
    if uri.get(..5).is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:")) {
        let data = &uri[5..];
        let data = if data.contains('%') { Cow::Owned(percent_decoded(data)?) } else { Cow::Borrowed(data) };
        return data_of(&data).map(Target::Bytes);
    }
    if has_scheme(uri) {
        let start: String = uri.chars().take(60).collect();
        return Err(format!("{start:?} is an address and is not fetched; copy the file next to this one and name it"));
    }
    let name = percent_decoded(uri)?;
    if name.is_empty() {
        return Err("the uri is empty; name a file".into());
    }
    Ok(neighbours.find(&name).map_or(Target::Missing(name), Target::File))
}

/// What is said of a file without which nothing can be drawn.
pub fn missing(name: &str) -> String {
    format!("{name:?}: there is no such file in this file's folder or below; copy it there, or add --allow-outside")
}

fn data_of(data: &str) -> Unplaced<Vec<u8>> {
    let Some((kind, text)) = data.split_once(',') else {
        return Err("the data URI has no comma before its data; write the file again".into());
    };
    if !kind.to_ascii_lowercase().ends_with(";base64") {
        return Err("the data URI is not in base64; write the file again".into());
    }
    BASE64.decode(text).map_err(|error| format!("the data URI is not base64 ({error}); write the file again"))
}

/// Does it begin as `http:` does? One letter is a drive.
fn has_scheme(uri: &str) -> bool {
    let Some((scheme, _)) = uri.split_once(':') else { return false };
    let is_of_scheme = |c: char| c.is_ascii_alphanumeric() || "+-.".contains(c);
    scheme.len() > 1 && scheme.starts_with(|c: char| c.is_ascii_alphabetic()) && scheme.chars().all(is_of_scheme)
}

/// `%20` becomes a space. A percent sign without two digits stands for itself, as in the names that careless writers leave.
fn percent_decoded(uri: &str) -> Unplaced<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        let code = after.get(..2).filter(|_| first == b'%').and_then(hexadecimal);
        bytes.push(code.unwrap_or(first));
        rest = if code.is_some() { after.get(2..).unwrap_or_default() } else { after };
    }
    String::from_utf8(bytes).map_err(|_| {
        let start: String = uri.chars().take(60).collect();
        format!("{start:?} is no UTF-8 text; rename the file")
    })
}

fn hexadecimal(digits: &[u8]) -> Option<u8> {
    let number = |digit: &u8| char::from(*digit).to_digit(16);
    let [high, low] = digits else { return None };
    u8::try_from(number(high)? * 16 + number(low)?).ok()
}
