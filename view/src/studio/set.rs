//! A scene that is packed, as a wish has it.

use std::sync::Arc;

use eyerays::error::Result;
use eyerays::job::Job;
use eyerays::scene::{Camera, Scene, Settings};

use crate::edits::{Edits, Own};
use crate::news::Facts;
use crate::reader::{Read, files};
use crate::wish::{Source, Wish};

/// A scene, and the job that it is packed as.
pub(super) struct Set {
    scene: Scene,
    own: Arc<Own>,
    edits: Edits,
    /// As it is seen first.
    camera: Camera,
    settings: Settings,
    job: Job,
    pub facts: Arc<Facts>,
}

impl Set {
    /// Packs a scene that was read for a wish; by the hierarchy of the same scene at another moment where that will do.
    pub fn new(mut read: Read, source: &Source, wish: &Wish, before: Option<&Set>) -> Result<Set> {
        let own = Arc::new(Own::of(&read.scene));
        let facts = Arc::new(Facts::of(&read, own.clone(), files(source, &read.scene)));
        wish.edits.apply(&own, &mut read.scene);
        let (camera, settings) = (read.camera.clone(), read.settings);
        let seen = wish.camera.as_ref().unwrap_or(&camera);
        let job = packed(&mut read.scene, [&camera, seen], |scene| match before {
            Some(before) => before.job.moved(scene, settings),
            None => Job::new(scene, settings, read.quality),
        })?;
        Ok(Set { scene: read.scene, own, edits: wish.edits.clone(), camera, settings, job, facts })
    }

    /// The scene as it was packed last.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The camera of a wish.
    pub fn camera<'a>(&'a self, wish: &'a Wish) -> &'a Camera {
        wish.camera.as_ref().unwrap_or(&self.camera)
    }

    /// Packs it anew, where what is changed asks for that.
    pub fn change(&mut self, wish: &Wish) -> Result<()> {
        let camera = self.camera(wish).clone();
        let is_known = eyerays::view::View::new(&self.job, &camera).is_ok();
        if self.edits == wish.edits && is_known {
            return Ok(());
        }
        wish.edits.apply(&self.own, &mut self.scene);
        self.edits = wish.edits.clone();
        let (job, settings) = (&self.job, self.settings);
        self.job = packed(&mut self.scene, [&self.camera, &camera], |scene| job.moved(scene, settings))?;
        Ok(())
    }

    /// The job of a wish, but for the size of its picture.
    pub fn job(&self, wish: &Wish) -> Result<Job> {
        let settings = wish.settings.unwrap_or(self.settings);
        let has_any_number = !settings.sampler.has_cells();
        let spp = if has_any_number { Settings::MOST_SPP } else { settings.spp };
        self.job.with(Settings { spp, size: self.settings.size, ..settings })
    }
}

/// Packs a scene with other cameras beside its own: kernels are of the kinds of cameras that there are.
fn packed(scene: &mut Scene, others: [&Camera; 2], pack: impl FnOnce(&Scene) -> Result<Job>) -> Result<Job> {
    let own = scene.cameras.len();
    scene.cameras.extend(others.into_iter().cloned());
    let job = pack(scene);
    scene.cameras.truncate(own);
    job
}
