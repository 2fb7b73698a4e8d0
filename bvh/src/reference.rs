//! What a hierarchy is built over.

use eyerays_shader::data::{Bounds as Record, Triangle};

use crate::{
    BuildError,
    bounds::Bounds,
    build::check_count,
    spatial::{self, Tree},
};

/// A triangle, or a part of one.
///
/// A ray may enter and leave a part's box before it hits the triangle in another part. So the box bounds the
/// distance of a hit from below, which keeps culling exact, but not from above: a distance clamped to its end
/// would be too short (measured: 5 of 1000 rays in Conference). The triangle's own box bounds it from above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// The triangle's index.
    pub triangle: u32,
    /// The own box: the part and [`BOX_PADDING`](eyerays_shader::data::BOX_PADDING) around it, inside
    /// the triangle's own box ([`Triangle::bounds`]).
    pub bounds: Record,
}

/// References to all triangles of a scene. They are made once, so that every quality of hierarchy is
/// built over the same, and no builder can change what a ray meets.
#[derive(Clone, Debug, PartialEq)]
pub struct References {
    /// The references; those of one triangle may be anywhere.
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

/// Makes references to the triangles of the normalised scene, splitting those whose boxes would overlap others
/// needlessly. `budget` is how many references there may be beyond one a triangle, as a share of the
/// triangles; 0 splits none.
///
/// The same triangles give the same references, whatever the number of rayon's threads. The own boxes of
/// a triangle's references cover it with padding everywhere.
///
/// # Errors
///
/// [`BuildError::NoTriangles`], [`BuildError::TooManyTriangles`], and [`BuildError::Coordinate`] if
/// a vertex is not finite and in [-1, 1].
pub fn split(triangles: &[Triangle], budget: f32) -> Result<References, BuildError> {
    let count = check_count(triangles.len())?;
    check_coordinates(triangles)?;
    // NaN is converted to 0.
    let room = (f64::from(budget) * f64::from(count)) as usize;
    if room > 0 {
        return Ok(spatial::references(triangles, room));
    }
    let whole = |(triangle, number)| Reference { triangle: number, bounds: Bounds::of(triangle).write() };
    let list: Vec<Reference> = triangles.iter().zip(0..).map(whole).collect();
    Ok(list.into())
}

/// Neither areas nor clipping can handle NaN.
fn check_coordinates(triangles: &[Triangle]) -> Result<(), BuildError> {
    let normalised = |t: &Triangle| {
        let coordinates = t.vertices().map(|v| v.to_array());
        coordinates.as_flattened().iter().all(|c| c.abs() <= 1.0)
    };
    match triangles.iter().find(|t| !normalised(t)) {
        Some(t) => Err(BuildError::Coordinate { primitive: t.primitive() }),
        None => Ok(()),
    }
}
