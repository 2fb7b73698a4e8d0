//! Whole numbers that a writer gave a point: `4.0` is 4 (glTF 2.0, 2.7 allows it where an integer is asked for).

use std::borrow::Cow;

/// The JSON with blanks in place of each point that only zeros follow, outside of strings. All else stays at its place, so that
/// messages name the right columns.
pub fn without_points(json: &[u8]) -> Cow<'_, [u8]> {
    let mut changed = Cow::Borrowed(json);
    let (mut at, mut is_text) = (0, false);
    while let Some(&byte) = json.get(at) {
        at += match byte {
            b'\\' if is_text => 2,
            b'"' => {
                is_text = !is_text;
                1
            }
            b'.' if !is_text => {
                let zeros = json[at + 1..].iter().take_while(|&&byte| byte == b'0').count();
                let after = json.get(at + 1 + zeros);
                let ends = zeros > 0 && !after.is_some_and(|byte| matches!(byte, b'0'..=b'9' | b'e' | b'E'));
                if ends {
                    changed.to_mut()[at..=at + zeros].fill(b' ');
                }
                1 + zeros
            }
            _ => 1,
        };
    }
    changed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_points_of_whole_numbers_are_taken_away() {
        let of = |json: &str| String::from_utf8(without_points(json.as_bytes()).into_owned()).unwrap();
        assert_eq!(of("[4.0, 4.000,-2.0]"), "[4  , 4    ,-2  ]");
        for same in ["[4.05, 0.5, 4.0e2, 4.00E-1, 1.]", r#"{"a 4.0": "\" 4.0", "b\\": "4.0"}"#] {
            assert_eq!(of(same), same);
        }
        assert!(matches!(without_points(b"[1, 2.5]"), Cow::Borrowed(_)));
    }
}
