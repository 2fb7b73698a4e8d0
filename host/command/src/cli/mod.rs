//! The command line.

mod animation;
mod bench;
mod beside;
mod camera;
mod check;
mod checkpoint;
mod choice;
mod console;
mod convert;
mod denoising;
mod device;
mod devices;
mod diff;
mod exposure;
mod facts;
mod farm;
mod footprint;
mod generate;
mod hush;
mod info;
mod lens;
#[cfg(feature = "view")]
mod listen;
mod live;
mod look;
mod manual;
mod merge;
mod noise;
mod options;
mod outline;
mod part;
mod progress;
mod reading;
mod render;
mod sequence;
mod shot;
mod shutter;
#[cfg(unix)]
mod signals;
mod steps;
mod summary;
mod threads;
mod tip;
mod trace_pixel;
mod tradeoff;
mod transport;
#[cfg(feature = "view")]
mod view;
mod watching;

use std::fmt::Display;
use std::process::ExitCode;
use std::time::Duration;

use clap::{CommandFactory, Parser, Subcommand};
use eyerays::line::plural;

use crate::error::{Error, Result};
use crate::output::Destination;

/// Exit code of a command that failed on what it was given.
const BAD_INPUT: u8 = 2;

const CODES: &str = "\
Pictures and tables go to files and standard output, summaries and messages to standard error.
Exit codes: 0 done, 1 pictures or answers that differ, 2 something wrong with what was given,
128 and the signal's number where one ended it.";

/// A ray tracer, after Whitted and by paths: one Rust source on GPU and CPU, with the same bits.
#[derive(Parser)]
#[command(name = "eyerays", version, max_term_width = 100, after_help = CODES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    /// Say nothing but errors
    #[arg(short, long, global = true)]
    quiet: bool,
    /// Say more: warnings of drivers; twice for debugging
    #[arg(short, long, global = true, action = clap::ArgAction::Count, conflicts_with = "quiet")]
    verbose: u8,
}

#[derive(Subcommand)]
enum Command {
    /// Render a scene to a picture
    #[command(after_help = render::EXAMPLES, allow_negative_numbers = true)]
    Render(Box<render::Render>),
    /// Open a window on a scene
    #[cfg(feature = "view")]
    #[command(after_help = view::EXAMPLES, allow_negative_numbers = true)]
    View(Box<view::Window>),
    /// Open a window on what renderers send to tev, such as render --live
    #[cfg(feature = "view")]
    #[command(after_help = listen::EXAMPLES, allow_negative_numbers = true)]
    Listen(listen::Listen),
    /// Put the parts of a picture together
    #[command(after_help = merge::EXAMPLES, allow_negative_numbers = true)]
    Merge(merge::Merge),
    /// Divide a picture among machines: write a job for a render farm or a cluster
    #[command(after_help = farm::EXAMPLES)]
    Farm(farm::Farm),
    /// Compare two pictures, or a scene's pictures from GPU and CPU
    #[command(after_help = diff::EXAMPLES, allow_negative_numbers = true)]
    Diff(Box<diff::Diff>),
    /// Measure every method, kind of rays and device, as tables
    #[command(after_help = bench::EXAMPLES)]
    Bench(Box<bench::Bench>),
    /// Measure what speed costs a scene's picture, and recommend a setting
    #[command(after_help = tradeoff::EXAMPLES, allow_negative_numbers = true)]
    Tradeoff(Box<tradeoff::Tradeoff>),
    /// Follow the ray of a pixel: what it shows, and every node and triangle that is tested for it
    #[command(after_help = trace_pixel::EXAMPLES, allow_negative_numbers = true)]
    TracePixel(Box<trace_pixel::TracePixel>),
    /// List the GPUs of this machine, or tell a scene's figures
    Info(info::Info),
    /// Validate a scene and render nothing
    Check(check::Check),
    /// Write a scene as one binary file that loads at once, or a model as a scene file to change
    #[command(after_help = convert::EXAMPLES)]
    Convert(convert::Convert),
    /// Make a scene of any number of triangles or spheres to measure with
    #[command(after_help = generate::EXAMPLES)]
    Generate(generate::Generate),
    /// Print what a shell needs to complete this program's commands and options
    #[command(after_help = manual::COMPLETIONS)]
    Completions(manual::Completions),
    /// Write the manual's pages, one a command
    #[command(after_help = manual::MANUAL)]
    Manual(manual::Manual),
}

/// Runs the command line of this process.
pub fn run() -> ExitCode {
    let outcome = Cli::try_parse().map_or_else(explain, execute);
    outcome.unwrap_or_else(|error| {
        console::say(format_args!("error: {error}"));
        ExitCode::from(BAD_INPUT)
    })
}

/// Prints the help or version that was asked for, or says what is wrong with the command line.
fn explain(said: clap::Error) -> Result<ExitCode> {
    if said.use_stderr() {
        let arguments: Vec<String> = std::env::args_os().map(|a| a.to_string_lossy().into_owned()).collect();
        let said = tip::mended(said, Cli::command(), &arguments);
        console::say_text(&said.render().to_string());
        return Ok(ExitCode::from(BAD_INPUT));
    }
    // In color, which only clap knows how to print.
    console::printed(said.print())?;
    Ok(ExitCode::SUCCESS)
}

fn execute(cli: Cli) -> Result<ExitCode> {
    log(cli.verbose);
    threads::check_environment()?;
    #[cfg(unix)]
    signals::watch()
        .map_err(|e| Error::new(format!("no thread can be started: {e}; allow more of them (ulimit -u)")))?;
    match cli.command {
        Command::Render(command) => command.run(cli.quiet),
        #[cfg(feature = "view")]
        Command::View(command) => command.run(),
        #[cfg(feature = "view")]
        Command::Listen(command) => command.run(),
        Command::Merge(command) => command.run(cli.quiet),
        Command::Farm(command) => command.run(cli.quiet),
        Command::Diff(command) => command.run(cli.quiet),
        Command::Bench(command) => command.run(cli.quiet),
        Command::Tradeoff(command) => command.run(cli.quiet),
        Command::TracePixel(command) => command.run(cli.quiet),
        Command::Info(command) => command.run(cli.quiet),
        Command::Check(command) => command.run(cli.quiet),
        Command::Convert(command) => command.run(cli.quiet),
        Command::Generate(command) => command.run(cli.quiet),
        Command::Completions(command) => command.run(),
        Command::Manual(command) => command.run(cli.quiet),
    }
}

fn log(verbose: u8) {
    let level = ["off", "warn", "debug"][usize::from(verbose).min(2)];
    let filter = tracing_subscriber::EnvFilter::try_from_default_env();
    let filter = filter.unwrap_or_else(|_| tracing_subscriber::EnvFilter::new(level));
    let log = tracing_subscriber::fmt().with_env_filter(filter).with_writer(std::io::stderr).without_time();
    // It would tell standard error that standard error failed, and panic.
    log.log_internal_errors(false).init();
}

/// Warnings, each on its line.
fn warn(warnings: &[impl Display], quiet: bool) {
    for warning in warnings.iter().filter(|_| !quiet) {
        console::say(format_args!("warning: {warning}"));
    }
}

/// A time of at most a year.
fn seconds(text: &str) -> std::result::Result<Duration, String> {
    let seconds = text.parse::<f64>().ok().filter(|seconds| (0.0..=31_536_000.0).contains(seconds));
    seconds.map(Duration::from_secs_f64).ok_or_else(|| "write seconds, 0 to 31536000, for example 2.5".to_owned())
}

/// Standard output is for the JSON or for a picture.
fn one_on_stdout(json: bool, picture: &Destination) -> Result<()> {
    if json && matches!(picture, Destination::Stdout) {
        return Err(Error::new(
            "--json and a picture named - both write to standard output: name a file for the picture",
        ));
    }
    Ok(())
}
