//! Whatever can be wrong with a scene, with settings and with devices.

use std::fmt::{self, Display};
use std::io::{self, ErrorKind};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use crate::line::one_line;

/// The result of everything that can fail on what the caller gave.
pub type Result<T> = std::result::Result<T, Error>;

/// What was wrong. It displays as one line without a full stop:
/// `scenes/cornell.toml:12: unknown key "colour"; did you mean "color"?`.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A fault of a file, or one that came of what it says.
    At {
        /// The file.
        file: PathBuf,
        /// The line in it, from 1.
        line: Option<usize>,
        /// What is wrong there, which is no [`Error::At`].
        fault: Box<Error>,
    },
    /// What a file, a scene or a picture can't be, and what to change in it.
    Fault(String),
    /// A name that no value has.
    UnknownName {
        /// The name.
        name: String,
        /// Those that there are.
        names: Vec<&'static str>,
    },
    /// A setting out of its range.
    OutOfRange {
        /// The field of [`crate::scene::Settings`].
        setting: &'static str,
        /// What it is.
        value: String,
        /// The least that it may be.
        least: String,
        /// The most that it may be.
        most: String,
    },
    /// A picture that is empty or too large.
    Size {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// The most of both.
        most_side: u32,
        /// The most pixels.
        most_pixels: u64,
    },
    /// Too little memory for a picture of this size.
    Memory {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// Films of different pictures, or a film of another picture than the one that is to be gone on with.
    OtherFilm {
        /// What differs.
        what: String,
        /// What it is in one.
        one: String,
        /// And in the other.
        other: String,
    },
    /// Films of one picture that keep other layers.
    OtherLayers {
        /// The names of those of one, or "none".
        one: String,
        /// And of the other.
        other: String,
    },
    /// A film that is cut off or damaged, which no reading brings back.
    BrokenFilm(&'static str),
    /// A picture that ends by its noise, of an integrator that has none.
    NoNoise {
        /// The integrator's name.
        integrator: &'static str,
    },
    /// Floats of 16 bits, in a format that has none.
    NoHalf {
        /// The format's name.
        format: &'static str,
    },
    /// A picture that tells how opaque it is, in a format that has no place for that.
    NoAlpha {
        /// The format's name.
        format: &'static str,
    },
    /// A tone map, in a format that keeps light as it is.
    NoTone {
        /// The format's name.
        format: &'static str,
    },
    /// Layers, in a format that has none.
    NoLayers {
        /// The format's name.
        format: &'static str,
    },
    /// So many threads can't be started.
    Threads {
        /// How many.
        threads: usize,
        /// What the system says.
        message: String,
    },
    /// Several devices in another precision than exact, in which they would give different pictures.
    SeveralInexact,
    /// Reference precision, which is the CPU's alone, on a GPU.
    ReferenceOnGpu,
    /// This machine has no GPU, or no driver of it.
    NoGpu,
    /// This machine has other GPUs.
    NoSuchAdapter {
        /// The name or number that was asked for.
        wish: String,
        /// The names of those that there are, by number.
        names: Vec<String>,
    },
    /// There is no GPU but one in software, which is taken only where it is asked for.
    OnlySoftware {
        /// Its name.
        device: String,
    },
    /// Exact precision on a GPU that can't promise it: it needs Vulkan, and kernels that no translator changes.
    Inexact {
        /// The GPU's name.
        device: String,
        /// Is it able to, were the kernels not translated by naga?
        by_naga: bool,
    },
    /// Votes across the lanes of a subgroup, on a GPU without subgroups.
    NoSubgroups {
        /// The GPU's name.
        device: String,
    },
    /// More lights than a GPU takes.
    TooManyLights {
        /// The GPU's name.
        device: String,
        /// How many there are.
        lights: usize,
        /// How many it takes.
        most: u64,
    },
    /// A buffer larger than those of a GPU.
    TooLarge {
        /// The GPU's name.
        device: String,
        /// What the buffer is for.
        what: Content,
        /// Its size.
        bytes: u64,
        /// The largest that it may have.
        limit: u64,
    },
    /// A GPU that can't be opened.
    NotOpened {
        /// Its name.
        device: String,
        /// What its driver says.
        message: String,
    },
    /// A GPU that failed at work.
    DeviceFailed {
        /// Its name.
        device: String,
        /// What its driver says.
        message: String,
    },
}

/// What a GPU's buffer holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Content {
    /// A part of the scene, by its name: `triangles`.
    Scene(String),
    /// All of the scene.
    WholeScene,
    /// What a block of pixels needs.
    Block,
    /// So many rays.
    Rays(u64),
}

impl Error {
    /// A fault that no file is to blame for.
    pub fn new(message: impl Into<String>) -> Self {
        Error::Fault(message.into())
    }

    /// A fault of a file.
    pub fn file(file: &Path, message: impl Into<String>) -> Self {
        Error::new(message).of(file)
    }

    /// A fault of one line of a file, counted from 1.
    pub fn line(file: &Path, line: usize, message: impl Into<String>) -> Self {
        Error::At { file: file.to_owned(), line: Some(line), fault: Box::new(Error::new(message)) }
    }

    /// A fault of a writer, in words that say what to do.
    pub fn writing(error: &io::Error) -> Self {
        Error::new(match error.kind() {
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
                "no space left; free some or write elsewhere".to_owned()
            }
            ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
                "no permission to write; change it or write elsewhere".to_owned()
            }
            ErrorKind::NotFound | ErrorKind::NotADirectory => {
                "the folder does not exist; create it or write elsewhere".to_owned()
            }
            ErrorKind::IsADirectory => "is a directory; name a file".to_owned(),
            ErrorKind::InvalidFilename => "the name is too long or invalid; choose another".to_owned(),
            ErrorKind::FileTooLarge => {
                "it would be larger than files may be; raise the limit (ulimit -f) or write elsewhere".to_owned()
            }
            ErrorKind::BrokenPipe => "the reading program has ended".to_owned(),
            _ => format!("cannot be written: {error}"),
        })
    }

    /// The same fault, of this file if it names none.
    pub fn of(self, file: &Path) -> Self {
        match self {
            Error::At { .. } => self,
            fault => Error::At { file: file.to_owned(), line: None, fault: Box::new(fault) },
        }
    }

    /// The file that is to blame, if one is, and the line in it.
    pub fn place(&self) -> Option<(&Path, Option<usize>)> {
        match self {
            Error::At { file, line, .. } => Some((file, *line)),
            _ => None,
        }
    }

    /// The fault without its place.
    pub fn fault(&self) -> &Error {
        match self {
            Error::At { fault, .. } => fault.fault(),
            fault => fault,
        }
    }

    /// The fault without its place in words, with whatever characters names have.
    pub fn message(&self) -> String {
        match self {
            Error::At { fault, .. } => fault.message(),
            Error::Fault(message) => message.clone(),
            Error::UnknownName { name, names } => format!("\"{name}\" is none of {}", names.join(", ")),
            Error::OutOfRange { setting, value, least, most } => {
                format!("{setting} {value} is not within {least} to {most}")
            }
            Error::Size { width, height, .. } if *width == 0 || *height == 0 => {
                format!("an image of {width}x{height} pixels is empty; both sides must be at least 1")
            }
            Error::Size { width, height, most_side, most_pixels } => format!(
                "an image of {width}x{height} pixels is too large; a side is at most {most_side} and all at most {most_pixels} pixels"
            ),
            Error::Memory { width, height } => {
                format!("too little memory for an image of {width}x{height} pixels; choose a smaller size")
            }
            Error::OtherFilm { what, one, other } => {
                format!("a film of another picture: {what} is {one} in one and {other} in the other")
            }
            Error::OtherLayers { one, other } => {
                format!("a film that keeps other layers: {one} in one and {other} in the other; ask for the same")
            }
            Error::BrokenFilm(what) => format!("the film is {what}; render this part again"),
            Error::NoNoise { integrator } => {
                format!("the integrator {integrator} does not sample, so that its pictures have no noise to end by")
            }
            Error::NoHalf { format } => format!("floats of 16 bits are for .exr files, not for {format}"),
            Error::NoAlpha { format } => format!("transparency is for .png and .exr files, not for {format}"),
            Error::NoTone { format } => format!("tone maps are for .png files, not for {format}"),
            Error::NoLayers { format } => format!("layers are for .exr files, not for {format}"),
            Error::Threads { threads, message } => format!("can't start {threads} threads ({message})"),
            Error::SeveralInexact => "several devices give one picture in exact precision only".to_owned(),
            Error::ReferenceOnGpu => "reference precision is double precision on the CPU".to_owned(),
            Error::NoGpu => "there is no GPU that Vulkan, Metal or Direct3D 12 can use: install its driver".to_owned(),
            Error::NoSuchAdapter { wish, names } => {
                let list: Vec<String> = names.iter().enumerate().map(|(i, name)| format!("{i} \"{name}\"")).collect();
                format!("no adapter matches \"{wish}\": there is {}", list.join(", "))
            }
            Error::OnlySoftware { device } => format!("no hardware GPU; \"{device}\" is software"),
            Error::Inexact { device, by_naga } => {
                let without = if *by_naga { "a translation by naga".to_owned() } else { format!("\"{device}\"") };
                format!("exact precision needs Vulkan with SPIR-V passthrough, which {without} is without")
            }
            Error::NoSubgroups { device } => format!("\"{device}\" has no subgroups to vote in"),
            Error::TooManyLights { device, lights, most } => {
                format!("the scene has {lights} lights, but \"{device}\" takes at most {most}")
            }
            Error::TooLarge { device, what, bytes, limit } => match what {
                Content::Scene(name) => {
                    format!(
                        "the scene's {name} would take {bytes} bytes, but \"{device}\" has buffers of at most {limit}"
                    )
                }
                Content::WholeScene => {
                    format!("the scene takes {bytes} bytes, but \"{device}\" has {limit} bytes of memory")
                }
                Content::Block => {
                    format!("a block of pixels needs buffers of {bytes} bytes, but \"{device}\" has at most {limit}")
                }
                Content::Rays(count) => {
                    format!("{count} rays take {bytes} bytes, but \"{device}\" has buffers of at most {limit}")
                }
            },
            Error::NotOpened { device, message } => format!("can't open \"{device}\": {message}"),
            Error::DeviceFailed { device, message } => format!("\"{device}\" failed: {message}"),
        }
    }
}

/// Refuses the first of a setting's numbers that is out of range.
pub(crate) fn within<T: Display + PartialOrd>(
    setting: &'static str,
    values: &[T],
    range: RangeInclusive<T>,
) -> Result<()> {
    match values.iter().find(|value| !range.contains(value)) {
        Some(value) => {
            let [value, least, most] = [value, range.start(), range.end()].map(T::to_string);
            Err(Error::OutOfRange { setting, value, least, most })
        }
        None => Ok(()),
    }
}

impl Display for Error {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((file, line)) = self.place() {
            write!(out, "{}", one_line(&file.to_string_lossy()))?;
            if let Some(line) = line {
                write!(out, ":{line}")?;
            }
            out.write_str(": ")?;
        }
        out.write_str(&one_line(&self.message()))
    }
}
