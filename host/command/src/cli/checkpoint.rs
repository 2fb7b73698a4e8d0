//! Films that are kept while they are rendered, to be gone on with.

use std::cell::Cell;
use std::fs::{self, File};
use std::io::{self, BufReader, ErrorKind};
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;

use super::{console, seconds};
use crate::error::{Error, Result};
use crate::output::{self, Destination};
use eyerays::film::{Film, Identity};
use eyerays::view::View;

/// What is kept, and gone on with.
#[derive(Args, Clone)]
#[command(next_help_heading = "Parts")]
pub(super) struct CheckpointArgs {
    /// Keep the film here, to go on with it later [default: the output's name and .film, of what takes longer than a minute, until the
    /// picture is done]
    #[arg(long, value_name = "FILE", conflicts_with = "repeat")]
    checkpoint: Option<PathBuf>,
    /// Write it every so many seconds, 0 for only at the end
    #[arg(long, value_name = "S", value_parser = seconds, default_value = "60", conflicts_with = "repeat")]
    checkpoint_every: Duration,
    /// Go on with a film that was kept, if there is one: only what it has not is rendered
    #[arg(long, conflicts_with = "repeat")]
    resume: bool,
}

/// A picture that takes longer is kept without being asked.
const LONG: Duration = Duration::from_secs(60);

/// Where a film is kept.
pub(super) struct Checkpoint {
    path: PathBuf,
    /// Was it asked for? Then it stays.
    stays: bool,
    every: Duration,
    resume: bool,
    /// Is what is there this rendering's?
    is_own: Cell<bool>,
    /// Samples of all pixels that it has.
    kept: Cell<u64>,
}

impl CheckpointArgs {
    /// Was a place asked for?
    pub fn is_named(&self) -> bool {
        self.checkpoint.is_some()
    }

    /// Is a film to be kept or gone on with?
    pub fn is_asked(&self) -> bool {
        self.is_named() || self.resume
    }

    /// For a picture; none where nothing can be kept beside it. What is there is not replaced unless it is gone on with.
    pub fn beside(&self, destination: &Destination, quiet: bool) -> Result<Option<Checkpoint>> {
        if self.is_named() && destination.is_film() {
            return Err(Error::new("--checkpoint: a .film output is kept as it is; leave the option out"));
        }
        let (path, stays) = match (&self.checkpoint, destination.file()) {
            (Some(path), _) => (path.clone(), true),
            (None, Some(output)) if destination.is_film() => (output.to_owned(), true),
            (None, Some(output)) if output::can_replace(destination) => {
                let mut name = output.as_os_str().to_owned();
                name.push(format!(".{}", Film::ENDING));
                (name.into(), false)
            }
            _ if self.resume => return Err(Error::new("--resume: name the film with --checkpoint")),
            _ => return Ok(None),
        };
        let place = Destination::File(path.clone());
        if stays && !place.is_film() {
            let name = path.display();
            return Err(Error::new(format!("--checkpoint {name}: the name of a film ends in .{}", Film::ENDING)));
        }
        if stays {
            output::check_writable(&place)?;
            if !output::can_replace(&place) {
                return Err(Error::file(&path, "is no regular file, and a film is to be read again; name a file"));
            }
        }
        if path.exists() && !self.resume && !destination.is_film() {
            let there = "is there from before: --resume goes on with it";
            if stays {
                return Err(Error::file(&path, format!("{there}, or remove it")));
            }
            super::warn(&[format!("{} {there}; this rendering keeps none", path.display())], quiet);
            return Ok(None);
        }
        Ok(Some(Checkpoint {
            path,
            stays,
            every: self.checkpoint_every,
            resume: self.resume,
            is_own: Cell::new(false),
            kept: Cell::new(0),
        }))
    }
}

impl Checkpoint {
    /// Does it stay when the picture is done?
    pub fn stays(&self) -> bool {
        self.stays
    }

    /// The film to go on with, if there is one. One that is cut off or damaged is as good as none; all else that is not of this
    /// picture is refused.
    pub fn film(&self, identity: &Identity, view: &View, quiet: bool) -> Result<Option<Film>> {
        if !self.resume {
            return Ok(None);
        }
        let none = |why: String| {
            super::warn(&[format!("{why}: rendering from the first sample")], quiet);
            Ok(None)
        };
        match read(&self.path) {
            Ok(None) => none(format!("there is no {}", self.path.display())),
            Ok(Some(film)) => {
                film.identity.check(identity).map_err(|error| error.of(&self.path))?;
                self.check(&film, view)?;
                self.is_own.set(true);
                self.kept.set(film.volume());
                Ok(Some(film))
            }
            Err(error) if matches!(error.fault(), eyerays::error::Error::BrokenFilm(_)) => {
                self.is_own.set(true);
                none(error.to_string())
            }
            Err(error) => Err(error.into()),
        }
    }

    /// Refuses a film that has more than is asked for.
    fn check(&self, film: &Film, view: &View) -> Result<()> {
        let whole = view.whole();
        match film.coverage().parts().iter().find(|&part| whole.both(part).as_ref() != Some(part)) {
            Some(part) => {
                let fault =
                    format!("it has {part}, which is more than {whole}: ask for all of it, or name another film");
                Err(Error::file(&self.path, fault))
            }
            None => Ok(()),
        }
    }

    /// Whether it is time to keep a film of a rendering that takes about so long as a whole.
    pub fn is_due(&self, since: Duration, whole: Duration) -> bool {
        !self.every.is_zero() && since >= self.every && (self.stays || whole > LONG)
    }

    /// Keeps a film, unless more is kept already: a device that took over from one that failed begins again.
    pub fn keep(&self, film: &Film) -> Result<()> {
        let volume = film.volume();
        if volume >= self.kept.get() {
            write(film, &self.path)?;
            self.is_own.set(true);
            self.kept.set(volume);
        }
        Ok(())
    }

    /// Ends with a picture that was written, all of it or not.
    pub fn end(&self, film: &Film, is_whole: bool, quiet: bool) -> Result<()> {
        if self.stays || !is_whole {
            self.keep(film)?;
            if !is_whole && !quiet {
                console::say(format_args!("{} has what is done: --resume goes on with it", self.path.display()));
            }
            return Ok(());
        }
        if !self.is_own.get() {
            return Ok(());
        }
        match fs::remove_file(&self.path) {
            Err(error) if error.kind() != ErrorKind::NotFound => {
                Err(Error::file(&self.path, format!("can't be removed: {error}")))
            }
            _ => Ok(()),
        }
    }
}

/// Writes a film so that it outlives a loss of power.
pub(super) fn write(film: &Film, path: &Path) -> Result<()> {
    output::write_durably(path, |out| Ok(film.write(out)?))
}

/// Reads a film, if there is a file.
pub(super) fn read(path: &Path) -> eyerays::error::Result<Option<Film>> {
    let unread = |error: io::Error| eyerays::error::Error::file(path, format!("cannot be read: {error}"));
    match fs::metadata(path) {
        // To open a pipe waits for a writer.
        Ok(found) if !found.is_file() => Err(eyerays::error::Error::file(path, "is no regular file; name a film")),
        Ok(_) => {
            let file = File::open(path).map_err(unread)?;
            Ok(Some(Film::read(&mut BufReader::new(file)).map_err(|error| error.of(path))?))
        }
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(unread(error)),
    }
}
