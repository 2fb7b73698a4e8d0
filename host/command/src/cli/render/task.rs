//! The pictures of a command, scene after scene.

use std::cell::{OnceCell, RefCell};
use std::mem::ManuallyDrop;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::thread;

use super::{Render, check_fireflies};
use crate::cli::animation::{Animation, Moving};
use crate::cli::live::Live;
use crate::cli::options::{Effort, Loaded};
use crate::cli::reading;
use crate::cli::sequence::{self, Instant, Shot};
use crate::cli::shot::{Place, Studio};
use crate::cli::{beside, denoising, progress};
use crate::error::Result;
use crate::output::{self, Destination};
use eyerays::job::Job;
use eyerays::layers;
use eyerays::render::{Backend, Choice, Session};
use eyerays::scene::Scene;
use eyerays::scene_io;

/// What all scenes of a command have in common.
pub(super) struct Task<'a> {
    of: &'a Render,
    pub effort: Effort,
    choice: Choice,
    quiet: bool,
    /// Who watches.
    pub live: Option<Live>,
    /// Opened once, and not closed: the end of the process takes everything back at once, and a driver takes 70 ms for it one by one
    /// (an H200).
    backend: OnceCell<ManuallyDrop<Backend>>,
    /// What has rendered the pictures before, with its kernels.
    session: RefCell<Option<Session>>,
    /// The scene as it was in the picture of an animation before.
    before: RefCell<Option<Job>>,
    /// Where pictures have gone.
    places: RefCell<Vec<Destination>>,
}

impl<'a> Task<'a> {
    /// One of which no scene was rendered yet, and which nobody watches.
    pub fn new(of: &'a Render, effort: Effort, choice: Choice, quiet: bool) -> Task<'a> {
        let (backend, session, before, places) = Default::default();
        Task { of, effort, choice, quiet, live: None, backend, session, before, places }
    }

    /// Do pictures have names that only a scene or a frame tells?
    fn names_cameras(&self) -> bool {
        self.of.sequence.names_cameras(self.of.output.as_deref())
    }

    /// Refuses scenes whose pictures have the same names, before any is rendered.
    pub fn check_names(&self, scenes: &[PathBuf]) -> Result<()> {
        if self.names_cameras() {
            return Ok(());
        }
        let of = |path: &PathBuf| self.of.sequence.destinations(self.of.output.as_deref(), path, &[Shot::any()]);
        sequence::check_distinct(&scenes.iter().map(of).collect::<Result<Vec<_>>>()?.concat())
    }

    /// Renders a scene at instants of its animation, until one fails or a signal ends it: what is wrong with one is mostly with all.
    pub fn animation(&self, path: &Path, instants: &[Option<Instant>]) -> Result<ExitCode> {
        let animation = Animation::new(path, (&self.of.reading, self.effort.integrator()), instants)?;
        self.before.take();
        for moving in animation.pictures(instants) {
            let code = self.pictures(path, (&animation, moving))?;
            if code != ExitCode::SUCCESS {
                return Ok(code);
            }
        }
        Ok(ExitCode::SUCCESS)
    }

    /// Renders the pictures of a scene, at an instant of its animation.
    fn pictures(&self, path: &Path, (animation, moving): (&Animation<'_>, Moving<'_>)) -> Result<ExitCode> {
        // A wrong name shows before a scene is read, which may take long, unless it is of what only the scene tells.
        if !self.names_cameras() {
            for place in self.of.sequence.destinations(self.of.output.as_deref(), path, &[Shot::any()])? {
                self.of.check(path, &place)?;
            }
        }
        let mut effort = self.effort;
        let read = animation.read(moving, self.quiet)?;
        let path = reading::called(path);
        effort = self.of.noise.effort(effort, &read.scene)?;
        if self.of.time_limit.is_some() {
            effort = effort.endless(&read.scene)?;
        }
        let is_asked = beside::is_asked(&self.of.layers);
        let others = match is_asked && !self.of.sequence.only_turns(moving.instant) {
            true => animation.beside(moving, &read.scene)?,
            false => None,
        };
        let before = self.before.take();
        let choice = (&self.choice, before.as_ref());
        let (mut loaded, scene, camera) = self.of.view.pack_and_keep(read, &effort, choice, self.quiet)?;
        // Of scenes that stand still none is held longer than its pictures take.
        let moves = moving.instant.is_some();
        self.before.replace(moves.then(|| loaded.packed.clone()));
        let kept = self.of.kept(loaded.packed.settings().transport.integrator);
        loaded.packed = loaded.packed.keeping(kept).map_err(|error| error.of(path))?;
        let shots = self.of.sequence.shots(&scene, camera.clone(), moving.instant)?;
        let mut places = self.places(path, &loaded, &scene, shots)?;
        if is_asked {
            let how = (&self.of.sequence, &self.of.view);
            beside::put(&mut places, how, (&scene, &camera, moving.instant), others)?;
        }
        if self.of.preview {
            self.preview(&loaded, &places)?;
        }
        let hash = self.opened(&scene, path)?;
        let backend = self.backend.get().expect("it was opened");
        let (choice, live, quiet) = (&self.choice, self.live.as_ref(), self.quiet);
        let studio = Studio { of: self.of, path, scene: &scene, hash, choice, backend, live, quiet };
        let mut session = studio.session(self.session.take(), &loaded)?;
        let code = studio.pictures(&mut session, &loaded, &places)?;
        self.session.replace(moves.then_some(session));
        Ok(code)
    }

    /// Opens the device, unless that was done for another scene, and hashes the scene meanwhile: a driver takes longer for it.
    fn opened(&self, scene: &Scene, path: &Path) -> Result<[u8; 32]> {
        let opening = || {
            thread::scope(|scope| {
                let hash = scope.spawn(|| scene_io::fingerprint(scene));
                let backend = self.backend.get().is_none().then(|| Backend::new(&self.choice));
                (backend, hash.join().expect("hashing does not panic"))
            })
        };
        let (backend, hash) = progress::stage("opening the device", self.quiet, opening);
        if let Some(backend) = backend.transpose()? {
            self.backend.get_or_init(|| ManuallyDrop::new(backend));
        }
        Ok(hash.map_err(|error| error.of(path))?)
    }

    /// Where the pictures go, and how they are seen.
    fn places(&self, path: &Path, loaded: &Loaded, scene: &Scene, shots: Vec<Shot>) -> Result<Vec<Place>> {
        let destinations = self.of.sequence.destinations(self.of.output.as_deref(), path, &shots)?;
        self.places.borrow_mut().extend(destinations.iter().cloned());
        sequence::check_distinct(&self.places.borrow())?;
        if self.places.borrow().len() > 1 {
            self.of.check_many()?;
        }
        output::check_apart(&destinations, &scene.files)?;
        let places = shots.into_iter().zip(destinations).map(|(shot, destination)| {
            // Others were checked before the scene was read.
            if self.names_cameras() {
                self.of.check(path, &destination)?;
            }
            if let Some(denoiser) = self.of.denoise {
                denoising::check(denoiser, loaded.packed.settings().transport.integrator)?;
            }
            if loaded.packed.is_transparent() && !destination.is_film() {
                output::check_alpha(&destination)?;
            }
            let view = eyerays::view::View::new(&loaded.packed, &shot.camera).map_err(|error| error.of(path))?;
            if let Some(buckets) = self.of.fireflies {
                check_fireflies(buckets, loaded.packed.settings().transport.integrator, &view)?;
            }
            let checkpoint = self.of.keeping.beside(&destination, self.quiet)?;
            let view = self.of.part.of(&view)?;
            layers::check_room(&loaded.packed, &view)?;
            self.of.noise.check(&view)?;
            Ok(Place { camera: shot.camera, view, destination, checkpoint, beside: None })
        });
        places.collect()
    }

    /// What can be seen before kernels are there.
    fn preview(&self, loaded: &Loaded, places: &[Place]) -> Result<()> {
        for Place { camera, view, destination, .. } in places {
            progress::stage("drawing a preview", self.quiet || self.of.json, || {
                let picture = layers::preview(&loaded.packed, camera, view.region(), self.choice.threads)?;
                output::write_picture(&picture, destination, &self.of.look.as_it_is()?)
            })?;
        }
        Ok(())
    }
}
