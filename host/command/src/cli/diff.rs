//! `eyerays diff`.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use serde_json::json;

use super::console;
use super::device::DeviceArgs;
use super::options::{Effort, View};
use super::progress;
use super::reading::{Read, Reading};
use crate::error::{Error, Result};
use crate::flip::Flip;
use crate::output::{self, Destination};
use eyerays::compare::{Comparison, compare, heat_map};
use eyerays::image::{self, Encoding};
use eyerays::picture::Picture;
use eyerays::render::{Backend, DeviceWish, Precision, Rendering};
use eyerays::scene_io;

pub(super) const EXAMPLES: &str = "\
Examples:
  eyerays diff before.png after.png -o difference.png
  eyerays diff before.exr after.exr --flip-map seen.png
  eyerays diff before.exr after.exr --layer depth
  eyerays diff scenes/cornell.toml --size 256x256
Exit code 1 tells that the pictures differ by more than the tolerance.";

/// Exit code of pictures that differ.
const DIFFERENT: u8 = 1;

#[derive(Args)]
pub(super) struct Diff {
    /// A picture, or a scene to render on GPU and CPU
    first: PathBuf,
    /// The picture to compare with
    #[arg(conflicts_with_all = [
        "precision", "method", "stack_max", "cut", "scheduling", "order", "layout", "triangle", "adapter", "threads",
        "no_passthrough", "size", "samples", "sampler", "filter", "camera", "eye", "target", "fov", "projection", "orthographic", "aperture",
        "f_stop", "focus", "focus_on", "blades", "transparent", "pixel_filter", "bounces", "min_contribution",
        "cull", "no_compensation", "spectral", "caustics", "bvh", "spp", "integrator", "seed", "roulette", "clamp", "direct", "ao_distance",
        "allow_outside", "light_unit", "instances",
    ])]
    second: Option<PathBuf>,
    /// Compare this layer of two .exr files instead of their colours, for example depth, normal or ViewLayer.Mist
    #[arg(long, value_name = "NAME", requires = "second")]
    layer: Option<String>,
    /// Write a heat map of the difference (black where bits are equal)
    #[arg(short, long, value_name = "FILE")]
    output: Option<OsString>,
    /// Tell too how far the pictures look apart to a person: mean FLIP, 0 to 1, as 8 bits show them
    #[arg(long)]
    flip: bool,
    /// Write a map of FLIP (black where they look equal, pale yellow for 1), and tell the mean
    #[arg(long, value_name = "FILE")]
    flip_map: Option<OsString>,
    /// The largest absolute difference of a channel that still counts as the same
    #[arg(long, value_name = "X", default_value_t = 0.0)]
    tolerance: f32,
    /// Print the comparison as JSON to standard output
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    on: DeviceArgs,
    #[command(flatten)]
    view: View,
    #[command(flatten)]
    effort: Effort,
    #[command(flatten)]
    reading: Reading,
}

fn has_extension(file: &Path, names: &[&str]) -> bool {
    file.extension().is_some_and(|e| names.iter().any(|name| e.eq_ignore_ascii_case(name)))
}

impl Diff {
    pub fn run(&self, quiet: bool) -> Result<ExitCode> {
        if !(self.tolerance >= 0.0 && self.tolerance.is_finite()) {
            return Err(Error::new(format!("--tolerance {} is no finite number from 0 up", self.tolerance)));
        }
        let [heat, seen] = [&self.output, &self.flip_map].map(|name| name.clone().map(Destination::from));
        let outputs: Vec<Destination> = heat.iter().chain(&seen).cloned().collect();
        self.check(&outputs)?;
        let (a, b, names) = match &self.second {
            Some(second) => self.pictures(second)?,
            None => self.renderings(&outputs, quiet)?,
        };
        let comparison = compare(&a, &b)?;
        let looks = self.flip || seen.is_some();
        let flip = looks.then(|| progress::stage("measuring FLIP", quiet, || Flip::new(&a, &b))).transpose()?;
        if let Some(destination) = &heat {
            output::write_picture(&heat_map(&a, &b)?, destination, &Encoding::default())?;
        }
        if let (Some(destination), Some(flip)) = (&seen, &flip) {
            output::write_picture(&flip.map()?, destination, &Encoding::default())?;
        }
        self.report(&comparison, flip.as_ref(), &names, quiet)?;
        let differs = comparison.exceeds(self.tolerance);
        Ok(if differs { ExitCode::from(DIFFERENT) } else { ExitCode::SUCCESS })
    }

    /// Refuses outputs that cannot be written or would replace what is read.
    fn check(&self, outputs: &[Destination]) -> Result<()> {
        if outputs.iter().filter(|output| **output == Destination::Stdout).count() > 1 {
            return Err(Error::new("-o - and --flip-map - both write to standard output: name a file for one of them"));
        }
        for output in outputs {
            super::one_on_stdout(self.json, output)?;
            output.format()?;
        }
        output::check_apart(outputs, self.second.iter().chain([&self.first]))?;
        outputs.iter().try_for_each(output::check_writable)
    }

    fn pictures(&self, second: &PathBuf) -> Result<(Picture, Picture, [String; 2])> {
        for file in [&self.first, second] {
            if has_extension(file, &["toml", "obj", scene_io::ENDING]) {
                return Err(Error::file(
                    file,
                    "a scene is compared alone, from GPU and CPU; render two to compare them",
                ));
            }
        }
        let names = [&self.first, second].map(|path| path.display().to_string());
        let read = |path: &Path| match &self.layer {
            Some(name) => image::read_layer(path, name),
            None => image::read(path),
        };
        Ok((read(&self.first)?, read(second)?, names))
    }

    /// The unquantised pictures of a scene from GPU and CPU.
    fn renderings(&self, outputs: &[Destination], quiet: bool) -> Result<(Picture, Picture, [String; 2])> {
        if has_extension(&self.first, &["png", "exr", "hdr"]) {
            return Err(Error::file(&self.first, "a picture needs a second one to compare with"));
        }
        if self.on.precision() == Precision::Reference {
            return Err(Error::new("reference precision is the CPU's alone: there is no GPU to compare with"));
        }
        let gpu_choice = self.on.choice(DeviceWish::Gpu)?;
        let cpu_choice = eyerays::render::Choice { device: DeviceWish::Cpu, ..gpu_choice.clone() };
        let loading = self.reading.loading(self.effort.integrator());
        let read = Read::scene(&self.first, outputs, loading, quiet)?;
        let loaded = self.view.pack(read, &self.effort, &gpu_choice, quiet)?;
        let (width, height) = loaded.packed.settings().size;
        let progress = progress::pixels(2 * u64::from(width) * u64::from(height), quiet || self.json);
        let render = |choice| -> Result<Rendering> {
            Ok(Backend::new(choice)?.render(&loaded.packed, &loaded.view, 1, &|pixels| progress.inc(pixels))?)
        };
        let renderings = render(&gpu_choice).and_then(|gpu| Ok((gpu, render(&cpu_choice)?)));
        progress.finish_and_clear();
        let (gpu, cpu) = renderings?;
        if gpu.rays != cpu.rays {
            super::warn(&[format!("the GPU counted {:?}, the CPU {:?}", gpu.rays, cpu.rays)], quiet);
        }
        Ok((gpu.picture, cpu.picture, [gpu.device, cpu.device]))
    }

    fn report(&self, comparison: &Comparison, flip: Option<&Flip>, names: &[String; 2], quiet: bool) -> Result<()> {
        let mean = flip.map(Flip::mean);
        if self.json {
            return console::print_json(
                &json!({ "first": names[0], "second": names[1], "layer": self.layer, "comparison": comparison, "mean_flip": mean }),
            );
        }
        if quiet {
            return Ok(());
        }
        let layer = self.layer.as_ref().map_or_else(String::new, |name| format!(", layer {name}"));
        console::print_line(format_args!("{} against {}{layer}", names[0], names[1]))?;
        console::print(&comparison.to_string())?;
        mean.map_or(Ok(()), |mean| console::print_line(format_args!("mean FLIP           {mean:.6}")))
    }
}
