//! What a studio tells a window.

use std::sync::Arc;
use std::time::Duration;

use eyerays::device_scene::NodeBox;
use eyerays::render::Display;
use eyerays::scene::{Animation, Camera, Scene, Settings};
use glam::DVec3;

use crate::edits::Own;
use crate::reader::Read;
use crate::wish::Wish;

/// A picture that is shown.
pub struct Picture {
    /// Its pixels.
    pub display: Display,
    /// Columns and rows, which may be fewer than were asked for.
    pub size: (u32, u32),
    /// Samples of each pixel; none of a picture that only tells what there is until the first.
    pub samples: u32,
    /// From where it is seen.
    pub camera: Camera,
}

/// What is told of a scene.
#[derive(Clone)]
pub struct Facts {
    /// Its cameras.
    pub cameras: Vec<Camera>,
    /// The one that it is seen from first, which may be none of them.
    pub camera: Camera,
    /// How it is rendered.
    pub settings: Settings,
    /// How it may move.
    pub animations: Vec<Animation>,
    /// Lights and materials as its files have them.
    pub own: Arc<Own>,
    /// The least and the greatest corner of all surfaces.
    pub bounds: [DVec3; 2],
    /// Triangles, spheres and disks.
    pub primitives: u64,
    /// What of its files is not drawn.
    pub warnings: Vec<String>,
    /// The files that it is made of.
    pub files: Vec<std::path::PathBuf>,
}

impl Facts {
    pub(crate) fn of(read: &Read, own: Arc<Own>, files: Vec<std::path::PathBuf>) -> Facts {
        let Read { scene, settings, camera, warnings, .. } = read;
        let Scene { cameras, animations, .. } = scene;
        Facts {
            cameras: cameras.clone(),
            camera: camera.clone(),
            settings: *settings,
            animations: animations.clone(),
            own,
            bounds: scene.bounds().map(|corner| corner.as_dvec3()),
            primitives: scene.primitives(),
            warnings: warnings.clone(),
            files,
        }
    }
}

/// How fast pictures come.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Rates {
    /// Pictures, or samples of all pixels, a second of the wall clock.
    pub frames: f64,
    /// Rays of the camera a second.
    pub rays: f64,
    /// The share of that time that the device was at work, if it has a clock.
    pub device: Option<f64>,
}

/// What a studio does.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Doing {
    /// Waits for a wish.
    #[default]
    Nothing,
    /// Reads a scene's files.
    Reading,
    /// Builds its hierarchy.
    Building,
    /// Compiles kernels and sends the scene to a device, for so long.
    Opening(Duration),
    /// Adds samples.
    Rendering,
    /// All samples are there.
    Done,
}

/// How rays are followed.
#[derive(Default)]
pub struct Told {
    /// Boxes of the hierarchy.
    pub boxes: Vec<NodeBox>,
    /// The way of one ray.
    pub way: Option<Way>,
}

/// The way of a ray, for people.
pub struct Way {
    /// Its pixel.
    pub pixel: (u32, u32),
    /// A line a step, or why it can't be told.
    pub text: String,
    /// The boxes that it enters, with how many nodes are above each; none of nodes of eight children, or in copies of meshes.
    pub entered: Vec<(NodeBox, u32)>,
}

/// Where a studio stands.
#[derive(Clone, Default)]
pub struct News {
    /// What it does.
    pub doing: Doing,
    /// The scene, once one was read.
    pub facts: Option<Arc<Facts>>,
    /// What renders.
    pub device: String,
    /// Samples of each pixel.
    pub samples: u32,
    /// Samples of the picture whose noise was taken off, where that is shown.
    pub denoised: Option<u32>,
    /// The standard error of a pixel over the mean of all, once it is known.
    pub noise: Option<f64>,
    /// How fast that is.
    pub rates: Rates,
    /// What the darkest and the brightest colour of a layer stand for.
    pub scale: Option<[f64; 2]>,
    /// What was asked of how rays are followed.
    pub lesson: Arc<Told>,
    /// What went wrong with the last wish: the picture is of the one before.
    pub fault: Option<String>,
}

/// A question about the picture. Pixels are told by their column and row in what was asked for, whatever is shown meanwhile.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ask {
    /// What is there?
    What(u32, u32),
    /// How far is it, for the camera to be sharp there?
    Focus(u32, u32),
    /// The light of all pixels.
    Light,
}

/// The light of a picture.
pub struct Light {
    /// What was wished for.
    pub wish: Wish,
    /// Samples of each pixel.
    pub samples: u32,
    /// All of it.
    pub picture: eyerays::picture::Picture,
}

/// What is there.
pub enum Answer {
    /// In a line.
    What(String),
    /// In front of the camera, in the scene's units.
    Focus(f32),
    /// What so many samples have come to, and of which wish.
    Light(Box<Light>),
    /// Nothing is there, or it can't be told.
    Nothing(String),
}
