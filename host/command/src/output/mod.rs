//! Where results go: whole files or none, and devices, pipes and standard output as they come.

mod apart;
mod stream;
mod target;
mod temporary;
#[cfg(test)]
mod tests;

use std::ffi::OsString;
use std::fmt;
use std::fs::{self, File};
use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
pub use apart::{check_apart, check_own};
use eyerays::film::Film;
use eyerays::image::{Encoding, Format, encode, encode_layers};
use eyerays::layers::{Layer, Values};
use eyerays::picture::Picture;
use stream::{Stdout, blocks_on_open, open_special, write_through};
use target::Target;
use temporary::Temporary;
pub use temporary::{Discarded, discard};

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
    /// The path, if it is one.
    pub fn file(&self) -> Option<&Path> {
        match self {
            Destination::Stdout => None,
            Destination::File(path) => Some(path),
        }
    }

    /// Is it a film, by its name's ending, and no picture?
    pub fn is_film(&self) -> bool {
        self.file().and_then(Path::extension).is_some_and(|ending| ending.eq_ignore_ascii_case(Film::ENDING))
    }

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
                _ => Err(error.into()),
            }),
        }
    }

    /// Writes what `fill` gives: a file as [`write_atomically`], standard output as it comes, for as long as somebody
    /// reads it.
    ///
    /// # Errors
    /// Those of `fill`, and a destination that cannot be written.
    pub fn write(&self, fill: impl FnOnce(&mut dyn Write) -> Result<()>) -> Result<()> {
        match self {
            Destination::Stdout => write_through(Stdout::lock(), fill)
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

/// Whether what is written there can be written again in its place: a file, as against a pipe.
pub fn can_replace(destination: &Destination) -> bool {
    destination.file().is_some_and(|path| matches!(Target::of(path), Ok(Target::Regular { .. })))
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
    written(path, fill, |_| Ok(()))
}

/// The same, and it is on the disk before it takes its name: a loss of power leaves the old file or the new one.
///
/// # Errors
/// As [`write_atomically`].
pub fn write_durably(path: &Path, fill: impl FnOnce(&mut dyn Write) -> Result<()>) -> Result<()> {
    written(path, fill, File::sync_all)
}

fn written(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> Result<()>,
    settle: impl FnOnce(&File) -> io::Result<()>,
) -> Result<()> {
    let written = match Target::of(path)? {
        Target::Special => write_through(open_special(path)?, fill),
        Target::Regular { place, permissions } => {
            let temporary = Temporary::beside(path, &place)?;
            write_through(&temporary.file, fill).and_then(|()| {
                if let Some(permissions) = permissions {
                    // Some file systems have none; the contents matter more.
                    let _ = temporary.file.set_permissions(permissions);
                }
                settle(&temporary.file).and_then(|()| temporary.rename(&place)).map_err(|e| write_error(&e))
            })
        }
    };
    written.map_err(|error| Error { file: error.file.or_else(|| Some(path.to_owned())), ..error })
}

/// Writes a picture to where it belongs, in the format that the place asks for.
///
/// # Errors
/// An unknown format and those of [`encode`] and [`Destination::write`].
pub fn write_picture(picture: &Picture, destination: &Destination, encoding: &Encoding) -> Result<()> {
    let format = destination.format()?;
    destination.write(|out| Ok(encode(picture, format, encoding, out)?))
}

/// The same with layers beside the picture, as an EXR.
///
/// # Errors
/// Layers for another format, and as [`write_picture`].
pub fn write_layers(
    picture: &Picture,
    layers: &[(Layer, Values)],
    destination: &Destination,
    encoding: &Encoding,
) -> Result<()> {
    if layers.is_empty() {
        return write_picture(picture, destination, encoding);
    }
    check_layers(destination)?;
    destination.write(|out| Ok(encode_layers(picture, layers, encoding, out)?))
}

/// Whether a place may hold layers.
///
/// # Errors
/// Its format has none.
pub fn check_layers(destination: &Destination) -> Result<()> {
    match destination.format()? {
        Format::Exr => Ok(()),
        format => Err(eyerays::error::Error::NoLayers { format: format.name() }.into()),
    }
}

/// Whether a place may tell how opaque a picture is.
///
/// # Errors
/// Its format has no place for that.
pub fn check_alpha(destination: &Destination) -> Result<()> {
    match destination.format()? {
        Format::Png | Format::Exr => Ok(()),
        format => Err(eyerays::error::Error::NoAlpha { format: format.name() }.into()),
    }
}

/// An error of a writer in words that say what to do, without the file's name.
pub fn write_error(error: &io::Error) -> Error {
    eyerays::error::Error::writing(error).into()
}
