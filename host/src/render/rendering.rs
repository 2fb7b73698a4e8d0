//! What a rendering was.

use std::time::{Duration, Instant};

use super::session::Made;
use crate::error::Result;
use crate::film::Film;
use crate::method::Processor;
use crate::picture::Picture;
use crate::rays::Rays;
use crate::team::Lost;
use crate::view::Region;
use crate::why::Why;

/// A picture and what it took.
pub struct Rendering {
    /// The picture.
    pub picture: Picture,
    /// What it was developed from, unless it was made by [`Session::render`](super::Session::render), which keeps none.
    pub film: Option<Film>,
    /// What of the image it shows.
    pub region: Region,
    /// Samples of each pixel, in the mean of all.
    pub samples: u32,
    /// What was traced.
    pub rays: Rays,
    /// The device that ran.
    pub device: String,
    /// Of what kind it is.
    pub processor: Processor,
    /// Why it was taken.
    pub why: Why,
    /// What opening the device took, compiling its kernels, uploading the scene, and making nodes that only it needs.
    pub prepare_time: Duration,
    /// Wall-clock time of a rendering, median of all of them.
    pub time: Duration,
    /// Time on the GPU, median of all renderings, where it has a clock.
    pub device_time: Option<Duration>,
    /// What every rendering took: on the GPU where it has a clock, else all of it.
    pub times: Vec<Duration>,
    /// Devices of several that failed, whose work the others have done.
    pub lost: Vec<Lost>,
}

/// What renderings took.
pub(super) struct Taken {
    pub device: String,
    pub processor: Processor,
    pub why: Why,
    pub prepare_time: Duration,
    /// Of the wall clock.
    pub times: Vec<Duration>,
    pub device_times: Option<Vec<Duration>>,
    pub lost: Vec<Lost>,
}

impl Taken {
    pub fn rendering(self, region: Region, ((picture, rays), film): Made) -> Rendering {
        Rendering {
            samples: (rays.primary / region.pixels()) as u32,
            region,
            picture,
            film,
            rays,
            device: self.device,
            processor: self.processor,
            why: self.why,
            prepare_time: self.prepare_time,
            time: median(self.times.clone()),
            device_time: self.device_times.clone().map(median),
            times: self.device_times.unwrap_or(self.times),
            lost: self.lost,
        }
    }
}

/// Runs `repeat` times, at least once, and keeps the last result and all times.
pub(super) fn repeated<T>(repeat: u32, mut run: impl FnMut() -> Result<T>) -> Result<(T, Vec<Duration>)> {
    let mut times = Vec::new();
    loop {
        let start = Instant::now();
        let result = run()?;
        times.push(start.elapsed());
        if times.len() >= repeat as usize {
            return Ok((result, times));
        }
    }
}

fn median(mut times: Vec<Duration>) -> Duration {
    times.sort_unstable();
    times[times.len() / 2]
}
