//! What a rendering was: one line for people, JSON for machines, a bar while it runs.

use std::fmt;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};

use super::options::Loaded;
use crate::output::Destination;
use crate::render::{Choice, Rendering};

/// Everything worth knowing about a rendering.
pub(super) struct Summary<'a> {
    destination: &'a Destination,
    choice: &'a Choice,
    loaded: &'a Loaded,
    rendering: &'a Rendering,
}

impl<'a> Summary<'a> {
    pub fn new(destination: &'a Destination, choice: &'a Choice, loaded: &'a Loaded, rendering: &'a Rendering) -> Self {
        Summary { destination, choice, loaded, rendering }
    }

    fn precision(&self) -> String {
        format!("{:?}", self.choice.precision).to_lowercase()
    }

    /// Millions of rays a second of device time, or of all time.
    fn mrays(&self) -> f64 {
        let time = self.rendering.device_time.unwrap_or(self.rendering.time);
        self.rendering.rays.total() as f64 / time.as_secs_f64().max(1e-9) / 1e6
    }

    pub fn json(&self) -> Value {
        let settings = &self.loaded.packed.settings;
        let statistics = &self.loaded.packed.statistics;
        json!({
            "output": self.destination.to_string(),
            "width": settings.size.0,
            "height": settings.size.1,
            "samples": settings.samples,
            "bounces": settings.bounces,
            "precision": self.precision(),
            "device": self.rendering.device,
            "why": self.rendering.why,
            "triangles": statistics.triangles,
            "rays": self.rendering.rays,
            "film_hash": self.rendering.film.hash(),
            "mrays_per_second": self.mrays(),
            "load_ms": milliseconds(self.loaded.load_time),
            "build_ms": milliseconds(self.loaded.packed.build_time),
            "render_ms": milliseconds(self.rendering.time),
            "device_ms": self.rendering.device_time.map(milliseconds),
        })
    }
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

impl fmt::Display for Summary<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (width, height) = self.loaded.packed.settings.size;
        let (rendering, rays) = (self.rendering, self.rendering.rays);
        write!(out, "{}: {width}x{height} in {} precision", self.destination, self.precision())?;
        write!(out, " on {} ({})", rendering.device, rendering.why)?;
        write!(out, "; {} primary, {} shadow, {} secondary rays", rays.primary, rays.shadow, rays.secondary)?;
        write!(out, ", {:.1} Mrays/s", self.mrays())?;
        write!(out, "; load {}, build {}", span(self.loaded.load_time), span(self.loaded.packed.build_time))?;
        write!(out, ", render {}", span(rendering.time))?;
        if let Some(time) = rendering.device_time {
            write!(out, " ({} on the device)", span(time))?;
        }
        write!(out, "; {} non-finite pixels", rays.non_finite)
    }
}

/// A time with three digits.
fn span(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    if seconds >= 1.0 { format!("{seconds:.2} s") } else { format!("{:.2} ms", seconds * 1e3) }
}

/// A bar over pixels on standard error, if that is a terminal.
pub(super) fn bar(pixels: u64, quiet: bool) -> ProgressBar {
    if quiet {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("rendering {bar:40} {percent:>3} % {elapsed} (left {eta})");
    ProgressBar::new(pixels).with_style(style.expect("the template is valid"))
}
