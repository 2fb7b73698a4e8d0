//! What the commands that render share.

use std::time::{Duration, Instant};

use clap::{ArgGroup, Args};
use eyerays_bvh::Quality;
use glam::Vec3;

use super::camera;
use super::choice::choice;
use super::lens::LensArgs;
use super::progress;
use super::reading::Read;
use super::transport::Transport;
use crate::error::{Error, Result, within};
use crate::preset::Preset;
use eyerays::choice::Named;
use eyerays::job::Job;
use eyerays::picture::Picture;
use eyerays::quality::Bvh;
use eyerays::render::{Choice, DeviceWish};
use eyerays::scene::{
    self, Camera, Filter, Focus, Integrator, Lens, PixelFilter, Projection, Sampler, Scene, Settings,
};

/// The scene and how to see it.
#[derive(Args)]
#[command(next_help_heading = "View")]
// An eye wants something to look at and a target something to look from: another option's, or a camera's.
#[command(group = ArgGroup::new("looked at").args(["target", "camera"]).multiple(true))]
#[command(group = ArgGroup::new("looked from").args(["eye", "camera"]).multiple(true))]
pub(super) struct View {
    /// Image width and height in pixels, for example 1920x1080 [default: the scene's]
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<(u32, u32)>,
    /// One of the scene's cameras, by name or number from 0 [default: the first]
    #[arg(long, value_name = "NAME|INDEX")]
    camera: Option<String>,
    /// Look from here instead, in the scene's units; all else is that of --camera, if it is given
    #[arg(long, value_name = "X,Y,Z", value_parser = camera::vector, requires = "looked at", allow_hyphen_values = true)]
    eye: Option<Vec3>,
    /// Look there instead; likewise
    #[arg(long, value_name = "X,Y,Z", value_parser = camera::vector, requires = "looked from", allow_hyphen_values = true)]
    target: Option<Vec3>,
    #[command(flatten)]
    lens: LensArgs,
    /// Skip opaque triangles seen from behind [default: the scene's]
    #[arg(long, value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    cull: Option<bool>,
    /// Leave out what the camera sees of the surroundings: .png and .exr pictures tell how opaque they are [default: the scene's]
    #[arg(long, value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    transparent: Option<bool>,
    /// Let facets of physical materials scatter light once: what is lost between them is not given back
    #[arg(long)]
    no_compensation: bool,
}

/// How much work a picture is worth.
#[derive(Args, Clone, Copy, Default)]
#[command(next_help_heading = "View")]
pub(super) struct Effort {
    /// Samples along a pixel's edge: N x N rays a pixel [default: the scene's]
    #[arg(long, value_name = "N")]
    samples: Option<u32>,
    /// Samples of a pixel instead, any number of them with a sampler that has no grid
    #[arg(long, value_name = "N", conflicts_with = "samples")]
    spp: Option<u32>,
    /// Where in a pixel its samples lie [default: the scene's]
    #[arg(long, value_parser = choice::<Sampler>())]
    sampler: Option<Sampler>,
    /// What a ray sees of a texture [default: the scene's]
    #[arg(long, value_parser = choice::<Filter>())]
    filter: Option<Filter>,
    /// How a pixel weighs what is around its middle [default: the scene's, or blackman-harris where light is sampled and else box]
    #[arg(long, value_parser = choice::<PixelFilter>())]
    pixel_filter: Option<PixelFilter>,
    /// Follow light of single wavelengths instead of red, green and blue; paths alone do [default: the scene's]
    #[arg(long, value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    spectral: Option<bool>,
    /// Let photons tell light that comes by mirrors and glass: so many for each pixel and sample, 0 to 16; 1 if it is not said how many, 0 for none [default: the scene's]
    #[arg(long, value_name = "PHOTONS", num_args = 0..=1, require_equals = true, default_missing_value = "1")]
    caustics: Option<f32>,
    /// How often a ray is reflected or refracted at most [default: the scene's]
    #[arg(long, value_name = "N")]
    bounces: Option<u32>,
    /// Least share of its sample that a ray is followed for [default: the scene's]
    #[arg(long, value_name = "SHARE")]
    min_contribution: Option<f32>,
    /// Quality of the hierarchy: a better one takes longer to build and is faster to trace [default: that of the scene's file, or fast for pictures of few rays and medium for others]
    #[arg(long, value_name = "QUALITY", value_parser = choice::<Bvh>())]
    bvh: Option<Bvh>,
    #[command(flatten)]
    transport: Transport,
}

impl Effort {
    /// With a settings file below the command line.
    pub fn over(self, file: &Preset) -> Effort {
        Effort {
            samples: self.samples.or(file.samples.filter(|_| self.spp.is_none())),
            spp: self.spp.or(file.spp.filter(|_| self.samples.is_none())),
            transport: self.transport.over_file(file),
            sampler: self.sampler.or(file.sampler),
            filter: self.filter.or(file.filter),
            pixel_filter: self.pixel_filter.or(file.pixel_filter),
            spectral: self.spectral.or(file.spectral),
            caustics: self.caustics.or(file.caustics),
            bounces: self.bounces.or(file.bounces),
            min_contribution: self.min_contribution.or(file.min_contribution),
            bvh: self.bvh.or(file.bvh),
        }
    }

    /// As many samples as a pixel may have, unless a number is asked for.
    pub fn endless(self, scene: &Scene) -> Result<Effort> {
        self.without_grid(scene, "--time-limit", Settings::MOST_SPP)
    }

    /// At most so many samples, unless a number is asked for: for an option that decides how many there are.
    pub fn without_grid(self, scene: &Scene, option: &str, most: u32) -> Result<Effort> {
        let sampler = self.sampler.unwrap_or(scene.settings.sampler);
        if sampler.has_cells() {
            let name = sampler.name();
            let remedy = "add --sampler sobol";
            return Err(Error::new(format!(
                "{option}: the sampler {name} has a grid of a fixed number of samples; {remedy}"
            )));
        }
        Ok(Effort { samples: None, spp: self.spp.or(Some(most)), ..self })
    }

    /// The samples of a pixel that are asked for, by their number.
    pub fn spp(&self) -> Option<u32> {
        self.spp
    }

    /// The integrator that is asked for.
    pub fn integrator(&self) -> Option<Integrator> {
        self.transport.integrator()
    }

    /// That of the hierarchy of a scene by some settings: what is asked for, or what the scene brings along, or what its picture is
    /// worth.
    pub fn quality(&self, scene: &Scene, settings: &Settings, choice: &Choice) -> Quality {
        if let Some(bvh) = self.bvh.or(scene.hierarchy.as_ref().map(|kept| kept.quality())) {
            return bvh.quality();
        }
        let (width, height) = settings.size;
        // A ray and a shadow ray, and those of some bounces where light is sampled.
        let of_sample = if settings.transport.integrator.samples() { 8 } else { 2 };
        let samples = u64::from(width) * u64::from(height) * u64::from(settings.samples_a_pixel());
        Bvh::worth(scene.primitives(), samples.saturating_mul(of_sample), choice.device == DeviceWish::Cpu).quality()
    }
}

/// A scene, packed, and what that took.
pub(super) struct Loaded {
    pub packed: Job,
    pub view: eyerays::view::View,
    pub read_time: Duration,
    /// Of the hierarchy and of all else that is packed.
    pub build_time: Duration,
}

impl View {
    /// The size that is asked for.
    pub fn size(&self) -> Option<(u32, u32)> {
        self.size
    }

    /// Is a pixel to be sharp?
    pub fn has_focus_on(&self) -> bool {
        self.lens.focus_on().is_some()
    }

    /// Packs a scene for these options and what traces it.
    pub fn pack(&self, read: Read<'_>, effort: &Effort, choice: &Choice, quiet: bool) -> Result<Loaded> {
        self.pack_and_keep(read, effort, (choice, None), quiet).map(|(loaded, ..)| loaded)
    }

    /// The same, with the scene and the camera that it is seen from; after the job of the same scene at another moment.
    pub fn pack_and_keep(
        &self,
        read: Read<'_>,
        effort: &Effort,
        (choice, before): (&Choice, Option<&Job>),
        quiet: bool,
    ) -> Result<(Loaded, Scene, Camera)> {
        let Read { path, mut scene, time: read_time, .. } = read;
        let settings = self.settings(&scene, effort)?;
        if settings.transport.integrator != scene.settings.transport.integrator {
            scene::without_spare_lamps(&mut scene, settings.transport.integrator);
        }
        let ignored = settings.transport.integrator.ignored(&scene);
        super::warn(ignored.as_slice(), quiet);
        let mut camera = self.aim(&mut scene).map_err(|e| e.of(path))?;
        let start = Instant::now();
        // It may be none of the scene's.
        scene.cameras.push(camera.clone());
        let pack = || match before {
            Some(before) => choice.pack_moved(before, &scene, settings),
            None => choice.pack(&scene, settings, effort.quality(&scene, &settings, choice)),
        };
        let packed = progress::stage("building", quiet, pack).map_err(|e| e.of(path))?;
        scene.cameras.pop();
        if let Some(pixel) = self.lens.focus_on() {
            focus(&packed, &mut camera, pixel).map_err(|e| e.of(path))?;
        }
        let view = eyerays::view::View::new(&packed, &camera).map_err(|e| e.of(path))?;
        let loaded = Loaded { packed, view, read_time, build_time: start.elapsed() };
        Ok((loaded, scene, camera))
    }

    /// The scene's settings with the command line's over them.
    pub fn settings(&self, scene: &Scene, effort: &Effort) -> Result<Settings> {
        let own = scene.settings;
        let settings = Settings {
            size: self.size.unwrap_or(own.size),
            samples: effort.samples.unwrap_or(own.samples),
            // Either option overrides both of the scene's.
            spp: effort.spp.unwrap_or(if effort.samples.is_some() { 0 } else { own.spp }),
            transport: effort.transport.over(&own.transport)?,
            sampler: effort.sampler.unwrap_or(own.sampler),
            bounces: effort.bounces.unwrap_or(own.bounces),
            min_contribution: effort.min_contribution.unwrap_or(own.min_contribution),
            culling: self.cull.unwrap_or(own.culling),
            compensation: own.compensation && !self.no_compensation,
            filter: effort.filter.unwrap_or(own.filter),
            pixel_filter: effort.pixel_filter.or(own.pixel_filter),
            transparent: self.transparent.unwrap_or(own.transparent),
            spectral: effort.spectral.unwrap_or(own.spectral),
            caustics: effort.caustics.unwrap_or(own.caustics),
        };
        Picture::check_size(settings.size.0, settings.size.1)?;
        within("--samples", &[settings.samples], 1..=Settings::MOST_SAMPLES)?;
        within("--spp", effort.spp.as_slice(), 1..=Settings::MOST_SPP)?;
        settings.grid()?;
        within("--bounces", &[settings.bounces], 0..=Settings::MOST_BOUNCES)?;
        within("--min-contribution", &[settings.min_contribution], 0.0..=1.0)?;
        within("--caustics", &[settings.caustics], 0.0..=Settings::MOST_PHOTONS)?;
        Ok(settings)
    }

    /// Gives the scene's cameras the lens and the projection that are asked for, and returns the camera that is.
    pub fn aim(&self, scene: &mut Scene) -> Result<Camera> {
        scene.cameras = scene.cameras.drain(..).map(|camera| self.lens.over(camera)).collect::<Result<_>>()?;
        let mut camera = match (&self.camera, self.eye, self.target) {
            (Some(wish), ..) => camera::pick(&scene.cameras, wish)?.clone(),
            (None, Some(eye), Some(target)) => {
                let projection = Projection::Perspective { fov: 60.0 };
                self.lens.over(Camera::new("--eye", eye, target, projection))?
            }
            _ => scene.cameras[0].clone(),
        };
        (camera.eye, camera.target) = (self.eye.unwrap_or(camera.eye), self.target.unwrap_or(camera.target));
        if camera.eye == camera.target {
            return Err(Error::new("--eye and --target are the same point: the camera looks at itself; move one"));
        }
        if self.eye.or(self.target).is_some() {
            camera.up = camera::upright(camera.up, camera.target - camera.eye);
        }
        Ok(camera)
    }
}

/// Makes a camera sharp where a pixel of its picture shows something.
fn focus(packed: &Job, camera: &mut Camera, (x, y): (u32, u32)) -> Result<()> {
    let nothing = || Error::new(format!("--focus-on {x},{y}: the picture shows nothing there; name another pixel"));
    let depth = eyerays::layers::depth(packed, camera, (x, y))?.ok_or_else(nothing)?;
    camera.lens = camera.lens.map(|lens| Lens { focus: Focus::Distance(depth), ..lens });
    Ok(())
}

/// `WxH`.
pub(super) fn size(text: &str) -> std::result::Result<(u32, u32), String> {
    let parts = text.split_once(['x', 'X']).and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    parts.ok_or_else(|| "write a width and a height in pixels, for example 640x480".to_owned())
}
