//! What a window is to show, all of it as a value: who renders goes from what there is to what is wished for by the least work.

use std::path::PathBuf;

use eyerays::image::Encoding;
use eyerays::method::Traversal;
use eyerays::render::{Choice, DeviceWish, Precision, Several};
use eyerays::scene::{Camera, Settings};

use crate::edits::Edits;
use crate::shows::Shows;

/// A picture of a scene on a screen.
#[derive(Debug, Clone, PartialEq)]
pub struct Wish {
    /// The scene.
    pub source: Source,
    /// What is different from its files.
    pub edits: Edits,
    /// How it is rendered; as the scene's reader says without any. Its size is not looked at.
    pub settings: Option<Settings>,
    /// From where it is seen; as the scene's reader says without any.
    pub camera: Option<Camera>,
    /// Columns and rows of the picture.
    pub size: (u32, u32),
    /// Is the camera being moved? Then pictures are as small as it takes to follow it.
    pub is_moving: bool,
    /// Are no samples added?
    pub is_paused: bool,
    /// Samples of a pixel at most, of samplers that have any number of them.
    pub most: u32,
    /// What renders.
    pub device: Device,
    /// How light is shown.
    pub look: Encoding,
    /// What is shown in its place.
    pub shows: Shows,
    /// What is told of how rays are followed.
    pub lesson: Lesson,
}

/// What is told of how rays are followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Lesson {
    /// The boxes of the hierarchy so many levels below those of the root's children.
    pub level: Option<u32>,
    /// The way of the ray through the middle of this pixel, its column and row in a picture of the size that is asked for.
    pub pixel: Option<(u32, u32)>,
}

/// Where a scene comes from, and when.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// Its file.
    pub path: PathBuf,
    /// The moment of its animation, in seconds; its reader's own without any.
    pub seconds: Option<f64>,
    /// How often its files have changed.
    pub version: u64,
}

/// What renders, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct Device {
    /// Where.
    pub wish: DeviceWish,
    /// By these devices together instead.
    pub several: Option<Several>,
    /// How numbers are computed.
    pub precision: Precision,
    /// How rays are followed.
    pub traversal: Traversal,
    /// A GPU's number or part of its name, in the place of the window's own.
    pub adapter: Option<String>,
    /// Kernels are translated by naga.
    pub no_passthrough: bool,
    /// CPU threads; 0 is one a core.
    pub threads: usize,
}

impl Device {
    /// As a choice of devices says.
    pub fn of(choice: &Choice) -> Device {
        let Choice { device: wish, precision, traversal, no_passthrough, threads, .. } = *choice;
        let (several, adapter) = (choice.several.clone(), choice.adapter.clone());
        Device { wish, several, precision, traversal, adapter, no_passthrough, threads }
    }

    /// The choice of devices.
    pub fn choice(&self) -> Choice {
        let Device { wish: device, precision, traversal, no_passthrough, threads, .. } = *self;
        let (several, adapter) = (self.several.clone(), self.adapter.clone());
        Choice { device, precision, traversal, adapter, no_passthrough, threads, around: None, several }
    }
}

impl Wish {
    /// Of a scene as its reader reads it.
    pub fn new(path: PathBuf, device: Device, size: (u32, u32)) -> Wish {
        Wish {
            source: Source { path, seconds: None, version: 0 },
            edits: Edits::default(),
            settings: None,
            camera: None,
            size,
            is_moving: false,
            is_paused: false,
            most: Settings::MOST_SPP,
            device,
            look: Encoding::default(),
            shows: Shows::Light,
            lesson: Lesson::default(),
        }
    }
}
