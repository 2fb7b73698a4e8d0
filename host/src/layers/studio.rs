//! Renders layers, each as what it is of.

use glam::Vec3;
use rayon::prelude::*;

use super::surface::{Finder, Place, primitive};
use super::{Layer, Shown, Values, motion, names, of_film};
use crate::cryptomatte::{Counter, Cryptomatte};
use crate::device_scene::Feature;
use crate::error::{Error, Result};
use crate::job::Job;
use crate::picture::Picture;
use crate::render::{Rendering, Session};
use crate::scene::{Camera, ObjectNumbers, Sampler, Scene, Settings};
use crate::trail::{self, Counts};
use crate::view::{Region, View};

/// What all layers are rendered with, and what several of them take.
pub(super) struct Studio<'a> {
    session: &'a mut Session,
    shown: Shown<'a>,
    /// What of the image it shows.
    window: Region,
    /// Of the picture.
    settings: Settings,
    /// What its film keeps, by name.
    kept: Vec<String>,
    direct: Option<Picture>,
    places: Option<Vec<Place>>,
    /// In world units.
    positions: Option<Picture>,
    /// Of objects and of materials.
    mattes: Option<[Cryptomatte; 2]>,
    /// The work of the rays through the middles.
    counts: Option<Vec<Counts>>,
}

/// Samples of a pixel that count for its Cryptomattes: each is a picture of its own.
const COUNTED: u32 = 64;

impl<'a> Studio<'a> {
    pub fn new(session: &'a mut Session, shown: Shown<'a>, window: Region, settings: Settings) -> Self {
        let kept = names(session.job());
        let (direct, places, positions, mattes, counts) = (None, None, None, None, None);
        Studio { session, shown, window, settings, kept, direct, places, positions, mattes, counts }
    }

    pub fn layer(&mut self, layer: Layer, rendering: &Rendering) -> Result<Values> {
        let (scene, picture) = (self.shown.scene, &rendering.picture);
        let no_film = || Error::new(format!("the layer {layer} is told by the film: render with one (expose)"));
        let film = rendering.film.as_ref().ok_or_else(no_film);
        if let Some(film) = &rendering.film
            && let Some(values) = of_film(film, (&self.kept, picture), layer)?
        {
            return Ok(values);
        }
        Ok(match layer {
            Layer::Colour | Layer::Noisy => Values::Light(picture.clone()),
            Layer::Albedo => Values::Colours(self.picture(Some(Feature::Albedo), self.settings)?),
            Layer::Normal => Values::Vectors(self.picture(Some(Feature::Normal), self.settings)?),
            Layer::Direct => Values::Light(self.direct()?.clone()),
            Layer::Indirect => Values::Light(picture.without(self.direct()?)?),
            Layer::Error => Values::Lengths(film?.errors()),
            Layer::Samples => Values::Numbers(film?.samples()),
            Layer::Emission
            | Layer::Environment
            | Layer::DiffuseDirect
            | Layer::DiffuseIndirect
            | Layer::GlossyDirect
            | Layer::GlossyIndirect
            | Layer::TransmissionDirect
            | Layer::TransmissionIndirect
            | Layer::LightGroups => return Err(not_kept(layer)),
            Layer::Position => Values::Vectors(self.positions()?.clone()),
            Layer::Uv => {
                // Which takes their places, too.
                self.positions()?;
                let (positions, places) = (self.positions.as_ref(), self.places.as_ref());
                coordinates(scene, positions.expect("just made"), places.expect("just made"))?
            }
            Layer::MotionBack => Values::Ways(self.ways(0)?),
            Layer::MotionForward => Values::Ways(self.ways(1)?),
            Layer::Depth => Values::Lengths(self.places()?.iter().map(|place| place.depth).collect()),
            Layer::Object => {
                let objects = ObjectNumbers::of(scene);
                self.numbers(|primitive| objects.find(primitive).map_or(0, |number| number + 1))?
            }
            Layer::Material => {
                let finder = Finder::of(scene);
                self.numbers(|primitive| finder.material(primitive) + 1)?
            }
            Layer::Primitive => self.numbers(|primitive| primitive as u32 + 1)?,
            Layer::Visits => self.work(|counts| counts.visits)?,
            Layer::Tests => self.work(|counts| counts.tests)?,
            Layer::Deepest => self.work(|counts| counts.deepest)?,
            Layer::Idle => self.work(|counts| counts.idle)?,
            Layer::CryptoObject => Values::Shares(self.mattes(scene)?[0].clone()),
            Layer::CryptoMaterial => Values::Shares(self.mattes(scene)?[1].clone()),
        })
    }

    fn numbers(&mut self, of: impl Fn(usize) -> u32) -> Result<Values> {
        let numbers = self.places()?.iter().map(|place| place.primitive.map_or(0, &of));
        Ok(Values::Numbers(numbers.collect()))
    }

    /// Something of the work of the rays through the middles, as a CPU follows them by the method that was chosen.
    fn work(&mut self, of: impl Fn(&Counts) -> u32) -> Result<Values> {
        if self.counts.is_none() {
            let (middle, pinhole) = middles(&self.settings, self.shown.camera);
            let job = self.session.job().with(middle)?.showing(Some(Feature::Place));
            let view = seen(&job, &pinhole, self.window)?.as_it_opens();
            let choice = self.session.choice();
            self.counts = Some(trail::counts(&job, &view, choice.traversal, choice.threads)?);
        }
        let counts = self.counts.as_deref().expect("they were just made");
        Ok(Values::Numbers(counts.iter().map(of).collect()))
    }

    /// To the picture before, or to the one after.
    fn ways(&mut self, neighbour: usize) -> Result<Picture> {
        let Shown { scene, camera, neighbours } = self.shown;
        if camera.stereo.is_some() {
            return Err(Error::new(
                "the layers motion_back and motion_forward are of one eye: leave them out, or stereo",
            ));
        }
        let unknown =
            || Error::new("how things move is told by the pictures before and after: give them as neighbours");
        let other = neighbours.ok_or_else(unknown)?[neighbour];
        self.positions()?;
        let (positions, places) = (self.positions.as_ref(), self.places.as_ref());
        let seen = (positions.expect("just made"), &places.expect("just made")[..]);
        motion::ways((scene, camera), other, (self.window, self.settings.size), seen)
    }

    fn direct(&mut self) -> Result<&Picture> {
        if self.direct.is_none() {
            self.direct = Some(self.picture(None, Settings { bounces: 0, ..self.settings })?);
        }
        Ok(self.direct.as_ref().expect("it was just made"))
    }

    fn places(&mut self) -> Result<&[Place]> {
        if self.places.is_none() {
            let scale = self.session.job().normalisation().scale;
            let seen = self.at_middles(Feature::Place)?;
            self.places = Some(seen.pixels.into_iter().map(|pixel| Place::of(pixel, scale)).collect());
        }
        Ok(self.places.as_deref().expect("they were just made"))
    }

    /// What the first samples of each pixel show, sample by sample.
    fn mattes(&mut self, scene: &Scene) -> Result<&[Cryptomatte; 2]> {
        if self.mattes.is_none() {
            let pixels = self.window.pixels() as usize;
            let (numbers, finder) = (ObjectNumbers::of(scene), Finder::of(scene));
            let mut objects =
                Counter::new("CryptoObject", scene.objects.iter().map(|object| object.name.as_str()), pixels);
            let mut materials =
                Counter::new("CryptoMaterial", scene.materials.iter().map(|material| material.name.as_str()), pixels);
            let job = self.session.job().with(self.settings)?.showing(Some(Feature::Place));
            self.session.turn(&job)?;
            let view = View::new(&job, self.shown.camera)?;
            let samples = view.range();
            for sample in samples.start..samples.end.min(samples.start + COUNTED) {
                let seen = self.session.render(&view.part(self.window, sample..sample + 1)?, 1, &|_| ())?.picture;
                let primitive = |pixel: &[f32; 3]| primitive(*pixel);
                let seen = seen.pixels.par_iter().map(primitive);
                objects.add(seen.clone().map(|seen| Some(numbers.find(seen?)? as usize)));
                materials.add(seen.map(|seen| Some(finder.material(seen?) as usize)));
            }
            self.mattes = Some([objects, materials].map(Counter::done));
        }
        Ok(self.mattes.as_ref().expect("they were just counted"))
    }

    /// Where in the world the middle of each pixel is.
    fn positions(&mut self) -> Result<&Picture> {
        if self.positions.is_none() {
            let normalisation = *self.session.job().normalisation();
            self.places()?;
            let mut seen = self.at_middles(Feature::Position)?;
            for (pixel, place) in seen.pixels.iter_mut().zip(self.places.iter().flatten()) {
                *pixel = match place.primitive {
                    Some(_) => normalisation.in_world(Vec3::from(*pixel)).to_array(),
                    None => [0.0; 3],
                };
            }
            self.positions = Some(seen);
        }
        Ok(self.positions.as_ref().expect("they were just made"))
    }

    /// A feature at the middle of each pixel.
    fn at_middles(&mut self, feature: Feature) -> Result<Picture> {
        let (middle, pinhole) = middles(&self.settings, self.shown.camera);
        let job = self.session.job().with(middle)?.showing(Some(feature));
        self.session.turn(&job)?;
        let view = seen(&job, &pinhole, self.window)?.as_it_opens();
        Ok(self.session.render(&view, 1, &|_| ())?.picture)
    }

    fn picture(&mut self, feature: Option<Feature>, settings: Settings) -> Result<Picture> {
        let job = self.session.job().with(settings)?.showing(feature);
        self.session.turn(&job)?;
        Ok(self.session.render(&seen(&job, self.shown.camera, self.window)?, 1, &|_| ())?.picture)
    }
}

/// The texture coordinates of places.
fn coordinates(scene: &Scene, positions: &Picture, places: &[Place]) -> Result<Values> {
    let finder = Finder::of(scene);
    let of = |(position, place): (&[f32; 3], &Place)| {
        let [u, v] = place.primitive.map_or([0.0; 2], |primitive| finder.texture_coordinates(primitive, *position));
        [u, v, 0.0]
    };
    let pixels = positions.pixels.iter().zip(places).map(of).collect();
    Ok(Values::Coordinates(Picture::from_pixels(positions.width, positions.height, pixels)?))
}

/// What only a film that was asked for it has.
fn not_kept(layer: Layer) -> Error {
    Error::new(format!("the layer {layer} is kept by films that were asked for it: render them by Job::keeping"))
}

/// Settings and a camera that see the middle of each pixel once.
pub(crate) fn middles(settings: &Settings, camera: &Camera) -> (Settings, Camera) {
    let middle = Settings { spp: 1, sampler: Sampler::Regular, ..*settings };
    (middle, Camera { lens: None, ..camera.clone() })
}

/// A part of the image that a camera has of a job.
pub(super) fn seen(job: &Job, camera: &Camera, window: Region) -> Result<View> {
    let view = View::new(job, camera)?;
    view.part(window, view.range())
}
