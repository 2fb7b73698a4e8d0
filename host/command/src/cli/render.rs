//! `eyerays render`.

use std::cell::{OnceCell, RefCell};
use std::mem::ManuallyDrop;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::thread;
use std::time::Duration;

use clap::Args;

use super::animation::{Animation, Moving};
use super::beside;
use super::checkpoint::CheckpointArgs;
use super::choice::choice;
use super::denoising;
use super::device::DeviceArgs;
use super::devices::Devices;
use super::live::{self, Live};
use super::look::Look;
use super::noise::NoiseArgs;
use super::options::{Effort, Loaded, View};
use super::part::PartArgs;
use super::progress;
use super::reading::{self, Read, Reading};
use super::seconds;
use super::sequence::{self, Instant, SequenceArgs, Shot};
use super::shot::{Place, Studio, each};
use crate::error::{Error, Result};
use crate::output::{self, Destination};
use crate::preset::Preset;
use eyerays::denoise::Denoiser;
use eyerays::fireflies::Buckets;
use eyerays::job::Job;
use eyerays::layers::{self, Aovs, Layer};
use eyerays::render::{Backend, Choice, DeviceWish, Session};
use eyerays::scene::{Integrator, LightGroups, Scene, Settings};
use eyerays::scene_io;

pub(super) const EXAMPLES: &str = "\
Examples:
  eyerays render scenes/cornell.toml -o cornell.png
  eyerays render model.obj --size 1920x1080 --samples 3 --device cpu
  eyerays render scenes/whitted.toml -o - > whitted.png
  eyerays render - -o picture.png < scene.toml
  eyerays render scenes/cornell_path.toml --exposure 1 --tone agx
  eyerays render model.glb -o model.exr --layers albedo,normal,depth
  eyerays render scenes/cornell.toml --settings fast.toml
  eyerays render scenes/room.toml --spp 4096 --checkpoint room.film --resume
  eyerays render scenes/room.toml --noise 0.02 -o room.png
  eyerays render scenes/room.toml --live
  eyerays render scenes/room.toml --tile 0,0,256,128 -o corner.film
  eyerays render model.glb --turntable 36 -o 'turn-{frame:04}.png'
  eyerays render fox.glb --animation Run --frames 0..24 --fps 24 -o 'fox-{frame:04}.png'
  eyerays render scenes/ --all-cameras -o '{name}-{camera}.png'";

#[derive(Args)]
pub(super) struct Render {
    /// Scenes (.toml, .gltf, .glb, .eyerays), bare meshes (.obj, .ply), which are framed and lit, or folders of them; - reads a TOML
    /// scene from standard input
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<PathBuf>,
    /// The picture, .png, .exr or .hdr, or a .film to merge or to go on with; - writes PNG to standard output. Of several pictures
    /// {name} (or {file}, with its ending), {camera} and {frame:04} tell them apart [default: {name}.png here]
    #[arg(short, long, value_name = "FILE")]
    output: Option<std::ffi::OsString>,
    /// Settings that `eyerays tradeoff --save` kept; other options override them, and they the scene's
    #[arg(long, value_name = "FILE")]
    settings: Option<PathBuf>,
    /// Where to render: auto is a GPU when one works, else the CPU; gpu; cpu; all of them together; or several by their numbers or
    /// names, such as gpu:0,gpu:1,cpu [default: auto]
    #[arg(long, value_parser = Devices::parse)]
    device: Option<Devices>,
    #[command(flatten)]
    pub look: Look,
    /// What an .exr file holds beside the light of each pixel, with commas between; those of light but for direct and indirect are of paths. A .film keeps what is summed over
    /// samples, and merge writes it
    #[arg(long, value_name = "LAYERS", value_parser = choice::<Layer>(), value_delimiter = ',')]
    layers: Vec<Layer>,
    /// Take noise off the finished picture, by the surfaces that it shows; an .exr file keeps the noisy one as a layer [default: own]
    #[arg(long, value_name = "BY", value_parser = choice::<Denoiser>(), num_args = 0..=1, require_equals = true, default_missing_value = "own", conflicts_with_all = ["tile", "samples_from", "samples_to", "repeat"])]
    pub denoise: Option<Denoiser>,
    /// Leave out what makes a few pixels far too bright: samples are put into so many buckets, 9 to 64, and those that are far brighter
    /// than a pixel's others are left out [default: 15]
    #[arg(long, value_name = "BUCKETS", value_parser = buckets, num_args = 0..=1, require_equals = true, default_missing_value = "15", conflicts_with_all = ["samples_from", "samples_to", "repeat", "time_limit", "noise", "checkpoint", "resume", "preview_every"])]
    pub fireflies: Option<Buckets>,
    /// Write the colours of the surfaces to the output first, by the CPU, to be seen while a GPU gets ready; the picture replaces them
    #[arg(long)]
    preview: bool,
    /// Render this many times and tell the median time
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub repeat: u32,
    /// Render as many samples of each pixel as fit so many seconds, at least one and at most --spp; for samplers without a grid
    #[arg(long, value_name = "S", value_parser = seconds, conflicts_with_all = ["repeat", "samples"])]
    pub time_limit: Option<Duration>,
    #[command(flatten)]
    pub noise: NoiseArgs,
    /// Write the picture so far to the output every so many seconds, 0 for never [default: 10, of what takes longer than 20]
    #[arg(long, value_name = "S", value_parser = seconds, conflicts_with = "repeat")]
    pub preview_every: Option<Duration>,
    /// Show the picture while it is rendered: in a window, or in tev, which listens at HOST:PORT (its own port is 14158)
    #[arg(long, value_name = "HOST:PORT", value_parser = live::viewer, num_args = 0..=1, default_missing_value = live::WINDOW, conflicts_with = "repeat")]
    live: Option<String>,
    /// Leave out of the file what differs from run to run: the device and the seconds
    #[arg(long)]
    pub reproducible: bool,
    /// Print the summary as JSON to standard output
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    on: DeviceArgs,
    #[command(flatten)]
    view: View,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    effort: Effort,
    #[command(flatten)]
    sequence: SequenceArgs,
    #[command(flatten)]
    pub part: PartArgs,
    #[command(flatten)]
    keeping: CheckpointArgs,
}

/// What all scenes of a command have in common.
struct Task<'a> {
    of: &'a Render,
    effort: Effort,
    choice: Choice,
    quiet: bool,
    /// Who watches.
    live: Option<Live>,
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

impl Render {
    pub fn run(&self, quiet: bool) -> Result<ExitCode> {
        let scenes = sequence::scenes(&self.scenes)?;
        let live = self.live.as_deref().map(|viewer| Live::open(viewer, &self.look, self.view.size())).transpose()?;
        let task = Task { live, ..self.task(quiet)? };
        let instants = self.sequence.instants()?;
        if scenes.len() > 1 || instants.len() > 1 {
            self.check_many()?;
        }
        if scenes.len() > 1 {
            task.check_names(&scenes)?;
        }
        each(&scenes, |scene| task.animation(scene, &instants))
    }

    /// The first scene's settings with these options over them, once the options are found to fit each other and the scene. Nothing is
    /// rendered.
    pub fn checked(&self, quiet: bool) -> Result<Settings> {
        let task = self.task(quiet)?;
        let [scene] = &self.scenes[..] else {
            return Err(Error::new("a job renders one scene: name one, and its options after --"));
        };
        let mut read = Read::scene(scene, &[], self.reading.loading(task.effort.integrator()), quiet)?;
        self.view.aim(&mut read.scene).map_err(|error| error.of(read.path))?;
        let settings = self.view.settings(&read.scene, &task.effort)?;
        self.check_layers(&Destination::from(Path::new("part.film")))?;
        let integrator = settings.transport.integrator;
        let kept = layers::check(self.kept(integrator), integrator, &LightGroups::of(&read.scene));
        kept.map_err(|error| error.of(read.path))?;
        Ok(settings)
    }

    /// Checks what can be checked without a scene.
    fn task(&self, quiet: bool) -> Result<Task<'_>> {
        let preset = self.settings.as_deref().map(Preset::read).transpose()?.unwrap_or_default();
        let (device, several) = match &self.device {
            Some(Devices::Several(several)) => (DeviceWish::Auto, Some(several.clone())),
            Some(Devices::One(device)) => (*device, None),
            None => (preset.device.unwrap_or_default(), None),
        };
        self.noise.target(&self.look)?;
        let choice = Choice { several, ..self.on.over(&preset, device).choice(device)? };
        let (backend, session, before, places) = Default::default();
        let effort = self.effort.over(&preset);
        Ok(Task { of: self, effort, choice, quiet, live: None, backend, session, before, places })
    }

    /// Refuses what is for one picture.
    fn check_many(&self) -> Result<()> {
        match (self.preview, self.keeping.is_named()) {
            (true, _) => Err(Error::new("--preview is for one picture: leave it out")),
            (_, true) => {
                Err(Error::new("--checkpoint keeps the film of one picture: leave it out, or give .film outputs"))
            }
            _ => Ok(()),
        }
    }

    /// Checks where a picture goes.
    fn check(&self, scene: &Path, destination: &Destination) -> Result<()> {
        super::one_on_stdout(self.json, destination)?;
        if self.preview && destination.file().is_none() {
            return Err(Error::new(
                "--preview replaces what it wrote, which standard output can't: name a file with --output",
            ));
        }
        let is_of_pictures = self.preview || self.denoise.is_some() || self.fireflies.is_some();
        if destination.is_film() && is_of_pictures {
            return Err(Error::new(
                "--preview, --fireflies and --denoise are for pictures, not for films: drop them, or name an .exr file",
            ));
        }
        self.look.check(destination)?;
        self.check_layers(destination)?;
        output::check_apart(
            std::slice::from_ref(destination),
            self.settings.iter().map(PathBuf::as_path).chain([scene]),
        )?;
        output::check_writable(destination)
    }

    /// Checks that layers have a place.
    fn check_layers(&self, destination: &Destination) -> Result<()> {
        let of_pictures = self.layers().into_iter().find(|layer| layer.aov().is_none());
        let is_light = |layer: &Layer| layer.aov().is_some() && !rendered_alone(layer);
        if let Some(layer) = self.layers().iter().find(|layer| self.repeat > 1 && is_light(layer)) {
            return Err(Error::new(format!(
                "--repeat measures and keeps no film, which the layer {layer} is told by: drop one"
            )));
        }
        match of_pictures {
            Some(layer) if destination.is_film() || self.part.has_some_samples() => Err(Error::new(format!(
                "--layers: {layer} is of a whole picture and no sum of samples, as layers of a film are: leave it out, or render all of an .exr file"
            ))),
            _ if self.layers.is_empty() || destination.is_film() => Ok(()),
            _ => output::check_layers(destination),
        }
    }

    /// What films keep for the layers of a picture by an integrator. Others than paths render them one by one, and so does what is
    /// measured.
    fn kept(&self, integrator: Integrator) -> Aovs {
        let mut layers = self.layers();
        // A film that is gone on with may be without them: then they are rendered after the picture.
        if self.denoise.is_some() && !self.keeping.is_asked() {
            layers.extend(denoising::NEEDED);
        }
        if self.repeat > 1 || integrator != Integrator::Path {
            layers.retain(|layer| !rendered_alone(layer));
        }
        layers::asked(&layers)
    }

    /// The layers beside the picture, each once.
    pub fn layers(&self) -> Vec<Layer> {
        let mut layers = self.layers.clone();
        layers.retain(|&layer| layer != Layer::Colour);
        layers.sort_unstable();
        layers.dedup();
        layers
    }
}

impl Task<'_> {
    /// Do pictures have names that only a scene or a frame tells?
    fn names_cameras(&self) -> bool {
        self.of.sequence.names_cameras(self.of.output.as_deref())
    }

    /// Refuses scenes whose pictures have the same names, before any is rendered.
    fn check_names(&self, scenes: &[PathBuf]) -> Result<()> {
        if self.names_cameras() {
            return Ok(());
        }
        let of = |path: &PathBuf| self.of.sequence.destinations(self.of.output.as_deref(), path, &[Shot::any()]);
        sequence::check_distinct(&scenes.iter().map(of).collect::<Result<Vec<_>>>()?.concat())
    }

    /// Renders a scene at instants of its animation, until one fails or a signal ends it: what is wrong with one is mostly with all.
    fn animation(&self, path: &Path, instants: &[Option<Instant>]) -> Result<ExitCode> {
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

/// Layers that can be rendered without the picture's film.
fn rendered_alone(layer: &Layer) -> bool {
    matches!(layer, Layer::Albedo | Layer::Normal | Layer::Direct | Layer::Indirect)
}

fn buckets(text: &str) -> std::result::Result<Buckets, String> {
    let count = text.parse().map_err(|_| format!("{text:?} is no number of buckets"))?;
    Buckets::new(count).map_err(|error| error.to_string())
}

/// Refuses a picture that has no fireflies, and too few samples to tell.
fn check_fireflies(buckets: Buckets, integrator: Integrator, view: &eyerays::view::View) -> Result<()> {
    if !integrator.samples() {
        let why = "pictures of the integrator";
        return Err(Error::new(format!("--fireflies: {why} {integrator} have none; leave it out")));
    }
    buckets.of(view.range()).map(drop).map_err(|error| Error::new(format!("--fireflies: {}", error.message())))
}
