//! How a file may move.

/// An animation of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Animation {
    /// Its name, or its number in the file.
    pub name: String,
    /// From its start to its last key, as the file says.
    pub seconds: f64,
}
