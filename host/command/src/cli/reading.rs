//! Reading a scene for a command.

use std::borrow::Cow;
use std::convert::Infallible;
use std::ffi::OsStr;
use std::io;
use std::path::Path;
use std::time::{self, Duration};

use clap::Args;
use eyerays::scene::{Integrator, Scene};
use eyerays::scene_io;
use eyerays::scene_io::{AnimationWish, Instancing, LightUnit, Loading, Moment, Shutter};

use super::choice::choice;
use super::progress;
use super::sequence::Instant;
use super::shutter::{self, Open};
use crate::error::{Error, Result};
use crate::output::{self, Destination};

/// How a scene's files are read.
#[derive(Args, Clone)]
pub(super) struct Reading {
    /// Read what models name outside their folders too, for files that you trust
    #[arg(long, help_heading = "View")]
    allow_outside: bool,
    /// In what unit a glTF file has its lights [default: that of what wrote it]
    #[arg(long, value_name = "UNIT", value_parser = choice::<LightUnit>(), help_heading = "View")]
    light_unit: Option<LightUnit>,
    /// Whether meshes that stand in several places are held in memory once; the picture is the same [default: auto]
    #[arg(long, value_name = "WHEN", value_parser = choice::<Instancing>(), help_heading = "Speed")]
    instances: Option<Instancing>,
    /// How a glTF file stands so many seconds after the start of an animation [default: 0]
    #[arg(long, value_name = "S", value_parser = number, allow_hyphen_values = true, help_heading = "View")]
    time: Option<f64>,
    /// When the shutter is open, in pictures after each one's moment: things blur by their motion from A to B (0,0.5 is half of a picture's
    /// time); in seconds with an s (0,0.02s); 0 closes a scene's own
    #[arg(long, value_name = "A,B", value_parser = shutter::open, allow_hyphen_values = true, help_heading = "View")]
    shutter: Option<Open>,
    /// The share of that time for which each row of a picture is exposed, from the top to the bottom, as by a telephone's camera
    #[arg(long, value_name = "SHARE", value_parser = shutter::share, requires = "shutter", help_heading = "View")]
    rolling_shutter: Option<f64>,
    /// Which of a glTF file's animations that is, by its name or its number from 0; none is how it stands at rest [default: 0]
    #[arg(long, value_name = "NAME", value_parser = wish, help_heading = "View")]
    animation: Option<AnimationWish>,
    /// Pictures a second.
    #[arg(skip)]
    rate: Option<f64>,
}

impl Reading {
    /// For an integrator, if it is known before the scene is.
    pub fn loading(&self, integrator: Option<Integrator>) -> Loading {
        let moment = Moment { animation: self.animation.clone(), seconds: self.time };
        let instancing = self.instances.unwrap_or_default();
        let Reading { allow_outside, light_unit, .. } = *self;
        let rate = self.instant().rate;
        let shutter = self.shutter.map(|open| open.shutter(rate, self.rolling_shutter));
        Loading { allow_outside, light_unit, integrator, moment, shutter, instancing, ..Loading::default() }
    }

    /// As a scene is at one moment.
    pub fn still(&self, integrator: Option<Integrator>) -> Loading {
        Loading { shutter: Some(Shutter::CLOSED), ..self.loading(integrator) }
    }

    /// The same for who keeps it, or measures it.
    ///
    /// # Errors
    /// A shutter was asked for.
    pub fn moment(&self) -> Result<Loading> {
        if self.shutter.is_some() {
            return Err(Error::new("this is of a scene at one moment: leave --shutter out; --time chooses the moment"));
        }
        Ok(self.still(None))
    }

    /// For who measures rays in one hierarchy, where each copy of a mesh has triangles of its own.
    ///
    /// # Errors
    /// Copies or a shutter were asked for.
    pub fn flat(&self) -> Result<Loading> {
        match self.instances {
            None | Some(Instancing::Never) => Ok(Loading { instancing: Instancing::Never, ..self.moment()? }),
            Some(_) => Err(Error::new("what is measured is one hierarchy of all triangles: leave --instances out")),
        }
    }

    /// That of a picture of which no number is asked for.
    pub fn instant(&self) -> Instant {
        let rate = self.rate.unwrap_or(Instant::RATE);
        Instant::unnumbered(self.time.unwrap_or(0.0), rate)
    }

    /// The same for a picture of an animation, at its seconds.
    pub fn at(&self, Instant { seconds, rate, .. }: Instant) -> Reading {
        Reading { time: Some(seconds), rate: Some(rate), ..self.clone() }
    }
}

fn wish(text: &str) -> std::result::Result<AnimationWish, Infallible> {
    Ok(AnimationWish::of(text))
}

/// A finite number.
fn number(text: &str) -> std::result::Result<f64, String> {
    text.parse()
        .ok()
        .filter(|number: &f64| number.is_finite())
        .ok_or_else(|| "write seconds, for example 1.5".to_owned())
}

/// What a scene file is called that comes from standard input.
const STANDARD_INPUT: &str = "standard input";

/// Does the command line's name of a scene stand for standard input?
pub(super) fn is_standard_input(path: &Path) -> bool {
    path == Path::new("-")
}

/// What messages call a scene of this name.
pub(super) fn called(path: &Path) -> &Path {
    if is_standard_input(path) { Path::new(STANDARD_INPUT) } else { path }
}

/// What pictures of a scene of this name are called, or of one that standard input gives.
pub(super) fn stem(path: &Path) -> Cow<'_, str> {
    or_own(path, Path::file_stem)
}

/// The same with its ending.
pub(super) fn file_name(path: &Path) -> Cow<'_, str> {
    or_own(path, Path::file_name)
}

fn or_own<'p>(path: &'p Path, name: impl Fn(&'p Path) -> Option<&'p OsStr>) -> Cow<'p, str> {
    let named = name(path).filter(|_| !is_standard_input(path) && path != Path::new(STANDARD_INPUT));
    named.unwrap_or("eyerays".as_ref()).to_string_lossy()
}

/// A scene that was read, from which file, and what that took.
pub(super) struct Read<'a> {
    pub path: &'a Path,
    pub scene: Scene,
    /// How many warnings were given.
    pub warnings: usize,
    pub time: Duration,
}

impl<'a> Read<'a> {
    /// Reads a scene, from standard input if its name is `-`, and says what of it is not drawn. None of the files that it names may
    /// be among `outputs`.
    pub fn scene(path: &'a Path, outputs: &[Destination], loading: Loading, quiet: bool) -> Result<Self> {
        let start = time::Instant::now();
        let load = || match is_standard_input(path) {
            true => scene_io::read_as(io::stdin().lock(), called(path), loading),
            false => scene_io::load_as(path, loading),
        };
        let (scene, warnings) = progress::stage("reading", quiet, load)?;
        let path = called(path);
        let time = start.elapsed();
        super::warn(&warnings, quiet);
        output::check_apart(outputs, &scene.files)?;
        Ok(Read { path, scene, warnings: warnings.len(), time })
    }

    /// The scene without a hierarchy that it may bring along, for those who measure what building takes.
    pub fn unbuilt(self) -> Scene {
        Scene { hierarchy: None, ..self.scene }
    }
}
