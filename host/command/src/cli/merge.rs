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
use eyerays::layers;
use eyerays::view::Region;

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
    /// Write a picture of what the films have, though it is not the whole image or not from the first sample on
    #[arg(long)]
    part: bool,
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
            self.whole(&film)?;
            let picture = film.develop()?;
            let encoding = self.look.encoding(&picture)?;
            super::warn(self.look.beyond_white(&picture, &encoding, &destination)?.as_slice(), quiet);
            let layers = if output::check_layers(&destination).is_ok() {
                layers::all_of_film(&film, &picture)?
            } else {
                Vec::new()
            };
            output::write_layers(&picture, &layers, &destination, &encoding)?;
        }
        if !quiet {
            let parts = super::plural(self.parts.len(), "film");
            console::say(format_args!("{destination}: {} from {parts}", described(&film)));
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

    /// Refuses a film with cells that need more samples, or have none, or, unless a part will do, one of a part of the image.
    fn all_cells(&self, film: &Film) -> Result<()> {
        let ((width, height), left) = (film.size(), film.cells_left());
        if left > 0 {
            let cells = super::plural(left, "cell");
            let remedy = "give the films of all, or go on with them by render --resume, or merge to a .film file";
            return Err(Error::new(format!("{cells} of 16x16 pixels need more samples for their noise: {remedy}")));
        }
        if !self.part && film.window() != (Region { x: 0, y: 0, width, height }) {
            let Region { x, y, width, height } = film.window();
            let has = format!("the picture has {width}x{height} pixels at {x},{y} alone");
            return Err(Error::new(format!("{has}: give the other films too, add --part, or merge to a .film file")));
        }
        Ok(())
    }

    /// Refuses a film of which some pixels have other samples than others, or, unless a part will do, not those of a whole picture.
    fn whole(&self, film: &Film) -> Result<()> {
        if film.cells().is_some() {
            return self.all_cells(film);
        }
        let samples = film.coverage().parts().iter().map(|part| part.samples.clone());
        let samples = samples.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end));
        let Some(samples) = samples else { return Err(Error::new("the films have no samples: render some")) };
        let (width, height) = film.size();
        let whole = match self.part {
            true => Part { region: film.window(), samples },
            false => Part { region: Region { x: 0, y: 0, width, height }, samples: 0..samples.end },
        };
        has_all(film, &whole)
    }
}

/// Refuses a film with holes.
fn has_all(film: &Film, whole: &Part) -> Result<()> {
    let missing = film.coverage().missing(whole);
    match &missing[..] {
        [] => Ok(()),
        [hole, ..] => Err(Error::new(format!(
            "the picture has {}, the first is {hole}: give their films too, add --part, or merge to a .film file",
            super::plural(missing.len(), "hole")
        ))),
    }
}

/// What it has, in words.
fn described(film: &Film) -> String {
    if let Some(cells) = film.cells() {
        let samples = film.volume() / film.window().pixels();
        return format!("{samples} samples a pixel for a noise of {}", cells.target().noise());
    }
    match film.coverage().parts() {
        [part] => part.to_string(),
        parts => super::plural(parts.len(), "part"),
    }
}
