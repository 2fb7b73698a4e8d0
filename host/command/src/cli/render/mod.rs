//! `eyerays render`.

mod task;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use clap::Args;

use self::task::Task;
use super::checkpoint::CheckpointArgs;
use super::choice::choice;
use super::denoising;
use super::device::DeviceArgs;
use super::devices::Devices;
use super::live::{self, Live};
use super::look::Look;
use super::noise::NoiseArgs;
use super::options::{Effort, View};
use super::part::PartArgs;
use super::reading::{Read, Reading};
use super::seconds;
use super::sequence::{self, SequenceArgs};
use super::shot::each;
use crate::error::{Error, Result};
use crate::output::{self, Destination};
use crate::preset::Preset;
use eyerays::denoise::Denoiser;
use eyerays::fireflies::Buckets;
use eyerays::layers::{self, Aovs, Layer};
use eyerays::render::{Choice, DeviceWish};
use eyerays::scene::{Integrator, LightGroups, Settings};

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
  eyerays render scenes/room.toml --noise 0.02 -o room.png
  eyerays render scenes/room.toml --live
  eyerays render scenes/room.toml --tile 0,0,256,128 -o corner.film
  eyerays render model.glb --turntable 36 -o 'turn-{frame:04}.png'
  eyerays render fox.glb --animation Run --frames 0..24 --fps 24 -o 'fox-{frame:04}.png'
  eyerays render scenes/ --all-cameras -o '{name}-{camera}.png'";

#[derive(Args)]
pub(super) struct Render {
    /// Scenes (.toml, .gltf, .glb, .eyerays), bare meshes (.obj, .ply), which are framed and lit, or folders of them; - reads a TOML
    /// scene from standard input
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<PathBuf>,
    /// The picture, .png, .exr or .hdr, or a .film to merge or to go on with; - writes PNG to standard output. Of several pictures
    /// {name} (or {file}, with its ending), {camera} and {frame:04} tell them apart [default: {name}.png here]
    #[arg(short, long, value_name = "FILE")]
    output: Option<std::ffi::OsString>,
    /// Settings that `eyerays tradeoff --save` kept; other options override them, and they the scene's
    #[arg(long, value_name = "FILE")]
    settings: Option<PathBuf>,
    /// Where to render: auto is a GPU when one works, else the CPU; gpu; cpu; all of them together; or several by their numbers or
    /// names, such as gpu:0,gpu:1,cpu [default: auto]
    #[arg(long, value_parser = Devices::parse)]
    device: Option<Devices>,
    #[command(flatten)]
    pub look: Look,
    /// What an .exr file holds beside the light of each pixel, with commas between; those of light but for direct and indirect are of paths. A .film keeps what is summed over
    /// samples, and merge writes it
    #[arg(long, value_name = "LAYERS", value_parser = choice::<Layer>(), value_delimiter = ',')]
    layers: Vec<Layer>,
    /// Take noise off the finished picture, by the surfaces that it shows; an .exr file keeps the noisy one as a layer [default: own]
    #[arg(long, value_name = "BY", value_parser = choice::<Denoiser>(), num_args = 0..=1, require_equals = true, default_missing_value = "own", conflicts_with_all = ["tile", "samples_from", "samples_to", "repeat"])]
    pub denoise: Option<Denoiser>,
    /// Leave out what makes a few pixels far too bright: samples are put into so many buckets, 9 to 64, and those that are far brighter
    /// than a pixel's others are left out [default: 15]
    #[arg(long, value_name = "BUCKETS", value_parser = buckets, num_args = 0..=1, require_equals = true, default_missing_value = "15", conflicts_with_all = ["samples_from", "samples_to", "repeat", "time_limit", "noise", "checkpoint", "resume", "preview_every"])]
    pub fireflies: Option<Buckets>,
    /// Write the colours of the surfaces to the output first, by the CPU, to be seen while a GPU gets ready; the picture replaces them
    #[arg(long)]
    preview: bool,
    /// Render this many times and tell the median time
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub repeat: u32,
    /// Render as many samples of each pixel as fit so many seconds, at least one and at most --spp; for samplers without a grid
    #[arg(long, value_name = "S", value_parser = seconds, conflicts_with_all = ["repeat", "samples"])]
    pub time_limit: Option<Duration>,
    #[command(flatten)]
    pub noise: NoiseArgs,
    /// Write the picture so far to the output every so many seconds, 0 for never [default: 10, of what takes longer than 20]
    #[arg(long, value_name = "S", value_parser = seconds, conflicts_with = "repeat")]
    pub preview_every: Option<Duration>,
    /// Show the picture while it is rendered: in a window, or in tev, which listens at HOST:PORT (its own port is 14158)
    #[arg(long, value_name = "HOST:PORT", value_parser = live::viewer, num_args = 0..=1, default_missing_value = live::WINDOW, conflicts_with = "repeat")]
    live: Option<String>,
    /// Leave out of the file what differs from run to run: the device and the seconds
    #[arg(long)]
    pub reproducible: bool,
    /// Print the summary as JSON to standard output
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    on: DeviceArgs,
    #[command(flatten)]
    view: View,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    effort: Effort,
    #[command(flatten)]
    sequence: SequenceArgs,
    #[command(flatten)]
    pub part: PartArgs,
    #[command(flatten)]
    keeping: CheckpointArgs,
}

impl Render {
    pub fn run(&self, quiet: bool) -> Result<ExitCode> {
        let scenes = sequence::scenes(&self.scenes)?;
        let live = self.live.as_deref().map(|viewer| Live::open(viewer, &self.look, self.view.size())).transpose()?;
        let mut task = self.task(quiet)?;
        task.live = live;
        let instants = self.sequence.instants()?;
        if scenes.len() > 1 || instants.len() > 1 {
            self.check_many()?;
        }
        if scenes.len() > 1 {
            task.check_names(&scenes)?;
        }
        each(&scenes, |scene| task.animation(scene, &instants))
    }

    /// The first scene's settings with these options over them, once the options are found to fit each other and the scene. Nothing is
    /// rendered.
    pub fn checked(&self, quiet: bool) -> Result<Settings> {
        let task = self.task(quiet)?;
        let [scene] = &self.scenes[..] else {
            return Err(Error::new("a job renders one scene: name one, and its options after --"));
        };
        let mut read = Read::scene(scene, &[], self.reading.loading(task.effort.integrator()), quiet)?;
        self.view.aim(&mut read.scene).map_err(|error| error.of(read.path))?;
        let settings = self.view.settings(&read.scene, &task.effort)?;
        self.check_layers(&Destination::from(Path::new("part.film")))?;
        let integrator = settings.transport.integrator;
        let kept = layers::check(self.kept(integrator), integrator, &LightGroups::of(&read.scene));
        kept.map_err(|error| error.of(read.path))?;
        Ok(settings)
    }

    /// Checks what can be checked without a scene.
    fn task(&self, quiet: bool) -> Result<Task<'_>> {
        let preset = self.settings.as_deref().map(Preset::read).transpose()?.unwrap_or_default();
        let (device, several) = match &self.device {
            Some(Devices::Several(several)) => (DeviceWish::Auto, Some(several.clone())),
            Some(Devices::One(device)) => (*device, None),
            None => (preset.device.unwrap_or_default(), None),
        };
        self.noise.target(&self.look)?;
        let choice = Choice { several, ..self.on.over(&preset, device).choice(device)? };
        Ok(Task::new(self, self.effort.over(&preset), choice, quiet))
    }

    /// Refuses what is for one picture.
    fn check_many(&self) -> Result<()> {
        match (self.preview, self.keeping.is_named()) {
            (true, _) => Err(Error::new("--preview is for one picture: leave it out")),
            (_, true) => {
                Err(Error::new("--checkpoint keeps the film of one picture: leave it out, or give .film outputs"))
            }
            _ => Ok(()),
        }
    }

    /// Checks where a picture goes.
    fn check(&self, scene: &Path, destination: &Destination) -> Result<()> {
        super::one_on_stdout(self.json, destination)?;
        if self.preview && destination.file().is_none() {
            return Err(Error::new(
                "--preview replaces what it wrote, which standard output can't: name a file with --output",
            ));
        }
        let is_of_pictures = self.preview || self.denoise.is_some() || self.fireflies.is_some();
        if destination.is_film() && is_of_pictures {
            return Err(Error::new(
                "--preview, --fireflies and --denoise are for pictures, not for films: drop them, or name an .exr file",
            ));
        }
        self.look.check(destination)?;
        self.check_layers(destination)?;
        output::check_apart(
            std::slice::from_ref(destination),
            self.settings.iter().map(PathBuf::as_path).chain([scene]),
        )?;
        output::check_writable(destination)
    }

    /// Checks that layers have a place.
    fn check_layers(&self, destination: &Destination) -> Result<()> {
        let of_pictures = self.layers().into_iter().find(|layer| layer.aov().is_none());
        let is_light = |layer: &Layer| layer.aov().is_some() && !rendered_alone(layer);
        if let Some(layer) = self.layers().iter().find(|layer| self.repeat > 1 && is_light(layer)) {
            return Err(Error::new(format!(
                "--repeat measures and keeps no film, which the layer {layer} is told by: drop one"
            )));
        }
        match of_pictures {
            Some(layer) if destination.is_film() || self.part.has_some_samples() => Err(Error::new(format!(
                "--layers: {layer} is of a whole picture and no sum of samples, as layers of a film are: leave it out, or render all of an .exr file"
            ))),
            _ if self.layers.is_empty() || destination.is_film() => Ok(()),
            _ => output::check_layers(destination),
        }
    }

    /// What films keep for the layers of a picture by an integrator. Others than paths render them one by one, and so does what is
    /// measured.
    fn kept(&self, integrator: Integrator) -> Aovs {
        let mut layers = self.layers();
        // A film that is gone on with may be without them: then they are rendered after the picture.
        if self.denoise.is_some() && !self.keeping.is_asked() {
            layers.extend(denoising::NEEDED);
        }
        if self.repeat > 1 || integrator != Integrator::Path {
            layers.retain(|layer| !rendered_alone(layer));
        }
        layers::asked(&layers)
    }

    /// The layers beside the picture, each once.
    pub fn layers(&self) -> Vec<Layer> {
        let mut layers = self.layers.clone();
        layers.retain(|&layer| layer != Layer::Colour);
        layers.sort_unstable();
        layers.dedup();
        layers
    }
}

/// Layers that can be rendered without the picture's film.
fn rendered_alone(layer: &Layer) -> bool {
    matches!(layer, Layer::Albedo | Layer::Normal | Layer::Direct | Layer::Indirect)
}

fn buckets(text: &str) -> std::result::Result<Buckets, String> {
    let count = text.parse().map_err(|_| format!("{text:?} is no number of buckets"))?;
    Buckets::new(count).map_err(|error| error.to_string())
}

/// Refuses a picture that has no fireflies, and too few samples to tell.
fn check_fireflies(buckets: Buckets, integrator: Integrator, view: &eyerays::view::View) -> Result<()> {
    if !integrator.samples() {
        let why = "pictures of the integrator";
        return Err(Error::new(format!("--fireflies: {why} {integrator} have none; leave it out")));
    }
    buckets.of(view.range()).map(drop).map_err(|error| Error::new(format!("--fireflies: {}", error.message())))
}
