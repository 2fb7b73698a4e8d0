//! What a rendering was: one line for people, JSON for machines.

use std::fmt;
use std::time::Duration;

use serde_json::{Value, json};

use super::options::Loaded;
use crate::output::Destination;
use crate::remedy;
use eyerays::choice::Named;
use eyerays::render::{Choice, Rendering};

/// Wall-clock times of the parts of a rendering, one after the other, and the device's beside its own.
pub(super) struct Times {
    read: Duration,
    /// The hierarchy, and packing the scene for a device.
    build: Duration,
    prepare: Duration,
    render: Duration,
    device: Option<Duration>,
    layers: Option<Duration>,
    write: Duration,
}

impl Times {
    /// With what the layers took, where there are any, and writing the picture.
    pub fn new(loaded: &Loaded, rendering: &Rendering, layers: Option<Duration>, write: Duration) -> Self {
        Times {
            read: loaded.read_time,
            build: loaded.build_time,
            prepare: rendering.prepare_time,
            render: rendering.time,
            device: rendering.device_time,
            layers,
            write,
        }
    }
}

impl fmt::Display for Times {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "read {}, build and pack {}, prepare {}", span(self.read), span(self.build), span(self.prepare))?;
        write!(out, ", render {}", span(self.render))?;
        if let Some(time) = self.device {
            write!(out, " ({} of it on the device)", span(time))?;
        }
        if let Some(time) = self.layers {
            write!(out, ", layers {}", span(time))?;
        }
        write!(out, ", write {}", span(self.write))
    }
}

/// Everything worth knowing about a rendering.
pub(super) struct Summary<'a> {
    destination: &'a Destination,
    choice: &'a Choice,
    loaded: &'a Loaded,
    rendering: &'a Rendering,
    times: Times,
}

impl<'a> Summary<'a> {
    pub fn new(
        destination: &'a Destination,
        choice: &'a Choice,
        loaded: &'a Loaded,
        rendering: &'a Rendering,
        times: Times,
    ) -> Self {
        Summary { destination, choice, loaded, rendering, times }
    }

    fn precision(&self) -> String {
        format!("{:?}", self.choice.precision).to_lowercase()
    }

    /// What noise was asked for, if it decided.
    fn noise_target(&self) -> Option<f64> {
        self.rendering.film.as_ref()?.cells().map(|cells| cells.target().noise())
    }

    /// Millions of rays a second of some time.
    fn mrays(&self, time: Duration) -> f64 {
        self.rendering.rays.total() as f64 / time.as_secs_f64().max(1e-9) / 1e6
    }

    pub fn json(&self) -> Value {
        let settings = &self.loaded.packed.settings();
        let times = &self.times;
        json!({
            "output": self.destination.to_string(),
            "picture": self.rendering.picture.about.facts(),
            "width": settings.size.0,
            "height": settings.size.1,
            "samples": settings.samples,
            "spp": self.rendering.samples,
            "integrator": settings.transport.integrator.name(),
            "seed": settings.transport.seed,
            "noise": self.rendering.picture.noise(),
            "noise_target": self.noise_target(),
            "sampler": settings.sampler.name(),
            "bounces": settings.bounces,
            "precision": self.precision(),
            "device": self.rendering.device,
            "why": remedy::why(self.rendering),
            "primitives": self.loaded.packed.primitive_count(),
            "rays": self.rendering.rays,
            "film_hash": self.rendering.picture.hash(),
            "mrays_per_second": self.mrays(times.render),
            "device_mrays_per_second": times.device.map(|time| self.mrays(time)),
            "read_ms": milliseconds(times.read),
            "build_ms": milliseconds(times.build),
            "prepare_ms": milliseconds(times.prepare),
            "render_ms": milliseconds(times.render),
            "device_ms": times.device.map(milliseconds),
            "layers_ms": times.layers.map(milliseconds),
            "write_ms": milliseconds(times.write),
        })
    }
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

impl fmt::Display for Summary<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (width, height) = self.loaded.packed.settings().size;
        let (rendering, rays) = (self.rendering, self.rendering.rays);
        write!(out, "{}: {width}x{height}", self.destination)?;
        let region = rendering.region;
        if (region.width, region.height) != (width, height) {
            write!(out, ", of it {}x{} at {},{}", region.width, region.height, region.x, region.y)?;
        }
        write!(out, " in {} precision", self.precision())?;
        write!(out, " on {} ({})", rendering.device, remedy::why(rendering))?;
        if let Some(noise) = rendering.picture.noise() {
            write!(out, ", {} samples a pixel, noise {:.2} %", rendering.samples, 100.0 * noise)?;
        }
        if let Some(target) = self.noise_target() {
            write!(out, ", asked for {} % of what is seen", 100.0 * target)?;
        }
        write!(out, "; {} primary, {} shadow, {} secondary rays", rays.primary, rays.shadow, rays.secondary)?;
        write!(out, ", {:.1} Mrays/s", self.mrays(self.times.render))?;
        if let Some(time) = self.times.device {
            write!(out, " ({:.1} on the device)", self.mrays(time))?;
        }
        write!(out, "; {}; {} non-finite pixels", self.times, rays.non_finite)
    }
}

/// A time with three digits.
fn span(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    if seconds >= 1.0 { format!("{seconds:.2} s") } else { format!("{:.2} ms", seconds * 1e3) }
}
