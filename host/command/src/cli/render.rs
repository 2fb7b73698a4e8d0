//! `eyerays render`.

use std::mem::ManuallyDrop;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::slice;
use std::time::{Duration, Instant};

use clap::Args;

use super::choice::choice;
use super::console;
use super::device::DeviceArgs;
use super::exposure::{Brightness, Exposure};
use super::options::{Effort, Loaded, View};
use super::progress;
use super::reading::{Read, Reading};
use super::summary::{Summary, Times};
use super::watching::{self, Watching};
use crate::error::{Error, Result};
use crate::output::{self, Destination};
use crate::preset::Preset;
use eyerays::image::{BitDepth, Encoding, Format, ToneMap};
use eyerays::layers::{self, Layer};
use eyerays::render::{Backend, DeviceWish, Rendering};

pub(super) const EXAMPLES: &str = "\
Examples:
  eyerays render scenes/cornell.toml -o cornell.png
  eyerays render model.obj --size 1920x1080 --samples 3 --device cpu
  eyerays render scenes/whitted.toml -o - > whitted.png
  eyerays render scenes/cornell_path.toml --exposure 1 --tone agx
  eyerays render model.glb -o model.exr --layers albedo,normal,depth
  eyerays render scenes/cornell.toml --settings fast.toml";

#[derive(Args)]
pub(super) struct Render {
    /// A scene (.toml, .gltf, .glb, .eyerays), or a bare mesh (.obj, .ply), which is framed and lit
    scene: PathBuf,
    /// The picture, .png, .exr or .hdr; - writes PNG to standard output [default: SCENE.png here]
    #[arg(short, long, value_name = "FILE")]
    output: Option<std::ffi::OsString>,
    /// Settings that `eyerays tradeoff --save` kept; other options override them, and they the scene's
    #[arg(long, value_name = "FILE")]
    settings: Option<PathBuf>,
    /// Where to render [default: auto]
    #[arg(long, value_parser = choice::<DeviceWish>())]
    device: Option<DeviceWish>,
    /// Brighten the picture by this many stops; auto makes white what all but 1 % of the pixels with light are darker than
    #[arg(long, value_name = "EV|auto", default_value = "0", value_parser = Exposure::parse, allow_hyphen_values = true)]
    exposure: Exposure,
    /// Bits a channel of a PNG: 8 or 16
    #[arg(long, value_name = "BITS", default_value_t = 8)]
    bits: u32,
    /// How a PNG shows light brighter than a screen's white
    #[arg(long, value_name = "MAP", value_parser = choice::<ToneMap>(), default_value_t = ToneMap::None)]
    tone: ToneMap,
    /// What an .exr file holds beside the light of each pixel, with commas between
    #[arg(long, value_name = "LAYERS", value_parser = choice::<Layer>(), value_delimiter = ',')]
    layers: Vec<Layer>,
    /// Floats of 16 bits in an .exr file; finite values beyond ±65504 become that
    #[arg(long)]
    half: bool,
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
}

impl Render {
    pub fn run(&self, quiet: bool) -> Result<ExitCode> {
        let destination = match &self.output {
            Some(name) => Destination::from(name.clone()),
            None => Destination::from(default_output(&self.scene).as_path()),
        };
        super::one_on_stdout(self.json, &destination)?;
        if self.preview && destination.file().is_none() {
            return Err(Error::new(
                "--preview replaces what it wrote, which standard output can't: name a file with --output",
            ));
        }
        let bits = BitDepth::from_bits(self.bits)?;
        let mut encoding = Encoding { exposure_ev: self.exposure.stops(), bits, half: self.half, tone: self.tone };
        encoding.check(destination.format()?)?;
        let preset = self.settings.as_deref().map(Preset::read).transpose()?.unwrap_or_default();
        let layers = self.layers();
        if !self.layers.is_empty() {
            output::check_layers(&destination)?;
        }
        let device = self.device.or(preset.device).unwrap_or_default();
        let choice = self.on.over(&preset, device).choice(device)?;
        output::check_apart(slice::from_ref(&destination), self.settings.iter().chain([&self.scene]))?;
        output::check_writable(&destination)?;
        let mut effort = self.effort.over(&preset);
        let loading = self.reading.loading(effort.integrator());
        let read = Read::scene(&self.scene, slice::from_ref(&destination), loading, quiet)?;
        if self.time_limit.is_some() {
            effort = effort.endless(&read.scene)?;
        }
        let (mut loaded, scene, camera) = self.view.pack_and_keep(read, &effort, &choice, quiet)?;
        if self.preview {
            progress::stage("drawing a preview", quiet || self.json, || {
                let picture = layers::preview(&mut loaded.packed, &camera, choice.threads)?;
                let plain = Encoding { exposure_ev: 0.0, tone: ToneMap::None, ..encoding };
                output::write_layers(&picture, &[], &destination, &plain)
            })?;
        }
        // Nothing but layers has a use for it, and memory may be short.
        let kept = (!layers.is_empty()).then_some((scene, camera));
        let chosen = progress::stage("opening the device", quiet, || Backend::new(&choice))?;
        // The end of the process takes everything back at once; a driver takes 70 ms for it one by one (an H200).
        let chosen = ManuallyDrop::new(chosen);
        let is_silent = quiet || self.json;
        // Of one sample there is nothing to be seen before it is done, nor to be kept.
        let rendering = if self.repeat == 1 && loaded.view.samples() > 1 {
            let watching = Watching {
                bar: progress::samples(loaded.view.samples(), is_silent),
                destination: &destination,
                encoding,
                auto_exposure: self.exposure == Exposure::Auto,
                every: self.preview_every,
                limit: self.time_limit,
                quiet,
            };
            watching.follow(|watch| chosen.render_watched(&loaded.packed, &loaded.view, watch))
        } else {
            let (width, height) = loaded.packed.settings().size;
            let pixels = u64::from(width) * u64::from(height) * u64::from(self.repeat);
            let bar = progress::pixels(pixels, is_silent);
            let rendering = chosen.render(&loaded.packed, &loaded.view, self.repeat, &|pixels| bar.inc(pixels));
            bar.finish_and_clear();
            rendering
        };
        let rendering = rendering.map_err(|e| e.of(&self.scene))?;
        let start = Instant::now();
        let layers = match &kept {
            Some((scene, camera)) => progress::stage("rendering layers", quiet || self.json, || {
                layers::render(&chosen, &mut loaded.packed, (scene, camera), &rendering, &layers)
            })
            .map_err(|e| e.of(&self.scene))?,
            None => Vec::new(),
        };
        let layers_time = kept.is_some().then(|| start.elapsed());
        let brightness = Brightness::of(&rendering.picture);
        if self.exposure == Exposure::Auto {
            encoding.exposure_ev = brightness.exposure();
        }
        super::warn(self.beyond_white(&brightness, &encoding, &destination)?.as_slice(), quiet);
        let start = Instant::now();
        progress::stage("writing", quiet, || {
            output::write_layers(&rendering.picture, &layers, &destination, &encoding)
        })?;
        let times = Times::new(&loaded, &rendering, layers_time, start.elapsed());
        let summary = Summary::new(&destination, &choice, &loaded, &rendering, times);
        if self.json {
            console::print_json(&summary.json())?;
        } else if !quiet {
            console::say(summary);
        }
        Ok(self.code(&rendering, &loaded, quiet))
    }
}

impl Render {
    /// How the command ends: as shells have it where a signal ended the rendering.
    fn code(&self, rendering: &Rendering, loaded: &Loaded, quiet: bool) -> ExitCode {
        let Some(signal) = watching::ended_by() else { return ExitCode::SUCCESS };
        let (samples, all) = (rendering.samples, loaded.view.samples());
        if samples < all && !quiet {
            console::say(format_args!("ended after {samples} of {all} samples of each pixel"));
        }
        ExitCode::from(128 + signal as u8)
    }

    /// What to say of a picture that is mostly beyond white. Formats of light hold it all, and tone maps find a place for it.
    fn beyond_white(
        &self,
        brightness: &Brightness,
        encoding: &Encoding,
        destination: &Destination,
    ) -> Result<Option<String>> {
        if destination.format()? != Format::Png {
            return Ok(None);
        }
        let share = brightness.beyond_white(encoding.exposure_ev);
        if share <= MOST_BEYOND_WHITE {
            return Ok(None);
        }
        let (percent, stops) = (100.0 * share, brightness.exposure());
        Ok(Some(format!("{percent:.0} % of the light in the picture is beyond white: --exposure {stops:.1} shows it")))
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

/// The share of the pixels with light that may be beyond white before it is said.
const MOST_BEYOND_WHITE: f64 = 1.0 / 3.0;

/// A time of at most a year.
fn seconds(text: &str) -> std::result::Result<Duration, String> {
    let seconds = text.parse::<f64>().ok().filter(|seconds| (0.0..=31_536_000.0).contains(seconds));
    seconds.map(Duration::from_secs_f64).ok_or_else(|| "write seconds, 0 to 31536000, for example 2.5".to_owned())
}

/// The scene's name with another ending, in the current folder.
fn default_output(scene: &Path) -> PathBuf {
    PathBuf::from(scene.file_stem().unwrap_or("eyerays".as_ref())).with_extension("png")
}
