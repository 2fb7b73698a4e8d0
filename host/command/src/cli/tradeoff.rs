//! `eyerays tradeoff`.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, ValueEnum};

use super::choice::choice;
use super::console;
use super::device;
use super::hush;
use super::options::{Effort, View};
use super::progress;
use super::reading::{Read, Reading};
use super::threads;
use crate::error::{Error, Result, within};
use crate::output::{self, Destination, write_error};
use crate::tradeoff::{self, Axes, Plan, Record, Report, Subject, Wish};
use eyerays::method::{Layout, Method, TriangleTest};
use eyerays::quality::Bvh;
use eyerays::render::{Backend, Choice, DeviceWish};
use eyerays::scene::{Filter, Integrator, Sampler, Settings};

pub(super) const EXAMPLES: &str = "\
Examples:
  eyerays tradeoff scenes/cornell.toml --quick
  eyerays tradeoff scenes/cornell.toml --max-error 0.01 --save fast.toml -o trade.svg -o trade.csv
  eyerays render scenes/cornell.toml --settings fast.toml
Exit code 1 tells that no setting serves --max-error or --budget.";

/// Exit code of a wish that nothing serves.
const UNSERVED: u8 = 1;
/// How many times more samples than is tried the reference has, where light is sampled.
const MORE: u32 = 16;
/// What a file of `--save` begins with, as a comment.
const SAVED: &str = "eyerays tradeoff";

#[derive(Args)]
pub(super) struct Tradeoff {
    /// A scene (.toml), or a bare mesh (.obj)
    scene: PathBuf,
    /// Also write the tables (.md), every measurement (.csv, .json) or a plot (.svg); may be given several times
    #[arg(short, long, value_name = "FILE")]
    output: Vec<OsString>,
    /// A run of about a minute: 256x256, 3 repetitions, at most 40 settings; other options override it
    #[arg(long)]
    quick: bool,
    /// How often each setting is rendered after a warm-up [default: 5]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    repeat: Option<u32>,
    /// The most settings that are tried [default: 100]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    trials: Option<u32>,
    /// Samples of a pixel of the reference where light is sampled [default: 16 times the most that are tried]
    #[arg(long, value_name = "N")]
    reference_spp: Option<u32>,
    #[command(flatten)]
    wishes: Wishes,
    #[command(flatten)]
    tried: Tried,
    #[command(flatten)]
    view: View,
    #[command(flatten)]
    on: Device,
    #[command(flatten)]
    reading: Reading,
}

/// What to recommend.
#[derive(Args)]
#[command(next_help_heading = "Recommendation")]
struct Wishes {
    /// Recommend the fastest setting whose RMSE is at most this
    #[arg(long, value_name = "X", conflicts_with = "budget", allow_negative_numbers = true)]
    max_error: Option<f64>,
    /// Recommend the most accurate setting that takes at most so many milliseconds
    #[arg(long, value_name = "MS", allow_negative_numbers = true)]
    budget: Option<f64>,
    /// Keep the recommended setting, for `eyerays render --settings FILE`
    #[arg(long, value_name = "FILE")]
    save: Option<PathBuf>,
}

/// Which settings.
#[derive(Args)]
#[command(next_help_heading = "Settings to try")]
struct Tried {
    /// Precisions, for example exact,fast; a CPU has exact alone [default: both]
    #[arg(long, value_enum, value_delimiter = ',')]
    precision: Vec<Precision>,
    /// Triangle tests of fast precision [default: all]
    #[arg(long, value_name = "TEST", value_parser = choice::<TriangleTest>(), value_delimiter = ',')]
    triangle: Vec<TriangleTest>,
    /// How rays are followed, for example auto,packet [default: all]
    #[arg(long, value_parser = choice::<Method>(), value_delimiter = ',')]
    methods: Vec<Method>,
    /// How the hierarchy and its triangles lie in memory [default: all]
    #[arg(long, value_parser = choice::<Layout>(), value_delimiter = ',')]
    layout: Vec<Layout>,
    /// Qualities of the hierarchy [default: all]
    #[arg(long, value_name = "QUALITY", value_parser = choice::<Bvh>(), value_delimiter = ',')]
    bvh: Vec<Bvh>,
    /// How light is carried; the reference is by the one that leaves out least [default: the scene's]
    #[arg(long, value_parser = choice::<Integrator>(), value_delimiter = ',')]
    integrator: Vec<Integrator>,
    /// Where in a pixel its samples lie [default: the scene's, and where light is sampled all that draw]
    #[arg(long, value_parser = choice::<Sampler>(), value_delimiter = ',')]
    sampler: Vec<Sampler>,
    /// What a ray sees of a texture [default: the scene's, and where it has textures all]
    #[arg(long, value_parser = choice::<Filter>(), value_delimiter = ',')]
    filter: Vec<Filter>,
    /// Whether light of single wavelengths is followed [default: the scene's, and where it is so both]
    #[arg(long, value_name = "BOOL", value_delimiter = ',')]
    spectral: Vec<bool>,
    /// Photons for each pixel and sample that tell of caustics, 0 for none [default: the scene's, and where it has some none]
    #[arg(long, value_name = "PHOTONS", value_delimiter = ',')]
    caustics: Vec<f32>,
    /// Samples along a pixel's edge; the reference has the most [default: the scene's and 1,2,4; 1,2 with --quick]
    #[arg(long, value_name = "N", value_delimiter = ',')]
    samples: Vec<u32>,
    /// Samples of a pixel, instead or beside [default where light is sampled: the scene's, a fourth and so on; with
    /// --quick at most 4]
    #[arg(long, value_name = "N", value_delimiter = ',')]
    spp: Vec<u32>,
    /// Limits of bounces [default: the scene's, 0 and the powers of two below]
    #[arg(long, value_name = "N", value_delimiter = ',')]
    bounces: Vec<u32>,
    /// Least shares of a pixel that rays are followed for [default: the scene's, and 4, 16 and 64 times that]
    #[arg(long, value_name = "SHARE", value_delimiter = ',')]
    min_contribution: Vec<f32>,
    /// Path: bounces before chance may end a path [default: the scene's, 0 and 65535]
    #[arg(long, value_name = "N", value_delimiter = ',')]
    roulette: Vec<u32>,
    /// Path, distributed: the most that light adds to a sample which was scattered more than once, 0 for no limit
    /// [default: the scene's, 0, 10 and 1]
    #[arg(long, value_name = "RADIANCE", value_delimiter = ',')]
    clamp: Vec<f32>,
}

/// On what.
#[derive(Args)]
#[command(next_help_heading = "Device")]
struct Device {
    /// Where to render; the reference is the CPU's
    #[arg(long, value_parser = choice::<DeviceWish>(), default_value_t = DeviceWish::Auto)]
    device: DeviceWish,
    /// A GPU by its number or a part of its name, as `eyerays info` lists them
    #[arg(long, value_name = "NAME|INDEX")]
    adapter: Option<String>,
    /// CPU threads [default: one a core]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Precision {
    /// The same bits everywhere
    Exact,
    /// The device's own arithmetic
    Fast,
}

/// What is written of a report.
#[derive(Clone, Copy)]
enum Format {
    Markdown,
    Csv,
    Json,
    Svg,
}

impl Tradeoff {
    pub fn run(&self, quiet: bool) -> Result<ExitCode> {
        let wish = self.wishes.wish()?;
        let outputs = self.outputs()?;
        let choice = self.choice()?;
        let subject = self.subject(quiet)?;
        let mut plan = self.plan(&subject, wish, quiet)?;
        let device = Backend::new(&choice)?;
        if device.gpu().is_none() {
            plan.axes.on_cpu();
        }
        let progress = progress::steps(tradeoff::steps(&plan), quiet);
        let report = tradeoff::run(&plan, &subject, device, &|step| console::step(&progress, step));
        progress.finish_and_clear();
        let report = report?;
        for (path, format) in &outputs {
            write(path, &text(&report, *format, wish)?)?;
        }
        let printed = if quiet { Ok(()) } else { console::print(&tradeoff::markdown(&report)) };
        // What is recommended is kept even where the tables could not be printed.
        let code = self.answer(&report, wish, quiet)?;
        printed.map(|()| code)
    }

    /// Tells and keeps what is recommended.
    fn answer(&self, report: &Report, wish: Option<Wish>, quiet: bool) -> Result<ExitCode> {
        let Some(wish) = wish else { return Ok(ExitCode::SUCCESS) };
        let Some(best) = report.recommended() else {
            let (scene, nearest) = (&report.scene, nearest(report, wish));
            console::say(format_args!("error: {scene}: no setting that was tried serves {wish}: {nearest}"));
            return Ok(ExitCode::from(UNSERVED));
        };
        if let Some(path) = &self.wishes.save {
            let of = |key: &str| report.setup.iter().find(|(name, _)| name == key).map_or("", |(_, value)| value);
            let comment = format!(
                "{SAVED} {} {wish}: {:.2} ms, RMSE {:.2e}, {} on {}",
                self.scene.display(),
                best.time_ms,
                best.rmse,
                of("size"),
                of("device")
            );
            write(path, &best.setting.preset(self.on.device).text(&comment))?;
            if !quiet {
                let (path, scene) = (path.display(), self.scene.display());
                console::say(format_args!("{path}: eyerays render {scene} --settings {path}"));
            }
        }
        Ok(ExitCode::SUCCESS)
    }

    /// Where the report goes; fails early where writing would fail late.
    fn outputs(&self) -> Result<Vec<(PathBuf, Format)>> {
        let outputs = self.output.iter().map(|name| {
            let path = PathBuf::from(name);
            format(&path).map(|format| (path, format))
        });
        let outputs: Vec<_> = outputs.collect::<Result<_>>()?;
        let all = self.destinations();
        output::check_apart(&all, [&self.scene])?;
        if let Some(path) = &self.wishes.save {
            output::check_own(path, SAVED, "--save")?;
        }
        all.iter().try_for_each(output::check_writable)?;
        Ok(outputs)
    }

    /// Every file that is written.
    fn destinations(&self) -> Vec<Destination> {
        let reports = self.output.iter().map(PathBuf::from);
        reports.chain(self.wishes.save.clone()).map(Destination::File).collect()
    }

    fn choice(&self) -> Result<Choice> {
        if self.on.device == DeviceWish::Cpu && self.on.adapter.is_some() {
            return Err(Error::new("--adapter is for GPUs: drop it, or --device cpu"));
        }
        if self.on.device == DeviceWish::Cpu && self.tried.precision.contains(&Precision::Fast) {
            return Err(Error::new("--precision fast is for GPUs: a CPU is exact; drop it, or --device cpu"));
        }
        device::check_processor(&self.tried.triangle, self.on.device)?;
        Ok(Choice {
            device: self.on.device,
            precision: if self.tried.exact() { Default::default() } else { eyerays::render::Precision::Fast },
            adapter: self.on.adapter.clone(),
            threads: threads::chosen(self.on.threads)?,
            around: Some(hush::around),
            ..Choice::default()
        })
    }

    fn subject(&self, quiet: bool) -> Result<Subject> {
        let mut scene = Read::scene(&self.scene, &self.destinations(), self.reading.flat()?, quiet)?.unbuilt();
        let mut settings = self.view.settings(&scene, &Effort::default())?;
        if self.quick && self.view.size().is_none() {
            settings.size = (256, 256);
        }
        let name = self.scene.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        // One filter for all integrators, whose pictures are compared.
        settings.pixel_filter = Some(settings.pixel_filter());
        let camera = self.view.aim(&mut scene)?;
        scene.cameras.push(camera.clone());
        Ok(Subject { name, file: self.scene.clone(), scene, camera, settings })
    }

    fn plan(&self, subject: &Subject, wish: Option<Wish>, quiet: bool) -> Result<Plan> {
        let mut axes = Axes::of(&subject.scene, &subject.settings, &self.tried.integrator);
        if self.quick {
            axes.hurry(&subject.settings);
        }
        self.tried.restrict(&mut axes)?;
        for integrator in &axes.integrators {
            super::warn(integrator.ignored(&subject.scene).as_slice(), quiet);
        }
        let (repeat, trials) = if self.quick { (3, 40) } else { (5, 100) };
        within("--reference-spp", self.reference_spp.as_slice(), 2..=Settings::MOST_SPP)?;
        let many = axes.most_samples().saturating_mul(MORE).clamp(2, Settings::MOST_SPP);
        Ok(Plan {
            repeat: self.repeat.unwrap_or(repeat),
            trials: self.trials.unwrap_or(trials) as usize,
            reference_spp: self.reference_spp.unwrap_or(many),
            axes,
            wish,
        })
    }
}

impl Wishes {
    fn wish(&self) -> Result<Option<Wish>> {
        let positive = |option: &str, x: f64| match x > 0.0 && x.is_finite() {
            true => Ok(x),
            false => Err(Error::new(format!("{option} {x} is no finite number above 0"))),
        };
        match (self.max_error, self.budget) {
            (Some(x), _) => Ok(Some(Wish::MaxError(positive("--max-error", x)?))),
            (_, Some(x)) => Ok(Some(Wish::Budget(positive("--budget", x)?))),
            _ if self.save.is_some() => {
                Err(Error::new("--save keeps what is recommended: say what for, by --max-error or --budget"))
            }
            _ => Ok(None),
        }
    }
}

impl Tried {
    fn exact(&self) -> bool {
        self.precision.is_empty() || self.precision.contains(&Precision::Exact)
    }

    /// Leaves of the axes what was asked for.
    fn restrict(&self, axes: &mut Axes) -> Result<()> {
        let fast = self.precision.is_empty() || self.precision.contains(&Precision::Fast);
        device::check_tests(&self.triangle, fast)?;
        axes.arithmetic.retain(|&(precision, triangle)| match precision {
            eyerays::render::Precision::Fast => fast && (self.triangle.is_empty() || self.triangle.contains(&triangle)),
            _ => self.exact(),
        });
        within("--samples", &self.samples, 1..=Settings::MOST_SAMPLES)?;
        within("--spp", &self.spp, 1..=Settings::MOST_SPP)?;
        within("--bounces", &self.bounces, 0..=Settings::MOST_BOUNCES)?;
        within("--min-contribution", &self.min_contribution, 0.0..=1.0)?;
        within("--caustics", &self.caustics, 0.0..=Settings::MOST_PHOTONS)?;
        replace(&mut axes.methods, &self.methods);
        replace(&mut axes.layouts, &self.layout);
        replace(&mut axes.bvhs, &self.bvh);
        within("--roulette", &self.roulette, 0..=Settings::MOST_BOUNCES)?;
        within("--clamp", &self.clamp, 0.0..=f32::MAX)?;
        let edges = self.samples.iter().map(|&edge| (edge, 0));
        let samples: Vec<_> = edges.chain(self.spp.iter().map(|&spp| (1, spp))).collect();
        replace(&mut axes.samples, &samples);
        replace(&mut axes.samplers, &self.sampler);
        replace(&mut axes.filters, &self.filter);
        replace(&mut axes.spectral, &self.spectral.iter().copied().map(Some).collect::<Vec<_>>());
        replace(&mut axes.caustics, &self.caustics.iter().copied().map(Some).collect::<Vec<_>>());
        replace(&mut axes.bounces, &self.bounces);
        replace(&mut axes.min_contributions, &self.min_contribution);
        replace(&mut axes.roulettes, &self.roulette);
        replace(&mut axes.clamps, &self.clamp);
        axes.sort();
        Ok(())
    }
}

/// What was asked for, if anything was.
fn replace<T: Clone>(values: &mut Vec<T>, asked: &[T]) {
    if !asked.is_empty() {
        *values = asked.to_vec();
    }
}

fn format(path: &Path) -> Result<Format> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some("md") => Ok(Format::Markdown),
        Some("csv") => Ok(Format::Csv),
        Some("json") => Ok(Format::Json),
        Some("svg") => Ok(Format::Svg),
        _ => Err(Error::file(path, "unknown kind of report; name a .md, .csv, .json or .svg file")),
    }
}

fn text(report: &Report, format: Format, wish: Option<Wish>) -> Result<String> {
    match format {
        Format::Markdown => Ok(tradeoff::markdown(report)),
        Format::Csv => Ok(tradeoff::csv(report)),
        Format::Json => console::json(report),
        Format::Svg => tradeoff::plot(report, wish),
    }
}

fn write(path: &Path, text: &str) -> Result<()> {
    Destination::File(path.to_owned()).write(|out| out.write_all(text.as_bytes()).map_err(|e| write_error(&e)))
}

/// What comes nearest to a wish that nothing serves.
fn nearest(report: &Report, wish: Wish) -> String {
    let least = |of: fn(&Record) -> f64| {
        let least = report.records.iter().min_by(|a, b| of(a).total_cmp(&of(b)));
        least.map(|record| (of(record), record.setting.options()))
    };
    let (found, what) = match wish {
        Wish::MaxError(_) => (least(|record| record.rmse), "the least RMSE is"),
        Wish::Budget(_) => (least(|record| record.slowest_ms), "the fastest takes up to, in ms,"),
    };
    found.map_or_else(String::new, |(value, options)| format!("{what} {value:.3e}, by {options}"))
}
