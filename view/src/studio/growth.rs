//! A picture that grows: strip by strip where a sample takes long, many samples at once where it does not.

use std::time::{Duration, Instant};

use eyerays::error::Result;
use eyerays::film::Part;
use eyerays::image::Encoding;
use eyerays::layers::{Layer, Values};
use eyerays::render::{Display, Session};
use eyerays::scene::Camera;
use eyerays::view::{Region, View};

use super::colours::coloured;
use super::pace::Pace;
use crate::shows::Shows;

/// What a picture is of: another is another picture.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Subject {
    pub camera: Camera,
    /// That of the picture, which may be smaller than what is asked for.
    pub size: (u32, u32),
}

/// A picture is shown again after as many times what showing it took, so that it takes little of the time.
const REST: u32 = 10;
/// No screen shows more.
const REFRESH: Duration = Duration::from_millis(15);

/// A film on a device, and what of it is done.
pub(super) struct Growth {
    pub subject: Subject,
    view: View,
    strips: Vec<Region>,
    /// The strip that gets its next sample next.
    next: usize,
    /// What all strips have.
    samples: u32,
    shown: Option<Showing>,
}

/// When a picture was shown.
struct Showing {
    samples: u32,
    look: (Encoding, Shows),
    scale: Option<[f64; 2]>,
    at: Instant,
    took: Duration,
}

impl Growth {
    /// Starts a film.
    pub fn new(session: &mut Session, view: View, subject: Subject, pace: &Pace) -> Result<Growth> {
        let (width, height) = subject.size;
        let strips: Vec<Region> = view.region().pieces(width, pace.rows((width, height))).collect();
        session.begin(&view, &strips)?;
        Ok(Growth { subject, view, strips, next: 0, samples: 0, shown: None })
    }

    /// Have all pixels as many samples?
    pub fn is_even(&self) -> bool {
        self.next == 0
    }

    /// Samples of each pixel.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Adds what takes little time, at most up to so many samples of a pixel, and tells how many samples of pixels that were.
    pub fn add(&mut self, session: &mut Session, most: u32, pace: &mut Pace) -> Result<u64> {
        let most = most.min(self.view.samples());
        if self.samples >= most {
            return Ok(0);
        }
        let region = self.strips[self.next];
        let batch = match self.strips.len() {
            // No more than there are, so that the first pictures come soon.
            1 => pace.batch(region.pixels()).min(self.samples.max(1)).min(most - self.samples),
            _ => 1,
        };
        let start = Instant::now();
        session.add(Part { region, samples: self.samples..self.samples + batch })?;
        session.wait()?;
        let added = region.pixels() * u64::from(batch);
        pace.learn(added, start.elapsed());
        self.next += 1;
        if self.next == self.strips.len() {
            (self.next, self.samples) = (0, self.samples + batch);
        }
        Ok(added)
    }

    /// The picture, where it is time to show another: not while some pixels have a sample more than others. It stays on a device that is
    /// the window's own.
    pub fn display(
        &mut self,
        (session, is_shared): (&mut Session, bool),
        look: (Encoding, Shows),
        is_done: bool,
    ) -> Result<Option<Display>> {
        let is_due = match &self.shown {
            None => true,
            Some(shown) if shown.look != look => true,
            Some(shown) if shown.samples == self.samples => false,
            Some(shown) => is_done || shown.at.elapsed() >= (REST * shown.took).max(REFRESH),
        };
        if !is_due || self.samples == 0 || !self.is_even() {
            return Ok(None);
        }
        let start = Instant::now();
        let (display, scale) = self.look_at(session, is_shared, look)?;
        let (samples, at) = (self.samples, Instant::now());
        self.shown = Some(Showing { samples, look, scale, at, took: start.elapsed() });
        Ok(Some(display))
    }

    /// What the colours of the picture stand for that was shown last, if it was of a layer.
    pub fn scale(&self) -> Option<[f64; 2]> {
        self.shown.as_ref().and_then(|shown| shown.scale)
    }

    fn look_at(
        &self,
        session: &mut Session,
        is_shared: bool,
        (look, shows): (Encoding, Shows),
    ) -> Result<(Display, Option<[f64; 2]>)> {
        if matches!(shows, Shows::Light | Shows::Denoised) && is_shared {
            return Ok((session.display(&look, self.samples)?, None));
        }
        let film = session.film()?;
        let (layer, values) = match shows {
            Shows::Layer(Layer::Error) => (Layer::Error, Values::Lengths(film.errors())),
            Shows::Layer(Layer::Samples) => (Layer::Samples, Values::Numbers(film.samples())),
            _ => return Ok((Display::of(&session.develop(&film)?, &look)?, None)),
        };
        let shown = coloured(layer, &values)?;
        Ok((Display::Pixels { size: self.subject.size, bytes: shown.bytes }, shown.scale))
    }
}
