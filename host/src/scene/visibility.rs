//! Who sees an object, and what it is to a picture.

use serde::{Deserialize, Serialize};

use super::Unplaced;

/// Which rays meet an object or a material, and what pictures show of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Visibility {
    /// Does the camera see it?
    pub camera: bool,
    /// Does it cast shadows?
    pub shadow: bool,
    /// Do the rays that other surfaces send out meet it: reflections, what is seen through glass, and light that is scattered?
    pub reflection: bool,
    /// What the camera sees of it.
    pub matte: Matte,
}

/// What a picture shows where the camera sees an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Matte {
    /// The object.
    #[default]
    Shown,
    /// A shadow catcher: what others keep away of its light, as opacity, and what it reflects of them.
    Catcher,
    /// A hole: nothing, which is not opaque either.
    Holdout,
}

impl Default for Visibility {
    /// All rays meet it, and it is shown.
    fn default() -> Self {
        Visibility { camera: true, shadow: true, reflection: true, matte: Matte::Shown }
    }
}

impl Visibility {
    /// That of an object of a material: what either hides is hidden.
    #[must_use]
    pub fn and(self, other: Visibility) -> Visibility {
        Visibility {
            camera: self.camera && other.camera,
            shadow: self.shadow && other.shadow,
            reflection: self.reflection && other.reflection,
            matte: self.matte.max(other.matte),
        }
    }

    /// Is it as if nothing were said?
    pub fn is_plain(&self) -> bool {
        *self == Visibility::default()
    }

    /// Refuses what its settings would draw otherwise.
    pub(super) fn check(&self, whose: &str) -> Unplaced<()> {
        match self.matte {
            Matte::Catcher if !self.camera => {
                Err(format!("{whose} is a shadow catcher that the camera does not see; remove one of both"))
            }
            _ => Ok(()),
        }
    }
}
