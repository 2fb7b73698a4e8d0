//! Who reads scenes for a window.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use eyerays::quality::Bvh;
use eyerays::scene::{Camera, Scene, Settings};
use eyerays::scene_io::{self, Loading, Moment};
use eyerays_bvh::Quality;

use crate::wish::Source;

/// A scene that was read.
pub struct Read {
    /// All of it.
    pub scene: Scene,
    /// How it is rendered.
    pub settings: Settings,
    /// From where it is seen first.
    pub camera: Camera,
    /// How well its hierarchy is built.
    pub quality: Quality,
    /// What of its files is not drawn.
    pub warnings: Vec<String>,
}

/// Reads scenes: whoever opens a window may have wishes about that.
pub trait Reader: Send {
    /// Reads a scene, or the same again at another moment.
    ///
    /// # Errors
    /// What can't be read: a line with the file's name and the remedy.
    fn read(&mut self, source: &Source) -> Result<Read, String>;
}

/// Several who read by one.
impl Reader for Arc<Mutex<Box<dyn Reader>>> {
    fn read(&mut self, source: &Source) -> Result<Read, String> {
        self.lock().unwrap_or_else(PoisonError::into_inner).read(source)
    }
}

/// Reads scenes as they are.
#[derive(Debug, Clone, Default)]
pub struct AsTheyAre(pub Loading);

impl Reader for AsTheyAre {
    fn read(&mut self, source: &Source) -> Result<Read, String> {
        let loading = self.0.clone();
        let seconds = source.seconds.or(loading.moment.seconds);
        let (scene, warnings) =
            scene_io::load_as(&source.path, Loading { moment: Moment { seconds, ..loading.moment }, ..loading })
                .map_err(|error| error.to_string())?;
        let quality = scene.hierarchy.as_ref().map_or(Bvh::Medium, |kept| kept.quality()).quality();
        let (settings, camera) = (scene.settings, scene.cameras[0].clone());
        let warnings = warnings.iter().map(ToString::to_string).collect();
        Ok(Read { scene, settings, camera, quality, warnings })
    }
}

/// The files that a scene is made of, itself the first.
pub(crate) fn files(source: &Source, scene: &Scene) -> Vec<PathBuf> {
    std::iter::once(source.path.clone()).chain(scene.files.iter().cloned()).collect()
}
