//! `eyerays farm`.

use std::ffi::OsString;
use std::path::{self, Path, PathBuf};
use std::process::ExitCode;

use clap::parser::ValueSource;
use clap::{ArgMatches, Args, CommandFactory, FromArgMatches};

use super::render::Render;
use super::{Cli, Command, console, reading};
use crate::error::{Error, Result};
use crate::farm::{Folder, Job, Parts};
use crate::output::{self, Destination};

pub(super) const EXAMPLES: &str = "\
Examples:
  eyerays farm scene.toml --parts 8 -o job
  eyerays farm scene.toml --parts 8 -o job -- --size 1920x1080 --spp 512 --device gpu
  openjd run job/job.yaml -p Scene=scene.toml --step Merge --run-dependencies
  sh job/submit.sh

DIR gets job.yaml, a template of Open Job Description, and for Slurm submit.sh, which submits
slurm.sh and merge.sh. Each task renders some of the samples of each pixel, or, of fewer samples
than parts, a band of rows. In exact precision the picture has the bits of one that was rendered
at once, and a task that is started again goes on with what it had.";

#[derive(Args)]
pub(super) struct Farm {
    /// The scene, which the machines find under the same path or are told where
    scene: PathBuf,
    /// How many parts the picture is rendered in, 1 to 1024
    #[arg(long, value_name = "N")]
    parts: u32,
    /// The job's folder, which is new or empty
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// The picture's file in that folder: .exr, .png or .hdr [default: SCENE.exr]
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    /// Options of eyerays render for every part
    #[arg(last = true, value_name = "OPTION")]
    options: Vec<String>,
}

/// Options of `render` that no part of a picture takes: what the job says itself, what films do not hold, and files that other
/// machines may not have.
const NOT_OF_PARTS: [&str; 17] = [
    "fireflies",
    "all_cameras",
    "turntable",
    "frames",
    "output",
    "tile",
    "samples_from",
    "samples_to",
    "checkpoint",
    "resume",
    "settings",
    "preview",
    "preview_every",
    "repeat",
    "time_limit",
    "noise",
    "json",
];

/// Options of `render` that are for the merge, which writes the picture.
const OF_THE_MERGE: [&str; 5] = ["exposure", "white_balance", "bits", "tone", "half"];

impl Farm {
    pub fn run(&self, quiet: bool) -> Result<ExitCode> {
        let (scene, stem, picture) = self.names()?;
        let folder = Folder::new(&self.output)?;
        let render = self.render()?;
        if !render.layers().is_empty() {
            output::check_layers(&Destination::File(picture.clone().into()))?;
        }
        let settings = render.checked(quiet)?;
        let parts = Parts::new(self.parts, settings.samples_a_pixel(), settings.size)?;
        let job = Job { name: Job::name(&stem), scene, options: self.options.clone(), picture, parts };
        folder.write(&job)?;
        if !quiet {
            let folder = self.output.display();
            console::say(format_args!("{folder}: {}; run job.yaml by OpenJD, or submit.sh for Slurm", job.parts));
        }
        Ok(ExitCode::SUCCESS)
    }

    /// The scene's path from the root, its name without an ending, and the picture's name.
    fn names(&self) -> Result<(String, String, String)> {
        if reading::is_standard_input(&self.scene) {
            return Err(Error::new("a job's machines have no standard input to read: name the scene's file"));
        }
        let scene = path::absolute(&self.scene).map_err(|error| Error::file(&self.scene, error.to_string()))?;
        let stem = text(self.scene.file_stem().unwrap_or_default().as_ref())?;
        let picture = self.picture.clone().unwrap_or_else(|| format!("{stem}.exr").into());
        if picture.file_name() != Some(picture.as_os_str()) || picture == Path::new("-") {
            return Err(Error::file(&picture, "--picture is a file in the job's folder; give its name alone"));
        }
        Destination::File(picture.clone()).format()?;
        for option in &self.options {
            text(option.as_ref())?;
        }
        Ok((text(&scene)?, stem, text(&picture)?))
    }

    /// The options as `render` reads them.
    fn render(&self) -> Result<Box<Render>> {
        let words = ["eyerays", "render"].map(OsString::from).into_iter().chain([self.scene.clone().into()]);
        let words = words.chain(self.options.iter().map(OsString::from));
        let found = Cli::command().try_get_matches_from(words).map_err(|error| refused(&error))?;
        found.subcommand_matches("render").map_or(Ok(()), check_options)?;
        match Cli::from_arg_matches(&found).map_err(|error| refused(&error))?.command {
            Command::Render(render) => Ok(render),
            _ => Err(Error::new("the words after -- are options of eyerays render; leave others out")),
        }
    }
}

fn check_options(given: &ArgMatches) -> Result<()> {
    let is_given = |name: &&&str| given.value_source(name) == Some(ValueSource::CommandLine);
    let Some(name) = NOT_OF_PARTS.iter().chain(&OF_THE_MERGE).find(is_given) else { return Ok(()) };
    let remedy = match OF_THE_MERGE.contains(name) {
        true => "add it to the merge in job.yaml and merge.sh",
        false => "leave it out",
    };
    Err(Error::new(format!("--{} is not for parts of a picture, which are films: {remedy}", name.replace('_', "-"))))
}

/// What clap says of the options, as one line.
fn refused(error: &clap::Error) -> Error {
    if !error.use_stderr() {
        return Error::new("after --: no options of a rendering; eyerays render --help lists them");
    }
    let said = error.render().to_string();
    let line = said.lines().next().unwrap_or_default();
    Error::new(format!("after --: {}; eyerays render --help lists the options", line.trim_start_matches("error: ")))
}

/// What scripts and templates can hold as it is.
fn text(name: &Path) -> Result<String> {
    let fault = |fault: &str| Error::file(name, fault);
    let text = name.to_str().ok_or_else(|| fault("a job is UTF-8 text, and this is not; rename it"))?;
    if text.chars().any(char::is_control) || text.contains("{{") {
        return Err(fault("a job can't hold control characters and \"{{\"; rename it"));
    }
    Ok(text.to_owned())
}
