//! Texts of strangers as one harmless line: names come from hostile files, messages from drivers.

/// The most characters of a name or a message that are shown.
const MOST_SHOWN: usize = 1000;
/// How many of them are the last: the remedy stands at the end.
const LAST_SHOWN: usize = 300;

/// Escapes what would break the line or steer a terminal, and leaves out the middle of what would fill it.
pub fn one_line(text: &str) -> String {
    // No character has more than four bytes, so that a text of millions need not be counted.
    if text.len() > 4 * MOST_SHOWN || text.chars().count() > MOST_SHOWN {
        let start: String = text.chars().take(MOST_SHOWN - LAST_SHOWN).collect();
        let end = text.char_indices().rev().nth(LAST_SHOWN - 1).map_or(0, |(at, _)| at);
        return format!("{} ... {}", printable(&start), printable(&text[end..]));
    }
    printable(text)
}

/// Does a character steer a terminal, or is it a mark that turns the text after it around or breaks its line?
pub fn steers(c: char) -> bool {
    let is_mark = matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    c.is_control() || is_mark
}

/// Escapes what would break a line or steer a terminal.
pub fn printable(text: &str) -> String {
    text.chars()
        .flat_map(|c| {
            let escaped: Box<dyn Iterator<Item = char>> =
                if steers(c) { Box::new(c.escape_default()) } else { Box::new(std::iter::once(c)) };
            escaped
        })
        .collect()
}

/// A count with its noun.
pub fn plural(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// A number with seven digits, which is what single precision has.
pub fn seven_digits(x: f64) -> String {
    const DIGITS: i32 = 6;
    let scientific = format!("{x:.6e}");
    let power = scientific.split_once('e').and_then(|(_, power)| power.parse::<i32>().ok());
    match power {
        // What is rounded to zero has no sign.
        Some(power) if (-4..=DIGITS).contains(&power) => format!("{:.*}", (DIGITS - power) as usize, x + 0.0),
        _ => scientific,
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::error::Error;

    #[test]
    fn marks_that_turn_text_around_are_escaped_and_other_letters_are_not() {
        assert_eq!(
            one_line("a\u{202e}gpj.\u{2066}b\u{2069}\u{200f}\u{2028}"),
            "a\\u{202e}gpj.\\u{2066}b\\u{2069}\\u{200f}\\u{2028}"
        );
        let plain = "\u{e9}\u{5d0}\u{200d}\u{1f600} \u{6f22}";
        assert_eq!(one_line(plain), plain);
    }

    #[test]
    fn a_long_message_keeps_its_beginning_and_its_remedy() {
        for letter in ["a", "\u{1f600}", "\0"] {
            let message = format!("unknown key \"{}\"; did you mean \"size\"?", letter.repeat(1 << 20));
            let shown = Error::line(Path::new("a.toml"), 3, message).to_string();
            assert!(shown.starts_with("a.toml:3: unknown key \""), "{shown}");
            assert!(shown.contains(" ... ") && shown.ends_with("\"; did you mean \"size\"?"), "{shown}");
            assert!(shown.len() < 8 * MOST_SHOWN, "{} bytes", shown.len());
        }
        let whole = "a".repeat(MOST_SHOWN);
        assert_eq!(Error::new(whole.as_str()).to_string(), whole);
    }

    #[test]
    fn numbers_have_seven_digits_and_powers_of_ten_where_they_are_far_from_one() {
        for (x, want) in [
            (0.0, "0.000000"),
            (-0.0, "0.000000"),
            (4.0, "4.000000"),
            (-12.345_678_9, "-12.34568"),
            (999_999.96, "1000000"),
            (0.000_123_456_78, "0.0001234568"),
            (1.5e-5, "1.500000e-5"),
            (123_456_789.0, "1.234568e8"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(seven_digits(x), want);
        }
    }
}
