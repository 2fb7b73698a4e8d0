//! Writing binary scenes.

use std::io::Write;

use super::description::Description;
use super::header::{ALIGNMENT, Counts, Header};
use crate::error::{Error, Result};
use crate::scene::Scene;

/// Writes the binary form of a scene, from which [`load`](crate::scene::load) makes the same scene, but for
/// [`Scene::files`], which it stands for itself.
///
/// # Errors
/// What [`Scene::check`] refuses, and what keeps `out` from being written.
pub fn write(scene: &Scene, out: &mut dyn Write) -> Result<()> {
    scene.check()?;
    let description = Description::of(scene).text().map_err(Error::new)?;
    let mesh = &scene.mesh;
    let counts = Counts {
        description: description.len() as u64,
        positions: mesh.positions.len() as u64,
        normals: mesh.normals.len() as u64,
        triangles: mesh.triangles.len() as u64,
        spheres: scene.spheres.len() as u64,
        disks: scene.disks.len() as u64,
    };
    let sections = [
        description.as_bytes(),
        bytemuck::cast_slice(&mesh.positions),
        bytemuck::cast_slice(&mesh.normals),
        bytemuck::cast_slice(&mesh.triangles),
        bytemuck::cast_slice(&mesh.materials),
        bytemuck::cast_slice(&scene.spheres),
        bytemuck::cast_slice(&scene.disks),
    ];
    let mut end = 0;
    let header = Header::of(counts, &sections);
    for section in [bytemuck::bytes_of(&header)].into_iter().chain(sections) {
        let start = usize::next_multiple_of(end, ALIGNMENT);
        let written = out.write_all(&[0; ALIGNMENT][..start - end]).and_then(|()| out.write_all(section));
        written.map_err(|error| Error::writing(&error))?;
        end = start + section.len();
    }
    Ok(())
}
