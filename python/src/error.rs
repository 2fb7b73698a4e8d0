//! Errors in the kinds that Python has.

use std::path::Path;

use eyerays::error::Error;
use pyo3::PyErr;
use pyo3::exceptions::{PyFileNotFoundError, PyMemoryError, PyRuntimeError, PyValueError};

/// One line, as the program has it, of the kind that fits.
pub fn raised(error: Error) -> PyErr {
    raised_of(error, &[])
}

/// The same, of texts that are no files but are called as if they were.
pub fn raised_of(error: Error, texts: &[&Path]) -> PyErr {
    let text = error.to_string();
    if error.place().is_some_and(|(file, _)| !texts.contains(&file) && !file.exists()) {
        return PyFileNotFoundError::new_err(text);
    }
    match error.fault() {
        Error::Memory { .. } | Error::TooLarge { .. } => PyMemoryError::new_err(text),
        Error::Threads { .. }
        | Error::NoGpu
        | Error::NoSuchAdapter { .. }
        | Error::OnlySoftware { .. }
        | Error::Inexact { .. }
        | Error::NotOpened { .. }
        | Error::DeviceFailed { .. } => PyRuntimeError::new_err(text),
        _ => PyValueError::new_err(text),
    }
}

/// An error of either side.
pub struct Raised(pub PyErr);

impl From<Error> for Raised {
    fn from(error: Error) -> Self {
        Raised(raised(error))
    }
}

impl From<PyErr> for Raised {
    fn from(error: PyErr) -> Self {
        Raised(error)
    }
}
