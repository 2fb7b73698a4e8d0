//! A picture in layers: beside its light what the camera sees, for those who denoise pictures or put them together.

mod kept;
mod motion;
mod studio;
mod surface;

use crate::choice::choices;
use crate::cryptomatte::Cryptomatte;
use crate::device_scene::Feature;
use crate::error::Result;
use crate::job::Job;
use crate::picture::Picture;
use crate::render::{Backend, Choice, DeviceWish, Rendering, Session};
use crate::scene::{Camera, Settings};
use crate::view::{Region, View};

pub use eyerays_shader::data::Aovs;
pub(crate) use kept::can_be_named;
pub use kept::{all_of_film, asked, check, check_room, names, of_film};
pub use motion::Shown;
pub(crate) use studio::middles;
use studio::{Studio, seen};
pub(crate) use surface::Finder;
use surface::Place;

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
        /// Where in the world that is; zeros for nothing
        Position = "position",
        /// Its texture coordinates, the second down; zeros without
        Uv = "uv",
        /// How far to the right and down in pixels that is in the picture before, if something moves
        MotionBack = "motion_back",
        /// The same of the picture after
        MotionForward = "motion_forward",
        /// The number of the mesh there, as check and info count them; 0 for nothing
        Object = "object",
        /// The number of the material there, likewise
        Material = "material",
        /// The number of the primitive there, from 1: triangles, then those of copies, spheres and disks; 0 for nothing
        Primitive = "primitive",
        /// What a picture of 0 bounces shows: the background, what shines, and light that was scattered once
        Direct = "direct",
        /// All other light
        Indirect = "indirect",
        /// What surfaces emit that the camera sees
        Emission = "emission",
        /// What the camera sees of the surroundings
        Environment = "environment",
        /// Light that the diffuse part of the surface scatters which the camera sees, and no other surface before
        DiffuseDirect = "diffuse_direct",
        /// The same of light that others have scattered before
        DiffuseIndirect = "diffuse_indirect",
        /// Light that the surface mirrors, sharply or not, likewise
        GlossyDirect = "glossy_direct",
        /// Likewise
        GlossyIndirect = "glossy_indirect",
        /// Light that comes through the surface, likewise
        TransmissionDirect = "transmission_direct",
        /// Likewise
        TransmissionIndirect = "transmission_indirect",
        /// The light of each group of lamps by its name, and of those without one: group_NAME and group_rest
        LightGroups = "light_groups",
        /// The standard error of the pixel's brightness, estimated from how its samples differ; infinite of fewer than two
        Error = "error",
        /// How many samples the pixel has
        Samples = "samples",
        /// How many nodes the ray through the middle of the pixel visits: pairs of boxes, or nodes of eight
        Visits = "visits",
        /// How many primitives that ray is tested against
        Tests = "tests",
        /// How many nodes are above the deepest that it visits
        Deepest = "deepest",
        /// How many steps more than it the longest ray of its block of 8x4 pixels takes: a lane of a GPU's subgroup waits for it
        Idle = "idle",
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
    /// Two coordinates, and zero.
    Coordinates(Picture),
    /// Ways in the image, and zero.
    Ways(Picture),
    /// Shares of names.
    Shares(Cryptomatte),
    /// Light in parts, each with its name.
    Parts(Vec<(String, Picture)>),
}

impl Values {
    /// How many pixels there are.
    pub fn pixels(&self) -> usize {
        match self {
            Values::Light(picture)
            | Values::Colours(picture)
            | Values::Vectors(picture)
            | Values::Coordinates(picture)
            | Values::Ways(picture) => picture.pixels.len(),
            Values::Lengths(lengths) => lengths.len(),
            Values::Numbers(numbers) => numbers.len(),
            Values::Shares(matte) => matte.pixels(),
            Values::Parts(parts) => parts.first().map_or(0, |(_, picture)| picture.pixels.len()),
        }
    }
}

/// The layers beside a picture of the session's job: those that its film keeps ([`Job::keeping`]), and others rendered, each with as many
/// samples as the picture got, and with its numbers drawn for the same places. What is told of the middle of a pixel is as the shutter opens. The session goes on with the job that it had.
///
/// # Errors
/// As [`Session::turn`] and [`Session::render`].
pub fn render(
    session: &mut Session,
    shown: Shown<'_>,
    rendering: &Rendering,
    layers: &[Layer],
) -> Result<Vec<(Layer, Values)>> {
    let job = session.job().clone();
    let settings = Settings { spp: rendering.samples, ..*job.settings() };
    let mut studio = Studio::new(session, shown, rendering.region, settings);
    let layers = layers.iter().filter(|&&layer| layer != Layer::Colour);
    let rendered = layers.map(|&layer| Ok((layer, studio.layer(layer, rendering)?))).collect();
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
    let seen = at_middles(job, camera, Feature::Place, pixel, 1)?.pixels[0];
    let place = Place::of(seen, job.normalisation().scale);
    Ok(place.primitive.map(|_| place.depth))
}

/// What tells neighbours apart where noise is taken off a picture, see [`Guides`](crate::denoise::Guides).
#[derive(Debug, Clone)]
pub struct Surfaces {
    /// [`Layer::Albedo`].
    pub albedo: Picture,
    /// [`Layer::Normal`].
    pub normal: Picture,
    /// [`Layer::Depth`].
    pub depth: Vec<f32>,
}

/// The surfaces that a camera sees of a job, each pixel by the job's samples, by this many threads of the CPU, 0 for one a core.
///
/// # Errors
/// As [`Backend::open`] and [`Session::render`].
pub fn surfaces(job: &Job, camera: &Camera, threads: usize) -> Result<Surfaces> {
    let showing = |feature| job.showing(Some(feature));
    let mut session = on_cpu(&showing(Feature::Albedo), threads)?;
    let view = View::new(session.job(), camera)?;
    let albedo = session.render(&view, 1, &|_| ())?.picture;
    session.turn(&showing(Feature::Normal))?;
    let normal = session.render(&View::new(session.job(), camera)?, 1, &|_| ())?.picture;
    let (middle, view) = middle(job, camera, Feature::Place, view.region())?;
    session.turn(&middle)?;
    let places = session.render(&view, 1, &|_| ())?.picture;
    let depth = |pixel| Place::of(pixel, job.normalisation().scale).depth;
    Ok(Surfaces { albedo, normal, depth: places.pixels.into_iter().map(depth).collect() })
}

/// A feature at the middle of each pixel of a part of the image, by this many threads of the CPU.
fn at_middles(job: &Job, camera: &Camera, feature: Feature, window: Region, threads: usize) -> Result<Picture> {
    let (job, view) = middle(job, camera, feature, window)?;
    Ok(on_cpu(&job, threads)?.render(&view, 1, &|_| ())?.picture)
}

/// The job that shows a feature at the middle of each pixel, and its view of a part of the image.
fn middle(job: &Job, camera: &Camera, feature: Feature, window: Region) -> Result<(Job, View)> {
    let (middle, pinhole) = middles(job.settings(), camera);
    let job = job.with(middle)?.showing(Some(feature));
    let view = seen(&job, &pinhole, window)?.as_it_opens();
    Ok((job, view))
}

/// A job on this many threads of the CPU, 0 for one a core.
fn on_cpu(job: &Job, threads: usize) -> Result<Session> {
    Backend::new(&Choice { device: DeviceWish::Cpu, threads, ..Choice::default() })?.open(job)
}
