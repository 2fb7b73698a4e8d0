//! What can go wrong, each in one line.

/// The result of every fallible function here.
pub type Result<T> = std::result::Result<T, Error>;

/// A module that a pass cannot work on.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// The words are no SPIR-V module, or not one that the kernels' compiler writes.
    #[error("unexpected SPIR-V: {0}")]
    Malformed(String),
    /// No entry point has this name.
    #[error("no entry point is named `{0}`")]
    NoEntry(String),
    /// Two entry points have one name.
    #[error("two entry points are named `{0}`; rename one")]
    DuplicateEntry(String),
}
