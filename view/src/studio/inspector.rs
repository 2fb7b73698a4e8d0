//! Pictures of what tells how a picture is made, by the CPU: of the middles of pixels.

use eyerays::device_scene::{DeviceScene, Feature};
use eyerays::error::{Error, Result};
use eyerays::job::Job;
use eyerays::layers::{self, Values};
use eyerays::render::{Backend, Choice, DeviceWish, Session};
use eyerays::scene::{Scene, Settings};
use eyerays::view::View;

use super::colours::{Coloured, coloured, wires};
use super::growth::Subject;
use crate::shows::Shows;
use crate::wish::Device;

/// A scene laid out for the CPU.
pub(super) struct Inspector {
    session: Session,
    device: Device,
}

impl Inspector {
    /// Of a job's scene, by the threads of a device and as it follows rays.
    pub fn new(job: &Job, of: &Device) -> Result<Inspector> {
        let (threads, traversal) = (of.threads, of.traversal);
        let backend = Backend::new(&Choice { device: DeviceWish::Cpu, threads, traversal, ..Choice::default() })?;
        Ok(Inspector { session: backend.open(&colours(job, *job.settings())?)?, device: of.clone() })
    }

    /// Is it of this scene, and as this device follows rays?
    pub fn is_of(&self, job: &Job, device: &Device) -> bool {
        self.device == *device && std::ptr::eq::<DeviceScene>(&**self.session.job(), &**job)
    }

    /// What is to be seen, in the place of light.
    pub fn look(&mut self, (job, scene): (&Job, &Scene), subject: &Subject, shows: Shows) -> Result<Coloured> {
        let settings = Settings { size: subject.size, samples: 1, spp: 1, ..*job.settings() };
        let job = colours(job, settings)?;
        self.session.turn(&job)?;
        let view = View::new(&job, &subject.camera)?;
        // The colours of surfaces, which take one ray a pixel.
        let rendering = self.session.expose(&view, &|_| ())?;
        let shown = layers::Shown { scene, camera: &subject.camera, neighbours: None };
        let layers = layers::render(&mut self.session, shown, &rendering, &shows.layers())?;
        match &layers[..] {
            [(_, Values::Vectors(normals)), (_, Values::Numbers(primitives))] => Ok(wires(normals, primitives)),
            [(layer, values)] => coloured(*layer, values),
            _ => Err(Error::new(format!("{shows} is no picture of layers: this is a fault of the program"))),
        }
    }
}

fn colours(job: &Job, settings: Settings) -> Result<Job> {
    Ok(job.with(settings)?.showing(Some(Feature::Albedo)))
}
