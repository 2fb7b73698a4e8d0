//! `eyerays view`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use eyerays::gpu::Around;
use eyerays::render::{Choice, DeviceWish};
use eyerays::scene;
use eyerays::scene_io;
use eyerays_view::{Device, Opening, Read, Reader, Source};

use super::console;
use super::device::DeviceArgs;
use super::devices::Devices;
use super::hush;
use super::look::Shown;
use super::options::{Effort, View};
use super::reading::{self, Reading};
use super::sequence::Instant;
use crate::error::{Error, Result};

pub(super) const EXAMPLES: &str = "\
Examples:
  eyerays view scenes/cornell_path.toml
  eyerays view model.glb --device cpu
  eyerays view scenes/room.toml --size 640x360 --tone agx

Drag to orbit, turn the wheel to come nearer, press N for all that may be changed and for the other keys.";

#[derive(Args)]
pub(super) struct Window {
    /// A scene, as render takes it; without one the window waits for a file to be dropped
    scene: Option<PathBuf>,
    /// Where to render: auto is a GPU when one works, else the CPU; gpu; cpu; all of them together; or several by their numbers or
    /// names, such as gpu:0,gpu:1,cpu
    #[arg(long, value_parser = Devices::parse, default_value = "auto")]
    device: Devices,
    #[command(flatten)]
    shown: Shown,
    #[command(flatten)]
    on: DeviceArgs,
    #[command(flatten)]
    of: Scenes,
}

/// How scenes are read, and seen at first.
#[derive(Args)]
struct Scenes {
    #[command(flatten)]
    seen: View,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    effort: Effort,
}

impl Window {
    pub fn run(self) -> Result<ExitCode> {
        if self.scene.as_deref().is_some_and(reading::is_standard_input) {
            return Err(Error::new("a window reads its scene again when it changes: name its file"));
        }
        if self.of.seen.has_focus_on() {
            return Err(Error::new("--focus-on is a click in the window, with ctrl held: leave it out"));
        }
        let look = self.shown.encoding()?;
        let (wish, several) = match self.device {
            Devices::Several(several) => (DeviceWish::Auto, Some(several)),
            Devices::One(device) => (device, None),
        };
        let choice = Choice { several, ..self.on.choice(wish)? };
        let (size, most, device) = (self.of.seen.size(), self.of.effort.spp(), Device::of(&choice));
        let reader = Box::new(Asked { of: self.of, choice });
        // Nobody may read them.
        let told = Box::new(|line: &str| drop(console::print_line(format_args!("{line}"))));
        let around = Some(hush::around as Around);
        eyerays_view::open(Opening { path: self.scene, reader, device, size, most, look, around, told })?;
        Ok(ExitCode::SUCCESS)
    }
}

/// Reads scenes as the command line asks.
struct Asked {
    of: Scenes,
    choice: Choice,
}

impl Asked {
    fn read(&self, source: &Source) -> Result<Read> {
        let Scenes { seen, reading, effort } = &self.of;
        let at = source.seconds.map(|seconds| reading.at(Instant::unnumbered(seconds, Instant::RATE)));
        let loading = at.as_ref().unwrap_or(reading).loading(effort.integrator());
        let (mut scene, warnings) = scene_io::load_as(&source.path, loading)?;
        let settings = seen.settings(&scene, effort)?;
        let integrator = settings.transport.integrator;
        if integrator != scene.settings.transport.integrator {
            scene::without_spare_lamps(&mut scene, integrator);
        }
        let ignored = integrator.ignored(&scene);
        let warnings = warnings.iter().map(ToString::to_string).chain(ignored).collect();
        let camera = seen.aim(&mut scene)?;
        let quality = effort.quality(&scene, &settings, &self.choice);
        Ok(Read { scene, settings, camera, quality, warnings })
    }
}

impl Reader for Asked {
    fn read(&mut self, source: &Source) -> std::result::Result<Read, String> {
        Asked::read(self, source).map_err(|error| error.of(&source.path).to_string())
    }
}
