//! Cameras.

use eyerays_shader::data::Launch;
use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::{Focus, Lens, Projection, Stereo};

/// A camera.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// By this name the command line picks it.
    pub name: String,
    /// World units.
    pub eye: Vec3,
    /// Where it looks; not the eye.
    pub target: Vec3,
    /// Not along the view.
    pub up: Vec3,
    /// What its image holds.
    pub projection: Projection,
    /// How far the image is moved to the right and up, as shares of its width and height: what architects straighten houses with.
    #[serde(default)]
    pub shift: [f32; 2],
    /// What makes it sharp at one distance alone; a pinhole without.
    #[serde(default)]
    pub lens: Option<Lens>,
    /// From where and up to where it sees, in world units along its view, or from the eye where it sees all around: at least 0, and the
    /// second greater or infinite.
    #[serde(default = "all")]
    pub clip: [f32; 2],
    /// Two eyes instead of one.
    #[serde(default)]
    pub stereo: Option<Stereo>,
}

fn all() -> [f32; 2] {
    Camera::ALL
}

impl Camera {
    /// A pinhole camera that is upright in a scene whose y axis points up.
    pub fn new(name: impl Into<String>, eye: Vec3, target: Vec3, projection: Projection) -> Camera {
        let (up, shift, clip) = (Vec3::Y, [0.0; 2], Camera::ALL);
        Camera { name: name.into(), eye, target, up, projection, shift, lens: None, clip, stereo: None }
    }

    /// Planes between which everything is seen.
    pub const ALL: [f32; 2] = [0.0, f32::INFINITY];

    /// Bits of the constant of kernels for it, see [`Launch`], but for those of its lens.
    pub(crate) fn bits(&self) -> u32 {
        let clipped = if self.clip == Camera::ALL { 0 } else { Launch::CLIPPED };
        let stereo = if self.stereo.is_some() { Launch::STEREO } else { 0 };
        self.projection.bits() | clipped | stereo
    }

    /// Does its `up` tell which way is up? Not if it lies along the view, nearer than single precision tells apart.
    pub(crate) fn is_upright(&self) -> bool {
        let sine = self.forward().cross(self.up.as_dvec3().normalize_or_zero());
        sine.length() >= 1e-6
    }

    /// Is it where another is, turned alike?
    pub(crate) fn stands_as(&self, other: &Camera) -> bool {
        (self.eye, self.target, self.up) == (other.eye, other.target, other.up)
    }

    /// The way that it looks, of unit length.
    pub(crate) fn forward(&self) -> DVec3 {
        (self.target.as_dvec3() - self.eye.as_dvec3()).normalize_or_zero()
    }

    /// How far away its plane of focus is, in world units; infinite where it has no lens or none is told.
    pub fn focus_distance(&self) -> f64 {
        match self.lens.map(|lens| lens.focus) {
            None => f64::INFINITY,
            Some(Focus::Distance(distance)) => distance.into(),
            Some(Focus::Target) => (self.target.as_dvec3() - self.eye.as_dvec3()).length(),
            Some(Focus::Point(point)) => (point.as_dvec3() - self.eye.as_dvec3()).dot(self.forward()),
        }
    }
}
