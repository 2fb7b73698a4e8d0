//! Where results go: whole files or none, and devices, pipes and standard output as they come.

use std::ffi::OsString;
use std::fmt;
use std::fs::{self, File, OpenOptions, Permissions};
use std::io::{self, BufWriter, ErrorKind, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use crate::error::{Error, Result};
use crate::image::Format;

/// Where an output goes. `-` on the command line is standard output.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Destination {
    /// Standard output, which takes PNG.
    Stdout,
    /// A file, device or pipe.
    File(PathBuf),
}

impl From<OsString> for Destination {
    fn from(name: OsString) -> Self {
        if name == "-" { Destination::Stdout } else { Destination::File(name.into()) }
    }
}

impl From<&Path> for Destination {
    fn from(path: &Path) -> Self {
        path.as_os_str().to_owned().into()
    }
}

impl fmt::Display for Destination {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Destination::Stdout => out.write_str("standard output"),
            Destination::File(path) => path.display().fmt(out),
        }
    }
}

impl Destination {
    /// The image format: by the extension, and PNG for standard output and for a device or a
    /// pipe whose name has none.
    ///
    /// # Errors
    /// As [`Format::from_path`].
    pub fn format(&self) -> Result<Format> {
        match self {
            Destination::Stdout => Ok(Format::Png),
            Destination::File(path) => Format::from_path(path).or_else(|error| match fs::metadata(path) {
                Ok(found) if !found.is_file() && !found.is_dir() => Ok(Format::Png),
                _ => Err(error),
            }),
        }
    }

    /// Writes what `fill` gives: a file as [`write_atomically`], standard output as it comes.
    ///
    /// # Errors
    /// Those of `fill`, and a destination that cannot be written.
    pub fn write(&self, fill: impl FnOnce(&mut dyn Write) -> Result<()>) -> Result<()> {
        match self {
            Destination::Stdout => write_through(io::stdout().lock(), fill)
                .map_err(|fault| Error { message: format!("standard output: {}", fault.message), ..fault }),
            Destination::File(path) => write_atomically(path, fill),
        }
    }
}

/// Fails early where [`Destination::write`] would fail late, after a long rendering. It neither
/// changes nor leaves a file; only the space left on the disk it cannot foresee.
///
/// # Errors
/// A terminal as standard output, and for files what [`write_atomically`] refuses.
pub fn check_writable(destination: &Destination) -> Result<()> {
    match destination {
        Destination::Stdout if io::stdout().is_terminal() => {
            Err(Error::new("standard output is a terminal; redirect it or name a file"))
        }
        Destination::Stdout => Ok(()),
        Destination::File(path) => match Target::of(path)? {
            Target::Regular { place, .. } => Temporary::beside(path, &place).map(drop),
            Target::Special if blocks_on_open(path) => Ok(()),
            Target::Special => open_special(path).map(drop),
        },
    }
}

/// Writes a file whole or not at all: under a temporary name in the same folder that is renamed
/// at the end and removed on any failure, so that an old file stays until the new one is there.
/// A symbolic link is followed, and the permissions of an old file are kept. What exists and is
/// no regular file (`/dev/null`, a FIFO) is written straight to.
///
/// # Errors
/// Those of `fill`, with `path` added if they name no file; a folder that is missing or not
/// writable; a directory or a read-only file as `path`; a full disk.
pub fn write_atomically(path: &Path, fill: impl FnOnce(&mut dyn Write) -> Result<()>) -> Result<()> {
    let written = match Target::of(path)? {
        Target::Special => write_through(open_special(path)?, fill),
        Target::Regular { place, permissions } => {
            let temporary = Temporary::beside(path, &place)?;
            write_through(&temporary.file, fill).and_then(|()| {
                if let Some(permissions) = permissions {
                    // Some file systems have none; the contents matter more.
                    let _ = temporary.file.set_permissions(permissions);
                }
                temporary.rename(&place).map_err(|e| write_error(&e))
            })
        }
    };
    written.map_err(|error| Error { file: error.file.or_else(|| Some(path.to_owned())), ..error })
}

/// An error of a writer in words that say what to do, without the file's name.
pub fn write_error(error: &io::Error) -> Error {
    Error::new(match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => "no space left; free some or write elsewhere".to_owned(),
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            "no permission to write; change it or write elsewhere".to_owned()
        }
        ErrorKind::NotFound | ErrorKind::NotADirectory => {
            "the folder does not exist; create it or write elsewhere".to_owned()
        }
        ErrorKind::IsADirectory => "is a directory; name a file".to_owned(),
        ErrorKind::InvalidFilename => "the name is too long or invalid; choose another".to_owned(),
        ErrorKind::BrokenPipe => "the reading program has ended".to_owned(),
        _ => format!("cannot be written: {error}"),
    })
}

/// What a path stands for before anything is written.
enum Target {
    /// A file at `place` (links followed), there already if it has permissions.
    Regular { place: PathBuf, permissions: Option<Permissions> },
    /// A device, pipe or socket.
    Special,
}

impl Target {
    fn of(path: &Path) -> Result<Self> {
        let fault = |error: io::Error| Error::file(path, write_error(&error).message);
        match fs::metadata(path) {
            Ok(found) if found.is_dir() => Err(fault(ErrorKind::IsADirectory.into())),
            Ok(found) if found.is_file() => {
                // A rename would replace even a read-only file.
                OpenOptions::new().write(true).open(path).map_err(fault)?;
                Ok(Target::Regular {
                    place: fs::canonicalize(path).map_err(fault)?,
                    permissions: Some(found.permissions()),
                })
            }
            Ok(_) => Ok(Target::Special),
            Err(_) if path.as_os_str().is_empty() => Err(Error::new("the output's name is empty; name a file")),
            Err(error) if error.kind() == ErrorKind::NotFound => {
                let name = path.as_os_str().as_encoded_bytes();
                if name.last().is_some_and(|&c| std::path::is_separator(c.into())) {
                    return Err(fault(ErrorKind::IsADirectory.into()));
                }
                Ok(Target::Regular { place: path.to_owned(), permissions: None })
            }
            Err(error) => Err(fault(error)),
        }
    }
}

/// A file that is removed when dropped, unless it was renamed.
struct Temporary {
    path: PathBuf,
    file: File,
    renamed: bool,
}

impl Temporary {
    /// A new file in the folder of `place`; errors name `path`, as the user gave it.
    fn beside(path: &Path, place: &Path) -> Result<Self> {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        loop {
            let count = COUNT.fetch_add(1, Ordering::Relaxed);
            let name = format!(".eyerays-{}-{count}.tmp", std::process::id());
            let temporary = place.with_file_name(name);
            match File::create_new(&temporary) {
                Ok(file) => {
                    return Ok(Temporary { path: temporary, file, renamed: false });
                }
                // Left by a killed process of the same number.
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(Error::file(path, write_error(&error).message)),
            }
        }
    }

    fn rename(mut self, place: &Path) -> io::Result<()> {
        fs::rename(&self.path, place)?;
        self.renamed = true;
        Ok(())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if !self.renamed {
            // There is an earlier error to tell, or none to tell it to.
            let _ = fs::remove_file(&self.path);
        }
    }
}

fn write_through(writer: impl Write, fill: impl FnOnce(&mut dyn Write) -> Result<()>) -> Result<()> {
    let mut writer = BufWriter::new(writer);
    fill(&mut writer)?;
    writer.flush().map_err(|e| write_error(&e))
}

fn open_special(path: &Path) -> Result<File> {
    OpenOptions::new().write(true).open(path).map_err(|e| Error::file(path, write_error(&e).message))
}

/// Whether opening waits for a reader, or would let one read an end of file too early.
#[cfg(unix)]
fn blocks_on_open(path: &Path) -> bool {
    use std::os::unix::fs::FileTypeExt;
    fs::metadata(path).is_ok_and(|found| found.file_type().is_fifo())
}

#[cfg(not(unix))]
fn blocks_on_open(_: &Path) -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<OsString> {
        let mut names: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        names
    }

    fn write(path: &Path, bytes: &[u8]) -> Result<()> {
        write_atomically(path, |out| out.write_all(bytes).map_err(|e| write_error(&e)))
    }

    #[test]
    fn a_failure_keeps_the_old_file_and_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.png");
        write(&path, b"old").unwrap();
        let error = write_atomically(&path, |out| {
            out.write_all(&[0; 100_000]).unwrap();
            Err(Error::new("no"))
        });
        assert_eq!(error, Err(Error::file(&path, "no")));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["out.png"]);
        write(&path, b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(names(folder.path()), ["out.png"]);
    }

    #[test]
    fn a_panic_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.png");
        let caught = std::panic::catch_unwind(|| write_atomically(&path, |_| panic!("expected")));
        assert!(caught.is_err());
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn checking_changes_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.png");
        check_writable(&Destination::File(path.clone())).unwrap();
        assert!(names(folder.path()).is_empty());
        fs::write(&path, b"old").unwrap();
        check_writable(&Destination::File(path.clone())).unwrap();
        assert_eq!(names(folder.path()), ["out.png"]);
        assert_eq!(fs::read(&path).unwrap(), b"old");
    }

    #[test]
    fn bad_places_are_refused_early_and_late() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("file"), b"").unwrap();
        for (name, fault) in [
            ("", "is a directory"),
            ("missing/out.png", "does not exist"),
            ("missing/", "is a directory"),
            ("file/out.png", "does not exist"),
            (&"x".repeat(300), "too long"),
        ] {
            let path = folder.path().join(name);
            for result in [check_writable(&path.as_path().into()), write(&path, b"bytes")] {
                let error = result.expect_err(name);
                assert_eq!(error.file.as_deref(), Some(path.as_path()));
                assert!(error.message.contains(fault), "{error}");
            }
        }
        assert!(write(Path::new(""), b"").is_err());
        assert_eq!(names(folder.path()), ["file"]);
    }

    #[test]
    fn a_dash_is_standard_output() {
        assert_eq!(Destination::from(Path::new("-")), Destination::Stdout);
        let file = Destination::from(OsString::from("./-"));
        assert_eq!(file, Destination::File("./-".into()));
        assert_eq!(Destination::Stdout.format(), Ok(Format::Png));
        assert!(file.format().is_err());
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_permissions_kept() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        fs::write(&file, b"old").unwrap();
        fs::set_permissions(&file, Permissions::from_mode(0o640)).unwrap();
        symlink("file", &link).unwrap();
        write(&link, b"new").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&file).unwrap(), b"new");
        assert_eq!(fs::metadata(&file).unwrap().permissions().mode() & 0o777, 0o640);
    }

    #[cfg(unix)]
    #[test]
    fn a_fifo_is_checked_without_waiting_and_never_read_as_an_image() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("fifo.png");
        let made = std::process::Command::new("mkfifo").arg(&path).status();
        assert!(made.unwrap().success());
        check_writable(&path.as_path().into()).unwrap();
        assert!(crate::image::read(&path).is_err());
        std::thread::scope(|scope| {
            scope.spawn(|| write(&path, b"bytes").unwrap());
            assert_eq!(fs::read(&path).unwrap(), b"bytes");
        });
        assert_eq!(names(folder.path()), ["fifo.png"]);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn devices_are_written_straight_to() {
        let full = Path::new("/dev/full");
        check_writable(&full.into()).unwrap();
        let error = write(full, b"bytes").unwrap_err();
        assert_eq!(error.to_string(), "/dev/full: no space left; free some or write elsewhere");
        write(Path::new("/dev/null"), b"bytes").unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
        assert_eq!(Destination::from(full).format(), Ok(Format::Png));
    }
}
