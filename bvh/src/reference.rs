//! What a hierarchy is built over.

use eyerays_shader::data::{Bounds as Record, Primitive};
use rayon::prelude::*;

use crate::{
    BuildError,
    bounds::Bounds,
    build::{MOST, check_count},
    spatial::{self, Tree},
};

/// A primitive, or a part of one.
///
/// A ray may enter and leave a part's box before it hits the primitive in another part. So the box bounds the
/// distance of a hit from below, which keeps culling exact, but not from above: a distance clamped to its end
/// would be too short (measured: 5 of 1000 rays in Conference). The primitive's own box bounds it from above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// The primitive's index.
    pub primitive: u32,
    /// The own box: the part and [`BOX_PADDING`](eyerays_shader::data::BOX_PADDING) around it, inside
    /// the primitive's own box ([`Primitive::bounds`]).
    pub bounds: Record,
}

/// References to all primitives of a scene. They are made once, so that every quality of hierarchy is
/// built over the same, and no builder can change what a ray meets.
#[derive(Clone, Debug, PartialEq)]
pub struct References {
    /// The references; those of one primitive may be anywhere.
    pub list: Vec<Reference>,
    /// The tree whose planes split them, if any did. Builds start from it.
    pub(crate) tree: Option<Tree>,
}

impl From<Vec<Reference>> for References {
    /// References that were made elsewhere.
    fn from(list: Vec<Reference>) -> Self {
        References { list, tree: None }
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
    if room > 0 {
        return Ok(spatial::references(primitives, room));
    }
    let whole = |(primitive, number)| Reference { primitive: number, bounds: Bounds::of(primitive).write() };
    let list: Vec<Reference> = primitives.iter().zip(0..).map(whole).collect();
    Ok(list.into())
}

/// Neither areas nor clipping can handle NaN.
pub(crate) fn check_coordinates(primitives: &[Primitive]) -> Result<(), BuildError> {
    let normalised = |p: &Primitive| {
        if p.is_triangle() {
            let coordinates = p.vertices().map(|v| v.to_array());
            return coordinates.as_flattened().iter().all(|c| c.abs() <= 1.0);
        }
        let Bounds { min, max } = Bounds::of(p);
        p.radius() > 0.0 && (0..3).all(|i| -MOST <= min[i] && max[i] <= MOST)
    };
    match primitives.par_iter().find_first(|p| !normalised(p)) {
        Some(p) => Err(BuildError::Coordinate { primitive: p.number() }),
        None => Ok(()),
    }
}
