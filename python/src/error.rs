//! Errors in the kinds that Python has.

use eyerays::error::Error;
use pyo3::PyErr;
use pyo3::exceptions::{PyFileNotFoundError, PyMemoryError, PyRuntimeError, PyValueError};

/// One line, as the program has it, of the kind that fits.
pub fn raised(error: Error) -> PyErr {
    let text = error.to_string();
    if error.place().is_some_and(|(file, _)| !file.exists()) {
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
