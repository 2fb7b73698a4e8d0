//! What is no file: standard output, devices and pipes.

use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::Path;

use super::write_error;
use crate::error::{Error, Result};

/// Standard output. Once its reader is gone, as `head` is after ten lines, what is written to it is dropped: the reader
/// has what it wanted.
pub(super) struct Stdout(io::StdoutLock<'static>);

impl Stdout {
    pub fn lock() -> Self {
        Stdout(io::stdout().lock())
    }
}

impl Write for Stdout {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        unless_read(self.0.write(bytes), bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        unless_read(self.0.flush(), ())
    }
}

/// `done` where the reader is gone.
fn unless_read<T>(result: io::Result<T>, done: T) -> io::Result<T> {
    match result {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(done),
        other => other,
    }
}

pub(super) fn write_through(writer: impl Write, fill: impl FnOnce(&mut dyn Write) -> Result<()>) -> Result<()> {
    let mut writer = BufWriter::new(writer);
    fill(&mut writer)?;
    writer.flush().map_err(|e| write_error(&e))
}

pub(super) fn open_special(path: &Path) -> Result<File> {
    OpenOptions::new().write(true).open(path).map_err(|e| Error::file(path, write_error(&e).message))
}

/// Whether opening waits for a reader, or would let one read an end of file too early.
#[cfg(unix)]
pub(super) fn blocks_on_open(path: &Path) -> bool {
    use std::os::unix::fs::FileTypeExt;
    std::fs::metadata(path).is_ok_and(|found| found.file_type().is_fifo())
}

#[cfg(not(unix))]
pub(super) fn blocks_on_open(_: &Path) -> bool {
    false
}
