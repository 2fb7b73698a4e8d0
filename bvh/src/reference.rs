//! What a hierarchy is built over.

use eyerays_shader::data::{Bounds as Record, Triangle};

use crate::{BuildError, bounds::Bounds, build::check_count};

/// A triangle, or a part of one, and the box that a hit of it must lie in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// The triangle's index.
    pub triangle: u32,
    /// The own box: what lies in the part, and at least [`BOX_PADDING`](eyerays_shader::data::BOX_PADDING)
    /// around it.
    pub bounds: Record,
}

/// Refers to triangles of the normalised scene.
///
/// # Errors
///
/// [`BuildError::NoTriangles`], [`BuildError::TooManyTriangles`], and [`BuildError::Coordinate`] if
/// a vertex is not finite and in [-1, 1].
pub fn split(triangles: &[Triangle], _budget: f32) -> Result<Vec<Reference>, BuildError> {
    check_count(triangles.len())?;
    check_coordinates(triangles)?;
    let whole = |(triangle, number)| Reference { triangle: number, bounds: Bounds::of(triangle).write() };
    Ok(triangles.iter().zip(0..).map(whole).collect())
}

/// Neither areas nor clipping may meet a NaN.
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
