//! What a hierarchy is built over.

use eyerays_shader::data::{Bounds as Record, Primitive};
use glam::{UVec4, Vec3};

use crate::{
    BuildError,
    bounds::Bounds,
    build::{MOST, check_count},
    spatial,
    tree::{Children, position},
};

/// A primitive, or a part of one.
///
/// A ray may enter and leave a part's box before it hits the primitive in another part (5 of 1000 rays in Conference), so a
/// leaf tests primitives and asks no part. Parts only decide which leaves a ray comes to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// The primitive's index.
    pub primitive: u32,
    /// The own box: the part and [`BOX_PADDING`](eyerays_shader::data::BOX_PADDING) around it, inside
    /// the primitive's own box ([`Primitive::bounds`]).
    pub bounds: Record,
}

impl Reference {
    /// What fills room.
    pub(crate) const NONE: Reference =
        Reference { primitive: 0, bounds: Record { least: UVec4::ZERO, greatest: UVec4::ZERO } };
}

/// References to all primitives of a scene, from left to right in the tree whose planes split them. Builds start from the
/// tree. What a ray meets does not depend on the parts.
#[derive(Clone, Debug, PartialEq)]
pub struct References {
    pub(crate) list: Vec<Reference>,
    /// None where there is one reference.
    pub(crate) pairs: Vec<Children>,
}

impl References {
    /// All of them; those of one primitive may be anywhere.
    pub fn list(&self) -> &[Reference] {
        &self.list
    }
}

/// Makes references to the primitives of the normalised scene, splitting those whose boxes would overlap others
/// needlessly. `budget` is how many references there may be beyond one a primitive, as a share of the
/// primitives; 0 splits none.
///
/// The same primitives give the same references, whatever the number of rayon's threads. The own boxes of
/// a primitive's references cover it with padding everywhere.
///
/// # Errors
///
/// [`BuildError::NoPrimitives`], [`BuildError::TooManyPrimitives`], and [`BuildError::Coordinate`] if
/// a vertex is not finite and in [-1, 1].
pub fn split(primitives: &[Primitive], budget: f32) -> Result<References, BuildError> {
    let count = check_count(primitives.len())?;
    check_coordinates(primitives)?;
    // NaN is converted to 0.
    let room = (f64::from(budget) * f64::from(count)) as usize;
    Ok(spatial::references(primitives, room))
}

/// Neither areas nor clipping can handle NaN.
pub(crate) fn check_coordinates(primitives: &[Primitive]) -> Result<(), BuildError> {
    let normalised = |p: &Primitive| {
        if p.is_triangle() {
            return p.vertices().into_iter().all(|v| v.abs().cmple(Vec3::ONE).all());
        }
        let Bounds { min, max } = Bounds::of(p);
        (p.radius() > 0.0 || p.is_instance()) && (0..3).all(|i| -MOST <= min[i] && max[i] <= MOST)
    };
    match position(primitives, |p| !normalised(p)) {
        Some(place) => Err(BuildError::Coordinate { primitive: primitives[place].number() }),
        None => Ok(()),
    }
}
