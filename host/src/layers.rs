//! A picture in layers: beside its light what the camera sees, for those who denoise pictures or put them together.

use rayon::prelude::*;

use crate::choice::choices;
use crate::cryptomatte::{Counter, Cryptomatte};
use crate::device_scene::Feature;
use crate::error::{Error, Result};
use crate::job::Job;
use crate::picture::Picture;
use crate::render::{Backend, Choice, DeviceWish, Rendering, Session};
use crate::scene::{Camera, ObjectNumbers, Sampler, Scene, Settings};
use crate::view::{Region, View};

choices! {
    /// What a picture may hold beside the light of each pixel.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
    pub enum Layer {
        /// All light: the picture itself, which is always there
        Colour = "colour",
        /// The share of white light that surfaces send on, by their colours and textures
        Albedo = "albedo",
        /// Shading normals in world axes, on the viewer's side
        Normal = "normal",
        /// How far in front of the camera's plane the middle of the pixel is, in the scene's units; infinite for nothing
        Depth = "depth",
        /// The number of the mesh there, as check and info count them; 0 for nothing
        Object = "object",
        /// The number of the material there, likewise
        Material = "material",
        /// What a picture of 0 bounces shows: the background, what shines, and light that was scattered once
        Direct = "direct",
        /// All other light
        Indirect = "indirect",
        /// The standard error of the pixel's brightness, estimated from how its samples differ; infinite of fewer than two
        Error = "error",
        /// How many samples the pixel has
        Samples = "samples",
        /// The picture as it was before it was denoised
        Noisy = "noisy",
        /// Cryptomatte of objects by their names, over the pixel's first 64 samples
        CryptoObject = "crypto_object",
        /// Cryptomatte of materials, likewise
        CryptoMaterial = "crypto_material",
    }
}

/// The pixels of a layer, row by row from the top left.
#[derive(Debug, Clone)]
pub enum Values {
    /// Light, linear RGB.
    Light(Picture),
    /// Shares of light, linear RGB.
    Colours(Picture),
    /// Means of vectors.
    Vectors(Picture),
    /// Lengths.
    Lengths(Vec<f32>),
    /// Numbers, from 1.
    Numbers(Vec<u32>),
    /// Shares of names.
    Shares(Cryptomatte),
}

impl Values {
    /// How many pixels there are.
    pub fn pixels(&self) -> usize {
        match self {
            Values::Light(picture) | Values::Colours(picture) | Values::Vectors(picture) => picture.pixels.len(),
            Values::Lengths(lengths) => lengths.len(),
            Values::Numbers(numbers) => numbers.len(),
            Values::Shares(matte) => matte.pixels(),
        }
    }
}

/// Renders the layers beside a picture of the session's job, each with as many samples as the picture got, and with its numbers drawn
/// for the same places. The session goes on with the job that it had.
///
/// # Errors
/// As [`Session::turn`] and [`Session::render`].
pub fn render(
    session: &mut Session,
    (scene, camera): (&Scene, &Camera),
    rendering: &Rendering,
    layers: &[Layer],
) -> Result<Vec<(Layer, Values)>> {
    let job = session.job().clone();
    let settings = Settings { spp: rendering.samples, ..*job.settings() };
    let mut studio =
        Studio { session, camera, window: rendering.region, settings, direct: None, places: None, mattes: None };
    let layers = layers.iter().filter(|&&layer| layer != Layer::Colour);
    let rendered = layers.map(|&layer| Ok((layer, studio.layer(layer, scene, rendering)?))).collect();
    session.turn(&job)?;
    rendered
}

/// What can be seen before a GPU's driver has compiled the kernels of a picture: the colours of its surfaces at the middle of each
/// pixel of a part of the image, by this many threads of the CPU, 0 for one a core.
///
/// # Errors
/// As [`Backend::open`] and [`Session::render`].
pub fn preview(job: &Job, camera: &Camera, window: Region, threads: usize) -> Result<Picture> {
    at_middles(job, camera, Feature::Albedo, window, threads)
}

/// How far in front of a camera's plane what the middle of a pixel shows is, in the scene's units; or from the camera, if it goes all
/// around.
///
/// # Errors
/// There is no such pixel, or as [`preview`].
pub fn depth(job: &Job, camera: &Camera, (x, y): (u32, u32)) -> Result<Option<f32>> {
    let pixel = Region { x, y, width: 1, height: 1 };
    let [depth, low, high] = at_middles(job, camera, Feature::Place, pixel, 1)?.pixels[0];
    let scale = job.normalisation().scale;
    Ok((low + high > 0.0).then_some((f64::from(depth) / scale) as f32))
}

/// A feature at the middle of each pixel of a part of the image, by this many threads of the CPU.
fn at_middles(job: &Job, camera: &Camera, feature: Feature, window: Region, threads: usize) -> Result<Picture> {
    let backend = Backend::new(&Choice { device: DeviceWish::Cpu, threads, ..Choice::default() })?;
    let middle = Settings { spp: 1, sampler: Sampler::Regular, ..*job.settings() };
    let job = job.with(middle)?.showing(Some(feature));
    let pinhole = Camera { lens: None, ..camera.clone() };
    Ok(backend.open(&job)?.render(&seen(&job, &pinhole, window)?, 1, &|_| ())?.picture)
}

/// A part of the image that a camera has of a job.
fn seen(job: &Job, camera: &Camera, window: Region) -> Result<View> {
    let view = View::new(job, camera)?;
    view.part(window, view.range())
}

/// What all layers are rendered with, and what several of them take.
struct Studio<'a> {
    session: &'a mut Session,
    camera: &'a Camera,
    /// What of the image it shows.
    window: Region,
    /// Of the picture.
    settings: Settings,
    direct: Option<Picture>,
    places: Option<Vec<Place>>,
    /// Of objects and of materials.
    mattes: Option<[Cryptomatte; 2]>,
}

/// Samples of a pixel that count for its Cryptomattes: each is a picture of its own.
const COUNTED: u32 = 64;

/// What is seen at the middle of a pixel, if anything is.
#[derive(Clone, Copy)]
struct Place {
    /// In the scene's units.
    depth: f32,
    /// The primitive's number.
    primitive: Option<usize>,
}

impl Studio<'_> {
    fn layer(&mut self, layer: Layer, scene: &Scene, rendering: &Rendering) -> Result<Values> {
        let picture = &rendering.picture;
        let no_film = || Error::new(format!("the layer {layer} is told by the film: render with one (expose)"));
        let film = rendering.film.as_ref().ok_or_else(no_film);
        Ok(match layer {
            Layer::Colour | Layer::Noisy => Values::Light(picture.clone()),
            Layer::Albedo => Values::Colours(self.picture(Some(Feature::Albedo), self.settings)?),
            Layer::Normal => Values::Vectors(self.picture(Some(Feature::Normal), self.settings)?),
            Layer::Direct => Values::Light(self.direct()?.clone()),
            Layer::Indirect => Values::Light(less(picture, self.direct()?)?),
            Layer::Error => Values::Lengths(film?.errors()),
            Layer::Samples => Values::Numbers(film?.samples()),
            Layer::Depth => Values::Lengths(self.places()?.iter().map(|place| place.depth).collect()),
            Layer::Object => {
                let objects = ObjectNumbers::of(scene);
                self.numbers(|primitive| objects.find(primitive).map_or(0, |number| number + 1))?
            }
            Layer::Material => self.numbers(|primitive| material(scene, primitive) + 1)?,
            Layer::CryptoObject => Values::Shares(self.mattes(scene)?[0].clone()),
            Layer::CryptoMaterial => Values::Shares(self.mattes(scene)?[1].clone()),
        })
    }

    fn numbers(&mut self, of: impl Fn(usize) -> u32) -> Result<Values> {
        let numbers = self.places()?.iter().map(|place| place.primitive.map_or(0, &of));
        Ok(Values::Numbers(numbers.collect()))
    }

    fn direct(&mut self) -> Result<&Picture> {
        if self.direct.is_none() {
            self.direct = Some(self.picture(None, Settings { bounces: 0, ..self.settings })?);
        }
        Ok(self.direct.as_ref().expect("it was just made"))
    }

    fn places(&mut self) -> Result<&[Place]> {
        if self.places.is_none() {
            let middle = Settings { spp: 1, sampler: Sampler::Regular, ..self.settings };
            let scale = self.session.job().normalisation().scale;
            let place = |pixel: [f32; 3]| {
                let primitive = primitive(pixel);
                let depth = if primitive.is_some() { (f64::from(pixel[0]) / scale) as f32 } else { f32::INFINITY };
                Place { depth, primitive }
            };
            let pinhole = Camera { lens: None, ..self.camera.clone() };
            let seen = self.picture_by(&pinhole, Some(Feature::Place), middle)?;
            self.places = Some(seen.pixels.into_iter().map(place).collect());
        }
        Ok(self.places.as_deref().expect("they were just made"))
    }

    /// What the first samples of each pixel show, sample by sample.
    fn mattes(&mut self, scene: &Scene) -> Result<&[Cryptomatte; 2]> {
        if self.mattes.is_none() {
            let pixels = self.window.pixels() as usize;
            let numbers = ObjectNumbers::of(scene);
            let mut objects =
                Counter::new("CryptoObject", scene.objects.iter().map(|object| object.name.as_str()), pixels);
            let mut materials =
                Counter::new("CryptoMaterial", scene.materials.iter().map(|material| material.name.as_str()), pixels);
            let job = self.session.job().with(self.settings)?.showing(Some(Feature::Place));
            self.session.turn(&job)?;
            let view = View::new(&job, self.camera)?;
            let samples = view.range();
            for sample in samples.start..samples.end.min(samples.start + COUNTED) {
                let seen = self.session.render(&view.part(self.window, sample..sample + 1)?, 1, &|_| ())?.picture;
                let primitive = |pixel: &[f32; 3]| primitive(*pixel);
                let seen = seen.pixels.par_iter().map(primitive);
                objects.add(seen.clone().map(|seen| Some(numbers.find(seen?)? as usize)));
                materials.add(seen.map(|seen| Some(material(scene, seen?) as usize)));
            }
            self.mattes = Some([objects, materials].map(Counter::done));
        }
        Ok(self.mattes.as_ref().expect("they were just counted"))
    }

    fn picture(&mut self, feature: Option<Feature>, settings: Settings) -> Result<Picture> {
        self.picture_by(self.camera, feature, settings)
    }

    fn picture_by(&mut self, camera: &Camera, feature: Option<Feature>, settings: Settings) -> Result<Picture> {
        let job = self.session.job().with(settings)?.showing(feature);
        self.session.turn(&job)?;
        Ok(self.session.render(&seen(&job, camera, self.window)?, 1, &|_| ())?.picture)
    }
}

/// The primitive that a pixel of [`Feature::Place`] shows.
fn primitive([_, low, high]: [f32; 3]) -> Option<usize> {
    (low as usize + ((high as usize) << 16)).checked_sub(1)
}

/// The light that a picture has and another has not. What rounding leaves below zero is none.
fn less(picture: &Picture, other: &Picture) -> Result<Picture> {
    let less = |(a, b): (&[f32; 3], &[f32; 3])| [0, 1, 2].map(|channel| (a[channel] - b[channel]).max(0.0));
    let pixels = picture.pixels.iter().zip(&other.pixels).map(less).collect();
    Picture::from_pixels(picture.width, picture.height, pixels)
}

/// The number of a primitive's material, from 0.
fn material(scene: &Scene, primitive: usize) -> u32 {
    let (triangles, spheres) = (scene.mesh.triangles.len(), scene.spheres.len());
    if let Some(&material) = scene.mesh.materials.get(primitive) {
        return material;
    }
    let round = primitive - triangles;
    scene.spheres.get(round).map_or_else(|| scene.disks[round - spheres].material, |sphere| sphere.material)
}
