//! Why a device was taken.

use std::fmt;

use crate::error::Error;

/// Why a rendering runs where it does.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Why {
    /// The caller asked for it.
    Asked,
    /// It is a GPU that works.
    Works,
    /// Reference precision is the CPU's alone.
    Reference,
    /// The CPU, since this is wrong with the GPU.
    Instead(Error),
}

impl fmt::Display for Why {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Why::Asked => out.write_str("asked for"),
            Why::Works => out.write_str("a GPU that works"),
            Why::Reference => out.write_str("reference precision is the CPU's"),
            Why::Instead(error) => error.fmt(out),
        }
    }
}
