//! What is rendered of a scene: all that kernels are compiled for.

use std::ops::Deref;
use std::sync::{Arc, OnceLock};

use eyerays_bvh::Quality;
use eyerays_shader::data::{
    Aovs, Caustics, Effects, Finishes, Frame, Launch, Layout, Media, Specialisation, Waves, pack,
};
use eyerays_shader::material::ALBEDOS;
use eyerays_shader::medium::Inside;
use glam::{UVec4, Vec3};

use crate::device_scene::{DeviceScene, Feature, flushed};
use crate::error::{Error, Result};
use crate::integrator::needs;
use crate::layers;
use crate::method::Traversal;
use crate::scene::{Integrator, PixelFilter, Scene, Settings, Transport};

/// A scene as devices hold it, with settings and what its pictures show. Cheap to clone: jobs of one scene share it.
#[derive(Clone)]
pub struct Job {
    scene: Arc<DeviceScene>,
    settings: Settings,
    feature: Option<Feature>,
    aovs: Aovs,
    optic_tables: Arc<OnceLock<Vec<u32>>>,
}

impl Job {
    /// Packs a scene. All methods follow rays through it but [`Method::Wide`](crate::method::Method::Wide) on a GPU.
    ///
    /// # Errors
    /// As [`DeviceScene::new`] and [`Job::of`].
    pub fn new(scene: &Scene, settings: Settings, quality: Quality) -> Result<Job> {
        Job::packed(scene, settings, quality, false)
    }

    /// As [`Job::new`], with the nodes of eight children beside that a GPU walks by
    /// [`Method::Wide`](crate::method::Method::Wide).
    ///
    /// # Errors
    /// As there.
    pub fn with_wide_nodes(scene: &Scene, settings: Settings, quality: Quality) -> Result<Job> {
        Job::packed(scene, settings, quality, true)
    }

    fn packed(scene: &Scene, settings: Settings, quality: Quality, is_wide: bool) -> Result<Job> {
        // Before the hierarchy is built, which may take long.
        scene.check()?;
        settings.check()?;
        check_emission(scene.emissive(), settings.transport.integrator)?;
        Job::of(Arc::new(DeviceScene::of_checked(scene, quality, is_wide, None)?), settings)
    }

    /// The same for the scene at another moment, by the hierarchy that it has where that will do: see [`DeviceScene::moved`].
    ///
    /// # Errors
    /// As [`Job::new`].
    pub fn moved(&self, scene: &Scene, settings: Settings) -> Result<Job> {
        settings.check()?;
        check_emission(scene.emissive(), settings.transport.integrator)?;
        Job::of(Arc::new(self.scene.moved(scene)?), settings)
    }

    /// Of a scene that is packed.
    ///
    /// # Errors
    /// Settings out of range, or an integrator that would leave out light.
    pub fn of(scene: Arc<DeviceScene>, settings: Settings) -> Result<Job> {
        settings.check()?;
        check_emission(scene.emissive(), settings.transport.integrator)?;
        if scene.has_catchers() && settings.transport.integrator != Integrator::Path {
            return Err(Error::new(
                "the scene has a shadow catcher, which paths alone show: set the integrator to \"path\"",
            ));
        }
        let lights = !matches!(settings.transport.integrator, Integrator::Path | Integrator::Ao);
        if scene.is_linked() && lights {
            return Err(Error::new(
                "some materials are lit by some lamps alone (lit_by), which paths alone tell apart: set the integrator to \"path\"",
            ));
        }
        if scene.media_bits() != Media::default() && lights {
            return Err(Error::new(
                "the scene has media (volume, fog), which paths alone go through: set the integrator to \"path\"",
            ));
        }
        if settings.caustics > 0.0 && settings.transport.integrator != Integrator::Path {
            return Err(Error::new(
                "photons tell of caustics to paths alone: set the integrator to \"path\" (--integrator path), or leave caustics out (--caustics=0)",
            ));
        }
        if settings.spectral && settings.transport.integrator != Integrator::Path {
            return Err(Error::new(
                "light of single wavelengths (spectral) is what paths alone carry: set the integrator to \"path\" (--integrator path)",
            ));
        }
        Ok(Job { scene, settings, feature: None, aovs: Aovs(0), optic_tables: Arc::default() })
    }

    /// The same scene by other settings, with light and nothing beside it.
    ///
    /// # Errors
    /// As [`Job::of`].
    pub fn with(&self, settings: Settings) -> Result<Job> {
        let job = Job::of(self.scene.clone(), settings)?;
        // Layers of a picture have its filter, whose table takes 2 ms to make.
        let is_same = settings.pixel_filter() == self.settings.pixel_filter();
        Ok(if is_same { Job { optic_tables: self.optic_tables.clone(), ..job } } else { job })
    }

    /// The same scene and settings, with pictures that show something else instead of light, or light again.
    #[must_use]
    pub fn showing(&self, feature: Option<Feature>) -> Job {
        Job { feature, aovs: Aovs(0), ..self.clone() }
    }

    /// The same job, whose films keep some more of each pixel beside its light.
    ///
    /// # Errors
    /// The integrator traces no paths, or groups of lamps are asked of a scene without any.
    pub fn keeping(&self, aovs: Aovs) -> Result<Job> {
        layers::check(aovs, self.settings.transport.integrator, self.light_groups())?;
        if self.has_photons() && aovs.has(Aovs::GROUPS) {
            return Err(Error::new(
                "photons (caustics) do not tell the light of lamps by their groups: leave out the layers of groups, or caustics",
            ));
        }
        if self.settings.spectral && aovs.has(Aovs::LOBES) {
            return Err(Error::new(
                "layers of what is diffuse, glossy and transmitted are of red, green and blue light: leave them out, or spectral",
            ));
        }
        Ok(Job { aovs, ..self.clone() })
    }

    /// What its films keep beside light.
    pub fn aovs(&self) -> Aovs {
        self.aovs
    }

    /// How many variables that are.
    pub(crate) fn aov_count(&self) -> u32 {
        self.aovs.count(self.light_groups().names().len() as u32)
    }

    /// The scene.
    pub fn scene(&self) -> &Arc<DeviceScene> {
        &self.scene
    }

    /// How much of it is rendered.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// What its pictures show instead of light, if they do.
    pub fn feature(&self) -> Option<Feature> {
        self.feature
    }

    /// The effects of the scene that are asked for.
    pub fn effects(&self) -> Effects {
        let effects = self.scene.asked(&self.settings);
        self.feature.map_or(effects, |feature| self.scene.shown(feature).with(effects.0 & Effects::CULLING))
    }

    /// Can a primary ray's light come from further rays?
    pub fn has_secondary_rays(&self) -> bool {
        self.effects().has(Effects::REFLECTION | Effects::REFRACTION | Effects::PHYSICAL)
    }

    /// Words of the albedos of facets, see [`eyerays_shader::material::Albedos`]; empty where nothing is given back.
    pub fn albedos(&self) -> &'static [u32] {
        static WORDS: OnceLock<Vec<u32>> = OnceLock::new();
        if !self.effects().has(Effects::COMPENSATED) {
            return &[];
        }
        WORDS.get_or_init(|| bytemuck::pod_collect_to_vec(ALBEDOS))
    }

    /// What kernels are compiled for that follow the camera's rays by a traversal.
    pub fn specialisation(&self, traversal: &Traversal) -> Specialisation {
        let filter = if self.effects().has(Effects::TEXTURED) { self.settings.filter.bits() } else { 0 };
        Specialisation {
            effects: self.effects(),
            launch: Launch(
                traversal.triangle.bits()
                    | self.settings.sampler.bits()
                    | self.transport_bits()
                    | filter
                    | self.camera_bits(),
            ),
            layout: Layout(traversal.layout.bits()),
            order: traversal.order.bits(),
            tuning: traversal.tuning,
            aovs: self.aovs,
            media: self.media_bits(),
            finishes: self.finish_bits(),
            waves: self.waves(),
            caustics: Caustics(if self.has_photons() { Caustics::GATHERED } else { 0 }),
        }
    }

    /// What its kernels know of what lies on physical materials: only paths see it.
    pub fn finish_bits(&self) -> Finishes {
        if self.follows_paths() { self.scene.finish_bits() } else { Finishes::default() }
    }

    /// How light has wavelengths.
    pub fn waves(&self) -> Waves {
        // Lights tell which spectrum they have whether it is asked for or not.
        let own = self.scene.own_spectra().waves();
        let is_spectral = self.settings.spectral && self.feature.is_none();
        if is_spectral { own.with(Waves::SPECTRAL) } else { Waves(own.0 & Waves::ILLUMINANTS) }
    }

    /// Words of the table of spectra, see [`eyerays_shader::data::SpectrumRow`]; empty where light has no wavelengths.
    pub fn spectra(&self) -> &[UVec4] {
        if self.waves().has(Waves::SPECTRAL) { self.scene.own_spectra().words() } else { &[] }
    }

    /// Do photons tell of caustics? Only where something casts them, and to paths.
    pub fn has_photons(&self) -> bool {
        let is_asked = self.follows_paths() && self.settings.caustics > 0.0 && self.settings.bounces > 0;
        is_asked && !self.casters().is_empty() && !self.lighting().emitters.is_empty()
    }

    /// How many photons a sample of a picture of some size has: 0 where none tell of caustics.
    pub fn photons(&self, (width, height): (u32, u32)) -> u32 {
        /// More are no use: samples have others.
        const MOST: f64 = (1 << 18) as f64;
        let wished = f64::from(width) * f64::from(height) * f64::from(self.settings.caustics);
        if self.has_photons() { wished.round().clamp(1.0, MOST) as u32 } else { 0 }
    }

    /// What of the media its kernels know: only paths go through them.
    pub fn media_bits(&self) -> Media {
        if self.follows_paths() { self.scene.media_bits() } else { Media::default() }
    }

    fn follows_paths(&self) -> bool {
        self.feature.is_none() && self.settings.transport.integrator == Integrator::Path
    }

    /// What cameras and the film need.
    fn camera_bits(&self) -> u32 {
        let is_filtered = self.settings.pixel_filter() != PixelFilter::Box;
        let optics = self.optics().bits() | self.movement().bits() | if is_filtered { Launch::FILTERED } else { 0 };
        let is_kept = !needs(self).stages.generates && optics & (KEPT_CAMERAS | Launch::MOVING | Launch::PANNED) != 0;
        optics | if is_kept { Launch::KEPT } else { 0 } | self.film_bits()
    }

    /// What a film keeps beside light: how much of a pixel is clear, and what shadow catchers get.
    pub(crate) fn film_bits(&self) -> u32 {
        if self.feature.is_some() {
            return 0;
        }
        let catcher = if self.scene.has_catchers() { Launch::CATCHER } else { 0 };
        catcher | if self.is_transparent() { Launch::CLEAR } else { 0 }
    }

    /// Does a picture tell how much of it is opaque? It does if its settings ask for that, and where holes or shadow catchers do.
    pub fn is_transparent(&self) -> bool {
        self.settings.transparent || self.scene.has_mattes()
    }

    /// Tables of cameras as kernels read them, see [`eyerays_shader::camera::ray`]; empty where they read none.
    pub fn optic_tables(&self) -> &[u32] {
        self.optic_tables.get_or_init(|| self.optics().words(self.settings.pixel_filter()))
    }

    fn transport_bits(&self) -> u32 {
        let Transport { integrator, direct, .. } = self.settings.transport;
        if let Some(feature) = self.feature {
            return feature.bits();
        }
        match integrator {
            Integrator::Whitted => 0,
            Integrator::Ao => Launch::OCCLUSION,
            Integrator::Distributed => Launch::TREE,
            Integrator::Path => direct.bits(),
        }
    }

    /// Every launch's record but for what a view says.
    pub(crate) fn frame(&self) -> Frame {
        let lights = self.lights().len() as u32;
        let Transport { seed, roulette, clamp, ao_distance, .. } = self.settings.transport;
        let [least, greatest] = self.found_light().unwrap_or([Vec3::ONE, Vec3::NEG_ONE]);
        let reach = (f64::from(ao_distance) * self.normalisation().scale).min(f32::MAX.into()) as f32;
        let [horizon, zenith] = self.background();
        Frame {
            origin: self.origin(),
            pairs: self.pairs(),
            lamps: pack(flushed((least + greatest) * 0.5), 0),
            lamps_half: pack(flushed((greatest - least) * 0.5), 0),
            horizon,
            zenith,
            bounces: self.settings.bounces,
            min_contribution: self.settings.min_contribution,
            lights,
            shadow_rays: needs(self).shadow_rays,
            seed,
            emitters: self.lighting().emitters.len() as u32,
            roulette,
            clamp,
            reach,
            environment: self.lighting().environment,
            far: self.lighting().far,
            vertices: self.primitives().len() as u32,
            aovs: self.aov_count(),
            group: self.background_group(),
            media: self.fog() << Inside::BITS,
            steps: self.movement().steps,
            exposure: self.movement().exposure,
            ..Frame::default()
        }
    }
}

/// What makes rays of the camera that lie in memory.
const KEPT_CAMERAS: u32 = Launch::LENS | Launch::ROUND | Launch::FILTERED | Launch::CLIPPED | Launch::STEREO;

/// All that a scene says is asked of a job, too.
impl Deref for Job {
    type Target = DeviceScene;

    fn deref(&self) -> &DeviceScene {
        &self.scene
    }
}

/// Refuses to leave out light.
///
/// # Errors
/// The integrator draws no light that materials emit.
fn check_emission(emissive: Option<&str>, integrator: Integrator) -> Result<()> {
    match (emissive, integrator) {
        (Some(name), Integrator::Whitted) => Err(Error::new(format!(
            "the material {name:?} emits light, which the integrator whitted does not draw: choose path or distributed (--integrator path)"
        ))),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use eyerays_bvh::Quality;

    use super::*;
    use crate::job::Job;
    use crate::method::Method;
    use crate::scene::Scene;

    fn whitted() -> Scene {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/whitted.toml");
        crate::scene_io::load(path.as_ref()).unwrap().0
    }

    fn refusal(scene: &Scene, settings: Settings) -> Option<String> {
        let packed = Job::new(scene, settings, Quality::Fast);
        packed.err().map(|error| error.message())
    }

    #[test]
    fn a_method_is_refused_whose_nodes_were_not_packed() {
        let scene = whitted();
        let packed = Job::new(&scene, scene.settings, Quality::Fast).unwrap();
        let refused = packed.check_walks(Method::Wide).expect_err("accepted").message();
        assert!(refused.ends_with("pack it by Job::with_wide_nodes"), "{refused}");
        assert!(packed.check_walks(Method::IfIf).is_ok());
        let packed = Job::with_wide_nodes(&scene, scene.settings, Quality::Fast).unwrap();
        assert!(packed.check_walks(Method::Wide).is_ok());
    }

    #[test]
    fn settings_beyond_their_limits_are_refused_when_they_are_taken_too() {
        let scene = whitted();
        let packed = Job::new(&scene, scene.settings, Quality::Fast).unwrap();
        for beyond in [
            Settings { size: (0, 4), ..scene.settings },
            Settings { samples: 0, ..scene.settings },
            Settings { bounces: u32::MAX, ..scene.settings },
            Settings { min_contribution: f32::NAN, ..scene.settings },
        ] {
            assert!(refusal(&scene, beyond).is_some(), "{beyond:?}");
            assert!(packed.with(beyond).is_err(), "{beyond:?}");
        }
    }
}
