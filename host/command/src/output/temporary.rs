//! Files under temporary names. None outlives its process for long: it is removed when it is dropped, when a signal
//! ends the process ([`discard`]), and else by the next process that writes in its folder ([`clear`]).
//!
//! That process recognises files still being written by their advisory locks. Only the holder of a file's lock removes
//! or renames it, after checking that the name is still that file's: between opening and locking, another
//! process may have removed it.

use std::ffi::OsStr;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use same_file::Handle;

use super::write_error;
use crate::error::{Error, Result};

/// The temporaries of this process. The list is locked while one is made, renamed or removed.
static OPEN: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn open_ones() -> MutexGuard<'static, Vec<PathBuf>> {
    OPEN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// While it lives, this process neither makes nor renames a temporary file.
#[must_use]
pub struct Discarded {
    _open: MutexGuard<'static, Vec<PathBuf>>,
}

/// Removes what this process has half-written, so that it can exit at once.
pub fn discard() -> Discarded {
    let mut open = open_ones();
    for path in open.drain(..) {
        // The process is ending, so errors can't be reported.
        let _ = fs::remove_file(path);
    }
    Discarded { _open: open }
}

/// A file that is removed when dropped, unless it was renamed.
pub(super) struct Temporary {
    path: PathBuf,
    pub file: File,
}

impl Temporary {
    /// A new file in the folder of `place`; errors name `path`, as the user gave it.
    pub fn beside(path: &Path, place: &Path) -> Result<Self> {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let folder = place.parent().filter(|folder| !folder.as_os_str().is_empty());
        clear(folder.unwrap_or(Path::new(".")));
        loop {
            let count = COUNT.fetch_add(1, Ordering::Relaxed);
            let temporary = place.with_file_name(name(std::process::id(), count));
            let mut open = open_ones();
            match File::create_new(&temporary) {
                Ok(file) if is_taken(&file, &temporary) => {}
                Ok(file) => {
                    open.push(temporary.clone());
                    return Ok(Temporary { path: temporary, file });
                }
                // Left by a killed process of the same number, on a file system without locks.
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(Error::file(path, write_error(&error).message)),
            }
        }
    }

    pub fn rename(self, place: &Path) -> io::Result<()> {
        let mut open = open_ones();
        fs::rename(&self.path, place)?;
        open.retain(|path| *path != self.path);
        Ok(())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        let mut open = open_ones();
        // Not there if it was renamed.
        if let Some(i) = open.iter().position(|path| *path == self.path) {
            open.swap_remove(i);
            // There is an earlier error to report, or nobody to report to.
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Locks a new file. Another process that clears the folder may have been faster: it removes the file then.
fn is_taken(file: &File, path: &Path) -> bool {
    match file.try_lock() {
        // Where the system can't say, assume that nobody took it.
        Ok(()) => is_at(file, path).map_or_else(|error| error.kind() == ErrorKind::NotFound, |here| !here),
        Err(TryLockError::WouldBlock) => true,
        // A file system without locks, where nobody else can lock it either.
        Err(TryLockError::Error(_)) => false,
    }
}

/// Removes the temporaries of processes that were killed.
fn clear(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if is_name(&entry.file_name()) && entry.file_type().is_ok_and(|kind| kind.is_file()) {
            // One in use stays, and so does another user's.
            let _ = remove_if_free(&entry.path());
        }
    }
}

fn remove_if_free(path: &Path) -> io::Result<()> {
    let file = OpenOptions::new().write(true).open(path)?;
    file.try_lock()?;
    if is_at(&file, path)? { fs::remove_file(path) } else { Ok(()) }
}

/// Whether the name is this file's.
fn is_at(file: &File, path: &Path) -> io::Result<bool> {
    Ok(Handle::from_file(file.try_clone()?)? == Handle::from_path(path)?)
}

pub(super) fn name(process: u32, count: u32) -> String {
    format!(".eyerays-{process}-{count}.tmp")
}

/// Whether [`name`] gives it.
fn is_name(found: &OsStr) -> bool {
    let numbers =
        found.to_str().and_then(|found| found.strip_prefix(".eyerays-")?.strip_suffix(".tmp")?.split_once('-'));
    numbers.is_some_and(|(process, count)| process.parse::<u32>().is_ok() && count.parse::<u32>().is_ok())
}
