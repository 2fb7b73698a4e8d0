//! `eyerays merge`.

use std::path::PathBuf;
use std::process::ExitCode;
use std::slice;

use clap::Args;

use super::checkpoint;
use super::console;
use super::look::Look;
use super::progress;
use crate::error::{Error, Result};
use crate::output::{self, Destination};
use eyerays::film::{Film, Part};

pub(super) const EXAMPLES: &str = "\
Examples:
  eyerays render scene.toml --spp 64 --samples-to 32 -o a.film
  eyerays render scene.toml --spp 64 --samples-from 32 -o b.film
  eyerays merge a.film b.film -o scene.exr

A part is what render writes to a .film file: some of the samples (--samples-from, --samples-to) of the image or of a tile
(--tile). In exact precision parts may come from any devices, and the picture has the bits of one that was rendered at once.";

#[derive(Args)]
pub(super) struct Merge {
    /// Films of parts of one picture, in any order
    #[arg(required = true, value_name = "FILM")]
    parts: Vec<PathBuf>,
    /// The picture, .png, .exr or .hdr; or a .film file, which may have holes
    #[arg(short, long, value_name = "FILE")]
    output: std::ffi::OsString,
    #[command(flatten)]
    look: Look,
}

impl Merge {
    pub fn run(&self, quiet: bool) -> Result<ExitCode> {
        let destination = Destination::from(self.output.clone());
        self.look.check(&destination)?;
        output::check_apart(slice::from_ref(&destination), &self.parts)?;
        output::check_writable(&destination)?;
        let film = progress::stage("merging", quiet, || self.merged())?;
        if destination.is_film() {
            checkpoint::write(&film, destination.file().expect("a film is a file"))?;
        } else {
            whole(&film)?;
            let picture = film.develop()?;
            super::warn(self.look.beyond_white(&picture, &destination)?.as_slice(), quiet);
            self.look.write(&picture, &destination)?;
        }
        if !quiet {
            let parts = super::plural(self.parts.len(), "part");
            console::say(format_args!("{destination}: {} of {parts}", described(&film)));
        }
        Ok(ExitCode::SUCCESS)
    }

    fn merged(&self) -> Result<Film> {
        let mut all: Option<Film> = None;
        for path in &self.parts {
            let film =
                checkpoint::read(path)?.ok_or_else(|| Error::file(path, "there is no such file; check its name"))?;
            match &mut all {
                Some(all) => all.merge(film).map_err(|error| error.of(path))?,
                None => all = Some(film),
            }
        }
        Ok(all.expect("one part at least"))
    }
}

/// Refuses a film of which some pixels have other samples than others.
fn whole(film: &Film) -> Result<()> {
    let parts = film.coverage().parts();
    let samples = parts.iter().map(|part| part.samples.clone()).reduce(|a, b| a.start.min(b.start)..a.end.max(b.end));
    let Some(samples) = samples else { return Err(Error::new("the films have no samples: render some")) };
    let missing = film.coverage().missing(&Part { region: film.window(), samples });
    match &missing[..] {
        [] => Ok(()),
        [hole, ..] => Err(Error::new(format!(
            "the picture has {}, the first is {hole}: give their films too, or merge to a .film file",
            super::plural(missing.len(), "hole")
        ))),
    }
}

/// What it has, in words.
fn described(film: &Film) -> String {
    match film.coverage().parts() {
        [part] => part.to_string(),
        parts => super::plural(parts.len(), "part"),
    }
}
