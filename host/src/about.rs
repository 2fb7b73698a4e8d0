//! What a picture says of itself: how it was made, for people and programs that find the file.

use serde_json::{Map, Value};

/// Facts by name, in the order in which they were added. In an EXR they are the attribute `eyerays`, in a PNG the text chunk of this
/// name, as JSON in ASCII; an EXR has the matrices of the camera as standard attributes, too.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct About(Map<String, Value>);

impl About {
    /// The matrix from world space to the camera's: x to the right, y up, and the camera looks along -z. 16 numbers row by row, to be
    /// multiplied by row vectors from the left, as OpenEXR has it.
    pub const WORLD_TO_CAMERA: &'static str = "worldToCamera";
    /// The matrix from world space to the image: x and y are -1 to 1 from left to right and from bottom to top, after a division by
    /// the last component; likewise.
    pub const WORLD_TO_NDC: &'static str = "worldToNDC";

    /// Adds a fact, or changes it.
    #[must_use]
    pub fn with(mut self, name: &str, fact: impl Into<Value>) -> About {
        self.0.insert(name.to_owned(), fact.into());
        self
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The facts.
    pub fn facts(&self) -> &Map<String, Value> {
        &self.0
    }

    /// A matrix of them.
    pub fn matrix(&self, name: &str) -> Option<[f32; 16]> {
        let numbers = self.0.get(name)?.as_array()?.iter().map(|number| Some(number.as_f64()? as f32));
        numbers.collect::<Option<Vec<f32>>>()?.try_into().ok()
    }

    /// As JSON in ASCII.
    pub fn json(&self) -> String {
        let mut text = String::new();
        for letter in Value::Object(self.0.clone()).to_string().chars() {
            if letter.is_ascii() {
                text.push(letter);
            } else {
                let mut units = [0; 2];
                text.extend(letter.encode_utf16(&mut units).iter().map(|unit| format!("\\u{unit:04x}")));
            }
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn facts_are_json_in_ascii_whatever_names_have() {
        let about = About::default().with("scene", "café \"1\"\n𝄞").with("samples", 3).with("noise", 0.5);
        let text = about.json();
        assert!(text.is_ascii() && !text.contains('\n'), "{text}");
        let again: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(again, Value::Object(about.facts().clone()));
    }

    #[test]
    fn a_matrix_has_sixteen_numbers() {
        let numbers: Vec<f32> = (0..16).map(|i| i as f32 / 4.0).collect();
        let about = About::default().with(About::WORLD_TO_NDC, numbers.clone()).with("few", numbers[..3].to_vec());
        assert_eq!(about.matrix(About::WORLD_TO_NDC).map(Vec::from), Some(numbers));
        assert_eq!((about.matrix("few"), about.matrix("none")), (None, None));
    }
}
