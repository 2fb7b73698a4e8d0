//! The scene file beside a mesh.

use std::io::{self, Write};

use super::model::Model;

/// Writes a scene of the mesh file `mesh`, whose name holds no control character.
pub fn write_scene(model: &Model, mesh: &str, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "ambient = {:?}\n\n[render]\nsize = [1024, 1024]\nbounces = 6", model.ambient)?;
    if let Some([horizon, zenith]) = model.sky {
        writeln!(out, "\n[background]\nhorizon = {horizon:?}\nzenith = {zenith:?}")?;
    }
    for (i, view) in model.views.iter().enumerate() {
        let (eye, target) = (view.eye.to_array(), view.target.to_array());
        writeln!(
            out,
            "\n[[camera]]\nname = \"view{}\"\neye = {eye:?}\ntarget = {target:?}\nfov = {:?}",
            i + 1,
            view.fov
        )?;
    }
    for light in &model.lights {
        let (position, colour) = (light.position.to_array(), light.colour);
        writeln!(out, "\n[[light]]\nkind = \"point\"\nposition = {position:?}\ncolor = {colour:?}")?;
    }
    if let Some((name, colour, size)) = model.checker {
        writeln!(out, "\n[[material]]\nname = \"{name}\"\nchecker = {{ color = {colour:?}, size = {size:?} }}")?;
    }
    writeln!(out, "\n[[mesh]]\nfile = \"{}\"", mesh.replace('"', "\\\""))
}
