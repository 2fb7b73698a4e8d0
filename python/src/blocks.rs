//! Work on many rays in blocks, between which Python is heard.

use std::ops::Range;

use pyo3::prelude::*;

/// Does the work on `count` rays, at most `most` at once, without holding Python up: ctrl-c ends it between blocks, and `progress` is
/// called with how many are done and how many there are.
///
/// # Errors
/// Those of the work, and what Python raises meanwhile.
pub fn each(
    py: Python<'_>,
    (count, most): (usize, usize),
    progress: Option<&Bound<'_, PyAny>>,
    mut work: impl FnMut(Range<usize>) -> PyResult<()> + Send,
) -> PyResult<()> {
    for start in (0..count).step_by(most) {
        let block = start..count.min(start + most);
        py.detach(|| work(block.clone()))?;
        py.check_signals()?;
        if let Some(progress) = progress {
            progress.call1((block.end, count))?;
        }
    }
    Ok(())
}

/// Lets Python be heard where `done` of `count` rays are done, while other threads may run.
///
/// # Errors
/// What Python raises meanwhile.
pub fn heard(progress: Option<&Py<PyAny>>, (done, count): (usize, usize)) -> PyResult<()> {
    Python::attach(|py| {
        py.check_signals()?;
        progress.map_or(Ok(()), |progress| progress.call1(py, (done, count)).map(drop))
    })
}
