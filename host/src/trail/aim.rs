//! Which ray of a camera is followed.

use crate::device_scene::Feature;
use crate::error::{Error, Result};
use crate::job::Job;
use crate::layers::middles;
use crate::scene::Camera;
use crate::view::{Region, View};

/// A ray of the camera, by its pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Aim {
    /// The pixel's column from 0.
    pub x: u32,
    /// Its row from 0, from the top.
    pub y: u32,
    /// Which of the pixel's samples, from 0; without one the ray through the middle of the pixel and of the lens, as the shutter opens.
    pub sample: Option<u32>,
}

impl Aim {
    /// Through the middle of a pixel.
    pub fn middle(x: u32, y: u32) -> Aim {
        Aim { x, y, sample: None }
    }

    /// Through the middle of a pixel of a picture of this width and height.
    ///
    /// # Errors
    /// The picture has no such pixel.
    pub fn within((x, y): (i64, i64), (width, height): (u32, u32)) -> Result<Aim> {
        let place = |at: i64, size: u32| u32::try_from(at).ok().filter(|&at| at < size);
        place(x, width).zip(place(y, height)).map(|(x, y)| Aim::middle(x, y)).ok_or_else(|| {
            let (right, bottom) = (width.saturating_sub(1), height.saturating_sub(1));
            Error::new(format!(
                "the pixel {x},{y} is not in the picture of {width}x{height}: give a column from 0 to {right} and a row from 0 to {bottom}"
            ))
        })
    }

    /// A job that shows a feature, and a view of a part of its image: of the one ray of each pixel that this aims by.
    ///
    /// # Errors
    /// The image has no such pixel, or the pixel no such sample; or as [`View::new`].
    pub(crate) fn sight(&self, job: &Job, camera: &Camera, feature: Feature) -> Result<(Job, View)> {
        Aim::within((self.x.into(), self.y.into()), job.settings().size)?;
        let Some(sample) = self.sample else {
            let (middle, pinhole) = middles(job.settings(), camera);
            let job = job.with(middle)?.showing(Some(feature));
            let view = View::new(&job, &pinhole)?.as_it_opens();
            return Ok((job, view));
        };
        let job = job.showing(Some(feature));
        let view = View::new(&job, camera)?;
        if sample >= view.samples() {
            let last = view.samples() - 1;
            return Err(Error::new(format!("the pixel has no sample {sample}: give one from 0 to {last}")));
        }
        let view = view.part(view.region(), sample..sample + 1)?;
        Ok((job, view))
    }

    /// The part of a view that is its pixel.
    pub(crate) fn pixel(&self) -> Region {
        Region { x: self.x, y: self.y, width: 1, height: 1 }
    }
}
