//! What a pixel shows as text.

use std::fmt::{self, Display, Formatter};

use glam::Vec3;

use super::{Pick, Surface};
use crate::line::{printable, seven_digits};

/// A primitive, by its place in its mesh.
impl Display for Surface {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        let Surface { kind, within, object, .. } = self;
        write!(out, "{kind} {within}")?;
        object.as_ref().map_or(Ok(()), |object| write!(out, " of \"{}\"", printable(&object.name)))
    }
}

/// A line for each thing that is told.
impl Display for Pick {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        let Surface { primitive, kind, object, material, .. } = &self.surface;
        writeln!(out, "sees {}, material {} \"{}\"", self.surface, material.number, printable(&material.name))?;
        if let Some(object) = object {
            writeln!(out, "  mesh      {} \"{}\"", object.number, printable(&object.name))?;
        }
        writeln!(
            out,
            "  {kind:<9} {primitive} of the scene, at u {:.6}, v {:.6}",
            self.coordinates.0, self.coordinates.1
        )?;
        if let Some(shared) = self.surface.shared {
            writeln!(
                out,
                "  copy      {} of shared mesh {}, its triangle {}",
                shared.copy, shared.mesh, shared.triangle
            )?;
        }
        writeln!(out, "  distance  {}", seven_digits(self.distance))?;
        writeln!(out, "  position  {}", vector(self.position))?;
        let side = if self.is_front { "front" } else { "back" };
        writeln!(
            out,
            "  normal    {}, shaded by {}; seen from the {side}",
            vector(self.normal),
            vector(self.shading_normal)
        )?;
        writeln!(out, "  error     {}: rays that leave start so far off the surface", seven_digits(self.error))
    }
}

fn vector(v: Vec3) -> String {
    v.to_array().map(|c| seven_digits(c.into())).join(", ")
}
