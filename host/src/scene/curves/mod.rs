//! Curves: strands of control points, which become tubes or ribbons of triangles.

mod basis;
mod frame;
mod outline;
mod ribbon;
mod stations;
mod strands;
#[cfg(test)]
mod tests;
mod tube;

use std::ops::RangeInclusive;

use glam::Vec3;

pub use self::basis::Basis;
use self::outline::Outline;
pub use self::strands::{ControlPoint, Strand, Strands};
use super::Mesh;
use crate::choice::choices;

choices! {
    /// What becomes of a strand.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum CurveKind {
        /// A tube, closed at both ends
        #[default]
        Round = "round",
        /// A flat ribbon, twice as wide as the radius
        Ribbon = "ribbon",
    }
}

/// How strands become triangles.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Curves {
    /// What curve the control points are of.
    pub basis: Basis,
    /// What becomes of it.
    pub kind: CurveKind,
    /// How far triangles may be from the surface that they stand for, in the units of the points, above 0. Without one a tenth of the
    /// greatest radius of each strand.
    pub tolerance: Option<f32>,
    /// How many corners the section of a tube has, in [`Curves::SIDES`]. Without it an even number, as the tolerance asks for.
    pub sides: Option<u32>,
    /// Where the front of a ribbon faces where its strand says nothing, of any length. Without one it turns no more than the curve does.
    pub up: Option<Vec3>,
    /// Have vertices texture coordinates? The first is the share of the strand's length, the second that of the way around a tube, or
    /// across a ribbon from left to right.
    pub has_coordinates: bool,
    /// Have vertices tangents, along the strand?
    pub has_tangents: bool,
}

impl Curves {
    /// How many corners the section of a tube may have.
    pub const SIDES: RangeInclusive<u32> = 3..=256;

    fn tolerance_of(&self, strand: &Strand) -> f64 {
        self.tolerance.map_or(strand.greatest_radius() / 10.0, f64::from)
    }

    fn outline<'s>(&'s self, strand: &Strand<'s>) -> Outline<'s> {
        Outline::of(self, *strand)
    }

    /// Counts the triangles and vertices that strands will have at most, and gives both to `fits` as they grow, before there is room for them.
    ///
    /// # Errors
    /// That of `fits`, which ends the counting.
    pub fn count<E>(&self, strands: &Strands, mut fits: impl FnMut(usize, usize) -> Result<(), E>) -> Result<(), E> {
        let (mut triangles, mut vertices) = (0, 0);
        for strand in strands.iter() {
            let outline = self.outline(&strand);
            let (of_ends, of_station) = (outline.ends_size(), outline.station_size());
            (triangles, vertices) = (triangles + of_ends.0, vertices + of_ends.1);
            stations::each(&strand, self.basis, self.tolerance_of(&strand), |_| {
                (triangles, vertices) = (triangles + of_station.0, vertices + of_station.1);
                fits(triangles, vertices)
            })?;
        }
        Ok(())
    }

    /// The strands as triangles of the material 0. One that has a [fault](Strand::fault) may be left out.
    pub fn mesh(&self, strands: &Strands) -> Mesh {
        let mut mesh = Mesh::default();
        let mut stations = Vec::new();
        for strand in strands.iter() {
            stations.clear();
            let taken = stations::each(&strand, self.basis, self.tolerance_of(&strand), |station| {
                stations.push(station);
                Ok::<_, std::convert::Infallible>(())
            });
            taken.unwrap_or_else(|never| match never {});
            if stations.len() > 1 {
                self.outline(&strand).add(&mut mesh, &stations);
            }
        }
        mesh.materials = vec![0; mesh.triangles.len()];
        mesh
    }
}
