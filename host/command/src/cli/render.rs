//! `eyerays render`.

use std::mem::ManuallyDrop;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::slice;
use std::time::{Duration, Instant};

use clap::Args;

use super::checkpoint::{self, Checkpoint, CheckpointArgs};
use super::choice::choice;
use super::console;
use super::device::DeviceArgs;
use super::look::Look;
use super::options::{Effort, Loaded, View};
use super::part::PartArgs;
use super::progress;
use super::reading::{self, Read, Reading};
use super::seconds;
use super::summary::{Summary, Times};
use super::watching::{self, Watching};
use crate::error::{Error, Result};
use crate::output::{self, Destination};
use crate::preset::Preset;
use eyerays::film::Identity;
use eyerays::layers::{self, Layer, Values};
use eyerays::render::{Backend, Choice, DeviceWish, Precision, Rendering};
use eyerays::scene::{Camera, Scene, Settings};

pub(super) const EXAMPLES: &str = "\
Examples:
  eyerays render scenes/cornell.toml -o cornell.png
  eyerays render model.obj --size 1920x1080 --samples 3 --device cpu
  eyerays render scenes/whitted.toml -o - > whitted.png
  eyerays render - -o picture.png < scene.toml
  eyerays render scenes/cornell_path.toml --exposure 1 --tone agx
  eyerays render model.glb -o model.exr --layers albedo,normal,depth
  eyerays render scenes/cornell.toml --settings fast.toml
  eyerays render scenes/room.toml --spp 4096 --checkpoint room.film --resume
  eyerays render scenes/room.toml --tile 0,0,256,128 -o corner.film";

#[derive(Args)]
pub(super) struct Render {
    /// A scene (.toml, .gltf, .glb, .eyerays), or a bare mesh (.obj, .ply), which is framed and lit; - reads a TOML scene from
    /// standard input
    scene: PathBuf,
    /// The picture, .png, .exr or .hdr, or a .film to merge or to go on with; - writes PNG to standard output [default: SCENE.png here,
    /// or eyerays.png]
    #[arg(short, long, value_name = "FILE")]
    output: Option<std::ffi::OsString>,
    /// Settings that `eyerays tradeoff --save` kept; other options override them, and they the scene's
    #[arg(long, value_name = "FILE")]
    settings: Option<PathBuf>,
    /// Where to render [default: auto]
    #[arg(long, value_parser = choice::<DeviceWish>())]
    device: Option<DeviceWish>,
    #[command(flatten)]
    look: Look,
    /// What an .exr file holds beside the light of each pixel, with commas between
    #[arg(long, value_name = "LAYERS", value_parser = choice::<Layer>(), value_delimiter = ',', conflicts_with = "samples_from")]
    layers: Vec<Layer>,
    /// Write the colours of the surfaces to the output first, by the CPU, to be seen while a GPU gets ready; the picture replaces them
    #[arg(long)]
    preview: bool,
    /// Render this many times and tell the median time
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    repeat: u32,
    /// Render as many samples of each pixel as fit so many seconds, at least one and at most --spp; for samplers without a grid
    #[arg(long, value_name = "S", value_parser = seconds, conflicts_with_all = ["repeat", "samples"])]
    time_limit: Option<Duration>,
    /// Write the picture so far to the output every so many seconds, 0 for never [default: 10, of what takes longer than 20]
    #[arg(long, value_name = "S", value_parser = seconds, conflicts_with = "repeat")]
    preview_every: Option<Duration>,
    /// Print the summary as JSON to standard output
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    on: DeviceArgs,
    #[command(flatten)]
    view: View,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    effort: Effort,
    #[command(flatten)]
    part: PartArgs,
    #[command(flatten)]
    keeping: CheckpointArgs,
}

/// A picture that is ready to be rendered.
struct Ready<'a> {
    of: &'a Render,
    destination: Destination,
    checkpoint: Option<Checkpoint>,
    choice: Choice,
    loaded: Loaded,
    scene: Scene,
    camera: Camera,
    quiet: bool,
}

impl Render {
    pub fn run(&self, quiet: bool) -> Result<ExitCode> {
        let mut ready = self.ready(quiet)?;
        if self.preview {
            ready.preview()?;
        }
        ready.render()
    }

    /// The scene's settings with these options over them, once the options are found to fit each other and the scene. Nothing is
    /// rendered.
    pub fn checked(&self, quiet: bool) -> Result<Settings> {
        self.on.choice(self.device.unwrap_or_default())?;
        let read = Read::scene(&self.scene, &[], self.reading.loading(self.effort.integrator()), quiet)?;
        self.view.camera(&read.scene).map_err(|error| error.of(read.path))?;
        self.view.settings(&read.scene, &self.effort)
    }

    /// Checks what can be checked, reads the scene and packs it.
    fn ready(&self, quiet: bool) -> Result<Ready<'_>> {
        let destination = match &self.output {
            Some(name) => Destination::from(name.clone()),
            None => Destination::from(default_output(&self.scene).as_path()),
        };
        self.check(&destination)?;
        let preset = self.settings.as_deref().map(Preset::read).transpose()?.unwrap_or_default();
        let device = self.device.or(preset.device).unwrap_or_default();
        let choice = self.on.over(&preset, device).choice(device)?;
        output::check_apart(slice::from_ref(&destination), self.settings.iter().chain([&self.scene]))?;
        output::check_writable(&destination)?;
        let checkpoint = self.keeping.beside(&destination)?;
        let mut effort = self.effort.over(&preset);
        let loading = self.reading.loading(effort.integrator());
        let read = Read::scene(&self.scene, slice::from_ref(&destination), loading, quiet)?;
        if self.time_limit.is_some() {
            effort = effort.endless(&read.scene)?;
        }
        let (mut loaded, scene, camera) = self.view.pack_and_keep(read, &effort, &choice, quiet)?;
        loaded.view = self.part.of(&loaded.view)?;
        Ok(Ready { of: self, destination, checkpoint, choice, loaded, scene, camera, quiet })
    }

    fn check(&self, destination: &Destination) -> Result<()> {
        super::one_on_stdout(self.json, destination)?;
        if self.preview && destination.file().is_none() {
            return Err(Error::new(
                "--preview replaces what it wrote, which standard output can't: name a file with --output",
            ));
        }
        if destination.is_film() && (self.preview || !self.layers.is_empty()) {
            return Err(Error::new(
                "--preview and --layers are for pictures, not for films: drop them, or name an .exr file",
            ));
        }
        self.look.check(destination)?;
        if self.layers.is_empty() { Ok(()) } else { output::check_layers(destination) }
    }

    /// The layers beside the picture, each once.
    fn layers(&self) -> Vec<Layer> {
        let mut layers = self.layers.clone();
        layers.retain(|&layer| layer != Layer::Colour);
        layers.sort_unstable();
        layers.dedup();
        layers
    }
}

impl Ready<'_> {
    /// What can be seen before kernels are there.
    fn preview(&mut self) -> Result<()> {
        progress::stage("drawing a preview", self.is_silent(), || {
            let window = self.loaded.view.region();
            let picture = layers::preview(&mut self.loaded.packed, &self.camera, window, self.choice.threads)?;
            output::write_picture(&picture, &self.destination, &self.of.look.as_it_is()?)
        })
    }

    fn is_silent(&self) -> bool {
        self.quiet || self.of.json
    }

    fn render(mut self) -> Result<ExitCode> {
        let path = reading::called(&self.of.scene);
        let of_scene = |error: eyerays::error::Error| error.of(path);
        let identity = self.identity().map_err(of_scene)?;
        let backend = progress::stage("opening the device", self.quiet, || Backend::new(&self.choice))?;
        // The end of the process takes everything back at once; a driver takes 70 ms for it one by one (an H200).
        let backend = ManuallyDrop::new(backend);
        let identity = match self.choice.precision {
            Precision::Fast => identity.on(&backend.description(), self.choice.traversal),
            _ => identity,
        };
        let mut rendering = self.rendered(&backend, &identity)?;
        rendering.film.identity = identity;
        let start = Instant::now();
        let asked = self.of.layers();
        let is_silent = self.is_silent() || asked.is_empty();
        let layers = progress::stage("rendering layers", is_silent, || {
            layers::render(&backend, &mut self.loaded.packed, (&self.scene, &self.camera), &rendering, &asked)
        });
        let layers = layers.map_err(of_scene)?;
        let layers_time = (!asked.is_empty()).then(|| start.elapsed());
        let start = Instant::now();
        progress::stage("writing", self.quiet, || self.write(&rendering, &layers))?;
        let times = Times::new(&self.loaded, &rendering, layers_time, start.elapsed());
        let summary = Summary::new(&self.destination, &self.choice, &self.loaded, &rendering, times);
        if self.of.json {
            console::print_json(&summary.json())?;
        } else if !self.quiet {
            console::say(summary);
        }
        self.end(&rendering)
    }

    /// What the picture is of. A film of one sample is not kept, and hashing the scene takes time.
    fn identity(&self) -> eyerays::error::Result<Identity> {
        let Loaded { packed, view, .. } = &self.loaded;
        if view.samples() == 1 && !self.destination.is_film() && self.checkpoint.as_ref().is_none_or(|to| !to.stays()) {
            return Ok(Identity::default());
        }
        Identity::of(&self.scene, packed, view, self.choice.precision)
    }

    fn rendered(&self, backend: &Backend, identity: &Identity) -> Result<Rendering> {
        let (Loaded { packed, view, .. }, repeat) = (&self.loaded, self.of.repeat);
        let from = match &self.checkpoint {
            Some(checkpoint) => checkpoint.film(identity, self.quiet)?,
            None => None,
        };
        // Of one sample there is nothing to be seen before it is done, nor to be kept.
        let rendering = if repeat == 1 && (view.samples() > 1 || from.is_some()) {
            let watching = Watching {
                bar: progress::samples(view.samples(), self.is_silent()),
                destination: &self.destination,
                look: self.of.look,
                every: self.of.preview_every,
                limit: self.of.time_limit,
                checkpoint: self.checkpoint.as_ref(),
                identity,
                quiet: self.quiet,
            };
            watching.follow(|watch| backend.render_watched(packed, view, from.as_ref(), watch))
        } else {
            let bar = progress::pixels(view.region().pixels() * u64::from(repeat), self.is_silent());
            let rendering = backend.render(packed, view, repeat, &|pixels| bar.inc(pixels));
            bar.finish_and_clear();
            rendering
        };
        Ok(rendering.map_err(|error| error.of(reading::called(&self.of.scene)))?)
    }

    fn write(&self, rendering: &Rendering, layers: &[(Layer, Values)]) -> Result<()> {
        if self.destination.is_film() {
            return checkpoint::write(&rendering.film, self.destination.file().expect("a film is a file"));
        }
        let (picture, look) = (&rendering.picture, &self.of.look);
        super::warn(look.beyond_white(picture, &self.destination)?.as_slice(), self.quiet);
        output::write_layers(picture, layers, &self.destination, &look.encoding(picture)?)
    }

    /// How the command ends: as shells have it where a signal ended the rendering.
    fn end(&self, rendering: &Rendering) -> Result<ExitCode> {
        let (samples, all) = (rendering.samples, self.loaded.view.samples());
        let signal = watching::ended_by();
        if signal.is_some() && samples < all && !self.quiet {
            console::say(format_args!("ended after {samples} of {all} samples of each pixel"));
        }
        if let Some(checkpoint) = &self.checkpoint
            && !self.destination.is_film()
        {
            checkpoint.end(&rendering.film, signal.is_none() || samples == all, self.quiet)?;
        }
        Ok(signal.map_or(ExitCode::SUCCESS, |signal| ExitCode::from(128 + signal as u8)))
    }
}

/// The scene's name with another ending, in the current folder; standard input has none.
fn default_output(scene: &Path) -> PathBuf {
    let stem = scene.file_stem().filter(|_| !reading::is_standard_input(scene));
    PathBuf::from(stem.unwrap_or("eyerays".as_ref())).with_extension("png")
}
