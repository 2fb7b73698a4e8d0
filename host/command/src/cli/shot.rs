//! The pictures of a scene that is loaded, one after the other.

use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use super::beside::Beside;
use super::checkpoint::{self, Checkpoint};
use super::console;
use super::denoising;
use super::facts::Facts;
use super::live::Live;
use super::options::Loaded;
use super::progress;
use super::render::Render;
use super::summary::{Summary, Times};
use super::watching::{self, Watching};
use crate::error::{Error, Result};
use crate::output::{self, Destination};
use eyerays::film::{Film, Identity};
use eyerays::fireflies::Buckets;
use eyerays::job::Job;
use eyerays::layers::{self, Layer, Shown, Values};
use eyerays::render::{Backend, Choice, Precision, Rendering, Session};
use eyerays::scene::{Camera, Scene};
use eyerays::view::View;

/// A picture that is to be rendered.
pub(super) struct Place {
    pub camera: Camera,
    pub view: View,
    pub destination: Destination,
    pub checkpoint: Option<Checkpoint>,
    /// The pictures before and after, if its layers ask for them.
    pub beside: Option<[Beside; 2]>,
}

/// What renders the pictures of a scene.
pub(super) struct Studio<'a> {
    pub of: &'a Render,
    pub path: &'a Path,
    pub scene: &'a Scene,
    /// Of the scene.
    pub hash: [u8; 32],
    pub choice: &'a Choice,
    pub backend: &'a Backend,
    /// Who watches.
    pub live: Option<&'a Live>,
    pub quiet: bool,
}

/// What a picture holds beside its light.
#[derive(Default)]
struct Layers {
    all: Vec<(Layer, Values)>,
    /// How long that took, with taking noise off the picture, if there is any.
    time: Option<Duration>,
    /// What did the latter.
    denoised: Option<String>,
}

impl Studio<'_> {
    /// What renders them: what has rendered others before, or anew.
    pub fn session(&self, before: Option<Session>, loaded: &Loaded) -> Result<Session> {
        let turned = before.and_then(|mut session| session.turn(&loaded.packed).is_ok().then_some(session));
        Ok(turned.map_or_else(|| self.backend.open(&loaded.packed), Ok).map_err(|error| error.of(self.path))?)
    }

    /// Renders all of them, until a signal ends one.
    pub fn pictures(&self, session: &mut Session, loaded: &Loaded, places: &[Place]) -> Result<ExitCode> {
        each(places, |place| {
            let identity = self.identity(loaded, place)?;
            let mut rendering = self.rendered(session, place, &identity)?;
            let layers = self.layers(session, place, &mut rendering)?;
            self.finish(loaded, place, identity, rendering, layers)
        })
    }

    /// What a picture is of.
    fn identity(&self, loaded: &Loaded, place: &Place) -> Result<Identity> {
        let precision = self.choice.precision;
        let identity = Identity::of(self.hash, &loaded.packed, &place.view, precision)?;
        let identity = match self.of.noise.target(&self.of.look)? {
            Some(target) => identity.until(&target),
            None => identity,
        };
        Ok(match precision {
            Precision::Fast => identity.on(&self.backend.description(), self.choice.traversal),
            _ => identity,
        })
    }

    fn rendered(&self, session: &mut Session, place: &Place, identity: &Identity) -> Result<Rendering> {
        let (Place { view, destination, checkpoint, .. }, repeat) = (place, self.of.repeat);
        let from = match checkpoint {
            Some(checkpoint) => checkpoint.film(identity, view, self.quiet)?,
            None => None,
        };
        if repeat > 1 && self.keeps_film(place, session.job()) {
            return Err(Error::new("--repeat measures and keeps no film: drop it, or what needs one"));
        }
        let is_silent = self.quiet || self.of.json;
        let target = self.of.noise.target(&self.of.look)?;
        if target.is_none() {
            session.reserve(view).map_err(|error| error.of(self.path))?;
        }
        // Of one sample there is nothing to be seen before it is done, nor to be kept.
        let rendering = if let Some(buckets) = self.of.fireflies {
            let bar = progress::pixels(view.region().pixels() * u64::from(buckets.count()), is_silent);
            let rendering = session.expose_in(view, buckets, &|pixels| bar.inc(pixels));
            bar.finish_and_clear();
            rendering
        } else if repeat == 1 && (view.samples() > 1 || from.is_some()) {
            let watching = Watching {
                bar: match target {
                    Some(_) => progress::cells(is_silent),
                    None => progress::samples(view.samples(), is_silent),
                },
                destination,
                look: self.of.look,
                every: self.of.preview_every,
                limit: self.of.time_limit,
                checkpoint: checkpoint.as_ref(),
                identity,
                live: self.live,
                quiet: self.quiet,
            };
            watching.follow(|watch| match &target {
                Some(target) => session.render_until(view, target, from.as_ref(), watch),
                None => session.render_watched(view, from.as_ref(), watch),
            })
        } else {
            let bar = progress::pixels(view.region().pixels() * u64::from(repeat), is_silent);
            let rendering = match self.keeps_film(place, session.job()) {
                true => session.expose(view, &|pixels| bar.inc(pixels)),
                false => session.render(view, repeat, &|pixels| bar.inc(pixels)),
            };
            bar.finish_and_clear();
            rendering
        };
        let mut rendering = rendering.map_err(|error| error.of(self.path))?;
        if let Some(film) = &mut rendering.film {
            film.identity = identity.clone();
            // Before layers and files, which may fail.
            if let Some(checkpoint) =
                checkpoint.as_ref().filter(|checkpoint| checkpoint.stays() && !destination.is_film())
            {
                checkpoint.keep(film)?;
            }
        }
        let lost = rendering.lost.iter().map(|(name, error)| format!("{name}: {error}; the others did its work"));
        super::warn(&lost.collect::<Vec<_>>(), self.quiet);
        Ok(rendering)
    }

    fn keeps_film(&self, place: &Place, job: &Job) -> bool {
        let layers = self.of.layers();
        place.destination.is_film()
            || place.checkpoint.as_ref().is_some_and(Checkpoint::stays)
            || self.of.denoise.is_some()
            || job.aovs().any()
            || [Layer::Error, Layer::Samples].iter().any(|layer| layers.contains(layer))
    }

    /// Renders the layers, and takes noise off the picture by them if that is asked for.
    fn layers(&self, session: &mut Session, place: &Place, rendering: &mut Rendering) -> Result<Layers> {
        // A film keeps its own.
        let asked = if place.destination.is_film() { Vec::new() } else { self.of.layers() };
        let mut needed = asked.clone();
        if self.of.denoise.is_some() {
            // That is what comes of it, whether it is asked for or not.
            needed.retain(|&layer| layer != Layer::Noisy);
            needed.extend(denoising::NEEDED.into_iter().filter(|layer| !asked.contains(layer)));
        }
        if needed.is_empty() {
            return Ok(Layers::default());
        }
        let start = Instant::now();
        let layers = progress::stage("rendering layers", self.quiet || self.of.json, || {
            layers::render(session, self.shown(place), rendering, &needed)
        });
        let (mut layers, mut denoised) = (layers.map_err(|error| error.of(self.path))?, None);
        if let Some(denoiser) = self.of.denoise {
            let denoise = || denoising::denoised(denoiser, &rendering.picture, rendering.film.as_ref(), &mut layers);
            let (picture, by) = progress::stage("denoising", self.quiet || self.of.json, denoise)?;
            (rendering.picture, denoised) = (picture, Some(by));
            // Formats without layers have no place for the noisy picture.
            let keeps_noisy = output::check_layers(&place.destination).is_ok();
            layers.retain(|(layer, _)| asked.contains(layer) || *layer == Layer::Noisy && keeps_noisy);
        }
        Ok(Layers { all: layers, time: Some(start.elapsed()), denoised })
    }

    fn shown<'p>(&'p self, place: &'p Place) -> Shown<'p> {
        let scene = self.scene;
        let of = |beside: &'p Beside| (beside.scene.as_deref().unwrap_or(scene), &beside.camera);
        Shown { scene, camera: &place.camera, neighbours: place.beside.as_ref().map(|[a, b]| [of(a), of(b)]) }
    }

    /// Writes a picture and says what it was.
    fn finish(
        &self,
        loaded: &Loaded,
        place: &Place,
        identity: Identity,
        mut rendering: Rendering,
        layers: Layers,
    ) -> Result<ExitCode> {
        let Place { camera, view, destination, .. } = place;
        let (scene, reproducible) = (self.path, self.of.reproducible);
        let denoised = layers.denoised.as_deref();
        let fireflies = self.of.fireflies.map(Buckets::count);
        let facts = Facts {
            scene,
            camera,
            view,
            identity: &identity,
            rendering: &rendering,
            denoised,
            fireflies,
            reproducible,
        };
        rendering.picture.about = facts.about();
        if let Some(Err(gone)) = self.live.map(|live| live.send(&destination.to_string(), &rendering.picture)) {
            super::warn(&[gone], self.quiet);
        }
        let start = Instant::now();
        progress::stage("writing", self.quiet, || self.write(destination, &rendering, &layers.all))?;
        let times = Times::new(loaded, &rendering, layers.time, start.elapsed());
        let summary = Summary::new(destination, self.choice, loaded, &rendering, times);
        if self.of.json {
            console::print_json(&summary.json())?;
        } else if !self.quiet {
            console::say(summary);
        }
        self.end(place, &rendering)
    }

    fn write(&self, destination: &Destination, rendering: &Rendering, layers: &[(Layer, Values)]) -> Result<()> {
        if let (true, Some(film)) = (destination.is_film(), &rendering.film) {
            return checkpoint::write(film, destination.file().expect("a film is a file"));
        }
        let (picture, look) = (&rendering.picture, &self.of.look);
        let encoding = look.encoding(picture)?;
        // What is cut off at white counts as without noise, whatever holds the light.
        let shown = if self.of.noise.is_asked() { &Destination::Stdout } else { destination };
        super::warn(look.beyond_white(picture, &encoding, shown)?.as_slice(), self.quiet);
        output::write_layers(picture, layers, destination, &encoding)
    }

    /// How a picture ends: as shells have it where a signal ended the rendering.
    fn end(&self, place: &Place, rendering: &Rendering) -> Result<ExitCode> {
        let (samples, all) = (rendering.samples, place.view.samples());
        let cells_left = rendering.film.as_ref().map_or(0, Film::cells_left);
        let is_whole = if self.of.noise.is_asked() { cells_left == 0 } else { samples == all };
        let signal = watching::ended_by();
        if signal.is_some() && !is_whole && !self.quiet {
            match self.of.noise.is_asked() {
                true => console::say(format_args!("ended while {cells_left} cells of 16x16 pixels had more noise")),
                false => console::say(format_args!("ended after {samples} of {all} samples of each pixel")),
            }
        }
        if signal.is_some() && !is_whole && place.destination.is_film() && !self.quiet {
            console::say(format_args!("{} has what is done: --resume goes on with it", place.destination));
        }
        if let (Some(checkpoint), Some(film), false) = (&place.checkpoint, &rendering.film, place.destination.is_film())
        {
            checkpoint.end(film, signal.is_none() || is_whole, self.quiet)?;
        }
        Ok(signal.map_or(ExitCode::SUCCESS, |signal| ExitCode::from(128 + signal as u8)))
    }
}

/// Renders scenes or pictures one after the other, until a signal ends one. One of several that fails does not stop the others.
pub(super) fn each<T>(items: &[T], mut render: impl FnMut(&T) -> Result<ExitCode>) -> Result<ExitCode> {
    if let [item] = items {
        return render(item);
    }
    let mut code = ExitCode::SUCCESS;
    for item in items {
        match render(item) {
            Ok(ended) if watching::ended_by().is_some() => return Ok(ended),
            Ok(ended) if ended == ExitCode::SUCCESS => {}
            Ok(failed) => code = failed,
            Err(error) => {
                console::say(format_args!("error: {error}"));
                code = ExitCode::from(super::BAD_INPUT);
            }
        }
    }
    Ok(code)
}
