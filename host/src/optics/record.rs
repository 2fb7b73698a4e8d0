//! A camera as kernels know it: for an image of some size, in the normalised scene.

use eyerays_shader::data::{self, numbers};
use glam::{DVec3, Vec3};

use crate::cpu;
use crate::device_scene::flushed;
use crate::error::{Error, Result};
use crate::job::Job;
use crate::math;
use crate::scene::{Camera, Lens, Projection};

/// What of a launch's record is the camera's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CameraRecord {
    /// See [`data::Frame::camera`].
    pub camera: data::Camera,
    /// See [`data::Frame::spread`].
    pub spread: f32,
    /// See [`data::Frame::angle`].
    pub angle: f32,
    /// See [`data::Frame::aperture`].
    pub aperture: f32,
    /// See [`data::Frame::near`] and [`data::Frame::farthest`].
    pub clip: [f32; 2],
    /// See [`data::Frame::eyes`] and [`data::Frame::converging`].
    pub eyes: [f32; 2],
    /// See [`data::Frame::keys`].
    pub keys: u32,
    /// See [`data::Frame::media`].
    pub inside: u32,
}

impl CameraRecord {
    /// Of a camera in a scene, for an image of so many pixels with so many cells along a pixel's edge.
    ///
    /// # Errors
    /// There is no way to look so, it is too far away for the scene's numbers, or the scene was packed without what it needs.
    pub fn new(job: &Job, camera: &Camera, size: (u32, u32), grid: u32) -> Result<CameraRecord> {
        let [right, up, forward] = camera.axes();
        if right == DVec3::ZERO {
            return Err(refused(camera, "looks along its up vector or at itself: move its target or turn its up"));
        }
        let eye = job.normalisation().place_anywhere(camera.eye);
        let eye = eye.ok_or_else(|| refused(camera, "is too far away: move it nearer to the scene"))?;
        let needed = camera.bits();
        if needed & !job.optics().bits() != 0 {
            let why = "has a projection, clipping planes or eyes that no camera of the scene has: \
                 add it to the scene's cameras before it is packed";
            return Err(refused(camera, why));
        }
        let axes = Axes { eye, right, up, forward };
        let of_eye = camera.stereo.map_or(size, |stereo| stereo.halved(size));
        if camera.stereo.is_some()
            && 2 * u64::from(of_eye.0) * u64::from(of_eye.1) != u64::from(size.0) * u64::from(size.1)
        {
            return Err(refused(camera, "has two eyes, which share an odd number of pixels: make the size even"));
        }
        let record = match camera.projection {
            Projection::Perspective { .. } | Projection::Orthographic { .. } => axes.flat(job, camera, of_eye, grid)?,
            Projection::Equirectangular | Projection::Fisheye { .. } => axes.round(camera.projection, of_eye, grid),
        };
        let keys = job.movement().keys(camera).unwrap_or(data::Frame::STILL);
        let inside = cpu::enclosing(job, eye).0;
        let record = CameraRecord { keys, inside, ..record };
        record.clipped(job, camera).and_then(|record| record.of_two(job, camera))
    }

    /// Between the camera's clipping planes.
    fn clipped(self, job: &Job, camera: &Camera) -> Result<CameraRecord> {
        let scale = job.normalisation().scale;
        let [near, far] = camera.clip.map(|distance| f64::from(distance) * scale);
        if near > f64::from(1u32 << 30) {
            return Err(refused(camera, "is clipped too far away: move clip_near nearer"));
        }
        // What is that far away is not in the scene.
        let far = if far < f64::from(1u32 << 30) { far } else { 0.0 };
        let flush = |number: f64| flushed(Vec3::splat(number as f32)).x;
        Ok(CameraRecord { clip: [flush(near), flush(far)], ..self })
    }

    /// For two eyes, if the camera has them.
    fn of_two(self, job: &Job, camera: &Camera) -> Result<CameraRecord> {
        let Some(stereo) = camera.stereo else { return Ok(self) };
        let scale = job.normalisation().scale;
        let step = f64::from(numbers(self.camera.right).length());
        let eyes = f64::from(stereo.distance) / 2.0 * scale / step;
        let converging = stereo.convergence.map_or(0.0, |distance| eyes / (f64::from(distance) * scale));
        let is_possible = eyes.max(converging) < f64::from(1u32 << 30);
        if !is_possible {
            return Err(refused(camera, "has eyes too far apart, or looking at a place too near: change its stereo"));
        }
        let eyes = [eyes, converging].map(|number| flushed(Vec3::splat(number as f32)).x);
        Ok(CameraRecord { camera: self.camera.seen_by(stereo.kind()), eyes, ..self })
    }
}

/// Where the camera is and how it is turned.
struct Axes {
    eye: Vec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
}

fn vector(v: DVec3) -> Vec3 {
    flushed(v.as_vec3())
}

impl Axes {
    /// Onto an image plane.
    fn flat(&self, job: &Job, camera: &Camera, (width, height): (u32, u32), grid: u32) -> Result<CameraRecord> {
        let scale = job.normalisation().scale;
        let half_height = match camera.projection {
            Projection::Orthographic { height } => f64::from(height) / 2.0 * scale,
            other => math::tan(f64::from(other.fov().unwrap_or(45.0)).to_radians() / 2.0),
        };
        // A step is half a cell, so that a pixel's samples lie at odd steps from the centre.
        let step = half_height / f64::from(height * grid);
        let (right, up) = (vector(self.right * step), vector(self.up * step));
        let record = data::Camera::new(self.eye, right, up, vector(self.forward));
        let mut record = record.projected(camera.projection.kind());
        // An image further to the right and up shows what is there: less of it is left and below of the middle.
        let [aside, above] = camera.shift.map(f64::from);
        record.right.w = ((2.0 * aside * f64::from(width * grid)) as f32).to_bits();
        record.up.w = ((-2.0 * above * f64::from(height * grid)) as f32).to_bits();
        let (camera, aperture) = match camera.lens.filter(|lens| lens.radius > 0.0) {
            Some(lens) => self.through(job, camera, &lens, record)?,
            None => (record, 0.0),
        };
        // Half a cell's height is a step at distance 1.
        let spread = 2.0 * up.length();
        let (clip, eyes, keys) = ([0.0; 2], [0.0; 2], data::Frame::STILL);
        Ok(CameraRecord { camera, spread, angle: 0.0, aperture, clip, eyes, keys, inside: 0 })
    }

    /// The same through a lens, and its diameter.
    fn through(&self, job: &Job, camera: &Camera, lens: &Lens, record: data::Camera) -> Result<(data::Camera, f32)> {
        let corners = job.optics().corners(lens).ok_or_else(|| {
            refused(
                camera,
                "has a lens that no camera of the scene has: add it to the scene's cameras before it is packed",
            )
        })?;
        let scale = job.normalisation().scale;
        let radius = f64::from(lens.radius) * scale;
        let over_focus = 1.0 / (camera.focus_distance() * scale);
        let is_possible = over_focus >= 0.0 && radius.max(over_focus) * radius.max(1.0) < f64::from(1u32 << 30);
        if !is_possible {
            return Err(refused(
                camera,
                "has a lens that is too large or sharp too near: change its aperture or focus",
            ));
        }
        let (across, above) = (vector(self.right * (radius / f64::from(lens.ratio))), vector(self.up * radius));
        let over_focus = flushed(Vec3::splat(over_focus as f32)).x;
        Ok((record.through(across, above, corners, over_focus), 2.0 * radius as f32))
    }

    /// All around.
    fn round(&self, projection: Projection, (width, height): (u32, u32), grid: u32) -> CameraRecord {
        let (right, up) = (vector(self.right), vector(self.up));
        let camera = data::Camera::new(self.eye, right, up, vector(self.forward)).projected(projection.kind());
        let half_circle = f64::from(width.min(height) * grid);
        let (angle, turns) = match projection {
            Projection::Fisheye { fov, .. } => {
                let half = f64::from(fov) / 360.0 / 2.0;
                if projection.kind() == data::Projection::EQUISOLID {
                    (math::sin(half * std::f64::consts::PI) / half_circle, half / half_circle)
                } else {
                    (half / half_circle, half / half_circle)
                }
            }
            // Half a turn over half the width.
            _ => {
                let turns = 0.5 / f64::from(width * grid);
                (turns, turns)
            }
        };
        let spread = (2.0 * turns * std::f64::consts::TAU) as f32;
        let (clip, eyes, keys) = ([0.0; 2], [0.0; 2], data::Frame::STILL);
        CameraRecord { camera, spread, angle: angle as f32, aperture: 0.0, clip, eyes, keys, inside: 0 }
    }
}

fn refused(camera: &Camera, why: &str) -> Error {
    Error::new(format!("camera \"{}\" {why}", camera.name))
}
