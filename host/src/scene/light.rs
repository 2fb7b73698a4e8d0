//! Lights without extent.

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::Falloff;
use crate::spectrum::Illuminant;

/// A light without extent; `colour` is linear RGB times intensity, at least 0.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Light {
    /// Shines every way from a place.
    Point {
        /// World units.
        position: Vec3,
        /// Linear RGB times intensity.
        colour: Vec3,
        /// The group that it is in, empty for none.
        #[serde(default)]
        group: String,
        /// See [`Light::illuminant`].
        #[serde(default)]
        illuminant: Option<Illuminant>,
    },
    /// Shines one way from infinitely far.
    Directional {
        /// The way light travels; not zero.
        direction: Vec3,
        /// Linear RGB times intensity.
        colour: Vec3,
        /// The group that it is in, empty for none.
        #[serde(default)]
        group: String,
        /// See [`Light::illuminant`].
        #[serde(default)]
        illuminant: Option<Illuminant>,
    },
    /// Shines into a cone.
    Spot {
        /// World units.
        position: Vec3,
        /// A point on the cone's axis; not the position.
        target: Vec3,
        /// Linear RGB times intensity.
        colour: Vec3,
        /// Half the angle of the full cone in degrees, in (0, 90).
        outer: f32,
        /// Half the angle of the cone of full light, in [0, outer].
        inner: f32,
        /// How it fades between them.
        #[serde(default)]
        falloff: Falloff,
        /// The group that it is in, empty for none.
        #[serde(default)]
        group: String,
        /// See [`Light::illuminant`].
        #[serde(default)]
        illuminant: Option<Illuminant>,
    },
}

impl Light {
    /// The group that it is in, empty for none.
    pub fn group(&self) -> &str {
        let (Light::Point { group, .. } | Light::Directional { group, .. } | Light::Spot { group, .. }) = self;
        group
    }

    /// The spectrum of its light, where light has wavelengths; without one it is D65's.
    pub fn illuminant(&self) -> Option<Illuminant> {
        let (Light::Point { illuminant, .. } | Light::Directional { illuminant, .. } | Light::Spot { illuminant, .. }) =
            self;
        *illuminant
    }

    /// Where it is and which way it shines, where it does not shine every way.
    pub(crate) fn stance(&self) -> (Vec3, Option<DVec3>) {
        let way = |from: Vec3, to: Vec3| Some((to.as_dvec3() - from.as_dvec3()).normalize_or_zero());
        match *self {
            Light::Point { position, .. } => (position, None),
            Light::Directional { direction, .. } => (Vec3::ZERO, way(Vec3::ZERO, direction)),
            Light::Spot { position, target, .. } => (position, way(position, target)),
        }
    }

    /// Is it of the kind of another, where that is, turned alike?
    pub(crate) fn stands_as(&self, other: &Light) -> bool {
        self.is_as(other) && self.stance() == other.stance()
    }

    /// Is it of the kind of another?
    pub(crate) fn is_as(&self, other: &Light) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(other)
    }

    /// The same light of another spectrum.
    #[must_use]
    pub fn of_spectrum(mut self, of: Option<Illuminant>) -> Light {
        let (Light::Point { illuminant, .. } | Light::Directional { illuminant, .. } | Light::Spot { illuminant, .. }) =
            &mut self;
        *illuminant = of;
        self
    }

    /// The same light in a group.
    #[must_use]
    pub fn in_group(mut self, name: &str) -> Light {
        let (Light::Point { group, .. } | Light::Directional { group, .. } | Light::Spot { group, .. }) = &mut self;
        name.clone_into(group);
        self
    }
}
