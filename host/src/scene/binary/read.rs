//! Reading binary scenes.

use std::path::Path;

use bytemuck::Pod;
use rayon::prelude::*;

use super::description::Description;
use super::header::Header;
use super::hierarchy::Hierarchy;
use crate::error::{Error, Result};
use crate::scene::{Mesh, Scene, Unplaced, budget::Budget, file};

/// Loads a scene.
///
/// # Errors
/// A file that cannot be read, is not of this form, or is damaged; one that holds what no scene may, whatever its hash.
pub fn load(path: &Path, budget: Budget) -> Result<Scene> {
    let scene = file::read(path, u64::MAX).and_then(|bytes| parse(&bytes, budget));
    scene.map_err(|fault| Error::file(path, fault))
}

/// The scene in these bytes.
pub fn parse(bytes: &[u8], budget: Budget) -> Unplaced<Scene> {
    let (header, sections) = Header::read(bytes)?;
    let all = sections.map(|section| &bytes[section]);
    header.check(&all)?;
    let counts = header.counts;
    budget.check(counts.triangles as usize, counts.positions as usize)?;
    budget.check_round(counts.spheres as usize + counts.disks as usize)?;
    budget.check_textures(counts.texels)?;
    let [description, positions, normals, first, second, tangents, colours, rest @ ..] = all;
    let [triangles, materials, spheres, disks, texels, ..] = rest;
    let mesh = Mesh {
        positions: list(positions),
        normals: list(normals),
        triangles: list(triangles),
        materials: list(materials),
        coordinates: [list(first), list(second)],
        tangents: list(tangents),
        colours: list(colours),
    };
    let description = Description::parse(description, &budget)?;
    let [.., pairs, order, bounds] = all;
    let kept = description.hierarchy.map(|quality| Hierarchy::new(quality, [pairs, order, bounds]));
    let scene = description.scene(mesh, list(spheres), list(disks), texels)?;
    let scene = Scene { hierarchy: kept, ..scene };
    if scene.cameras.is_empty() {
        return Err("it has no camera".into());
    }
    scene.check().map_err(|error| error.message())?;
    Ok(scene)
}

/// A section's records.
pub fn list<T: Pod + Send>(bytes: &[u8]) -> Vec<T> {
    bytes.par_chunks_exact(size_of::<T>()).map(bytemuck::pod_read_unaligned).collect()
}
