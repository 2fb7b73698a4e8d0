//! What the header of a Radiance HDR file says of its brightness.

use std::io::{self, BufRead};

/// What all pixels of a file were multiplied with before they were written: the product of its `EXPOSURE` lines (Radiance,
/// file formats). None if it is no finite number above 0.
///
/// # Errors
/// It cannot be read.
pub fn exposure(reader: impl BufRead) -> io::Result<Option<f32>> {
    let mut product = 1.0;
    for line in reader.split(b'\n') {
        let line = line?;
        // An empty line ends the header.
        if line.trim_ascii().is_empty() {
            break;
        }
        if let Some(number) = line.strip_prefix(b"EXPOSURE=") {
            let number = str::from_utf8(number).ok().and_then(|text| text.trim().parse::<f32>().ok());
            product *= number.unwrap_or(f32::NAN);
        }
    }
    Ok((product.is_normal() && product > 0.0).then_some(product))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exposures_are_multiplied_up_to_the_end_of_the_header() {
        let of = |header: &str| exposure(header.as_bytes()).unwrap();
        assert_eq!(of("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\nEXPOSURE=9\n"), Some(1.0));
        assert_eq!(of("#?RADIANCE\nEXPOSURE= 2.0 \r\nEXPOSURE=0.25\n\n"), Some(0.5));
        for odd in ["x", "0", "-1", "inf", "NaN", ""] {
            assert_eq!(of(&format!("#?RADIANCE\nEXPOSURE={odd}\n\n")), None, "{odd}");
        }
    }
}
