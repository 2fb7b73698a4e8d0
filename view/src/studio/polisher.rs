//! Takes the noise off a picture that grows, on a thread of its own: samples are added meanwhile.

use std::sync::Arc;
use std::thread::{self, JoinHandle};

use eyerays::denoise::{self, Guides};
use eyerays::error::{Error, Result};
use eyerays::film::Film;
use eyerays::image::Encoding;
use eyerays::job::Job;
use eyerays::layers::{self, Surfaces};
use eyerays::picture::Picture;
use eyerays::render::Display;
use eyerays::scene::Settings;

use super::growth::Subject;

/// Surfaces are seen by so many samples at most, however many the picture has: those take a CPU long.
const SEEN: u32 = 16;

/// A picture without its noise, and the next one on its way.
#[derive(Default)]
pub(super) struct Polisher {
    polished: Option<Polished>,
    thread: Option<JoinHandle<Result<Polished>>>,
    /// Its samples and how its light was shown, of the one that is on the screen.
    shown: Option<(u32, Encoding)>,
}

/// A picture without its noise.
pub(super) struct Polished {
    subject: Subject,
    /// Those of the picture.
    pub samples: u32,
    pub picture: Picture,
    seen: Arc<Seen>,
}

/// What the camera sees, by so many samples.
struct Seen {
    samples: u32,
    surfaces: Surfaces,
}

impl Polisher {
    /// Is one on its way?
    pub fn is_busy(&self) -> bool {
        self.thread.is_some()
    }

    /// Forgets what it has: of another scene, or rendered otherwise.
    pub fn forget(&mut self) {
        *self = Polisher::default();
    }

    /// The last one, if it is of this.
    pub fn polished(&self, of: &Subject) -> Option<&Polished> {
        self.polished.as_ref().filter(|polished| polished.subject == *of)
    }

    /// Takes the one that was on its way, if it is done.
    pub fn look(&mut self) -> Result<()> {
        if let Some(thread) = self.thread.take_if(|thread| thread.is_finished()) {
            let done = thread.join().unwrap_or_else(|_| Err(Error::new("the denoiser has failed: report it")));
            self.polished = Some(done?);
        }
        Ok(())
    }

    /// The last one of this as a screen shows it, unless that is there already.
    pub fn display(&mut self, of: &Subject, look: Encoding) -> Result<Option<Display>> {
        let Some(polished) = self.polished(of) else { return Ok(None) };
        let now = Some((polished.samples, look));
        let display = if now == self.shown { None } else { Some(Display::of(&polished.picture, &look)?) };
        self.shown = now;
        Ok(display)
    }

    /// Something else has taken its place on the screen.
    pub fn cover(&mut self) {
        self.shown = None;
    }

    /// Is it time for another, of so many samples? Of twice as many each time, and of the last.
    pub fn is_due(&self, of: &Subject, samples: u32, is_done: bool) -> bool {
        let before = self.polished(of).map_or(0, |polished| polished.samples);
        !self.is_busy() && samples > 1 && samples > before && (is_done || samples >= 2 * before)
    }

    /// Starts with a film of a job, which has so many samples.
    pub fn start(&mut self, film: Film, (job, threads): (&Job, usize), (subject, samples): (Subject, u32)) {
        let seen = self.polished(&subject).map(|polished| polished.seen.clone());
        let job = job.clone();
        self.thread = Some(thread::spawn(move || {
            let wanted = samples.min(SEEN);
            let seen = match seen {
                Some(seen) if seen.samples >= wanted => seen,
                _ => Arc::new(see(&job, &subject, wanted, threads)?),
            };
            let Surfaces { albedo, normal, depth } = &seen.surfaces;
            let (error, opacity_error) = (film.errors(), film.opacity_errors());
            let guides = Guides { albedo, normal, depth, error: &error, opacity_error: opacity_error.as_deref() };
            let picture = denoise::denoise(&film.develop()?, &guides)?;
            Ok(Polished { subject, samples, picture, seen })
        }));
    }
}

fn see(job: &Job, subject: &Subject, samples: u32, threads: usize) -> Result<Seen> {
    let job = job.with(Settings { size: subject.size, spp: samples, ..*job.settings() })?;
    Ok(Seen { samples, surfaces: layers::surfaces(&job, &subject.camera, threads)? })
}
