//! Reading binary scenes.

use std::path::Path;

use bytemuck::Pod;
use memmap2::Mmap;
use rayon::prelude::*;

use super::{description::Description, header::Header};
use crate::error::{Error, Result};
use crate::scene::{Mesh, Scene, Unplaced, budget::Budget, file};

/// Loads a scene.
///
/// # Errors
/// A file that cannot be read, is not of this form, or is damaged; one that holds what no scene may, whatever its hash.
pub fn load(path: &Path, budget: Budget) -> Result<Scene> {
    let scene = || {
        let file = file::open(path, u64::MAX)?;
        // SAFETY: the mapping is read-only and ends with this function. Another process that changed the file meanwhile
        // would change what is read, and all of that is copied before it is checked.
        let bytes = unsafe { Mmap::map(&file) }.map_err(|error| file::explain(&error))?;
        parse(&bytes, budget)
    };
    scene().map_err(|fault: String| Error::file(path, fault))
}

/// The scene in these bytes.
pub fn parse(bytes: &[u8], budget: Budget) -> Unplaced<Scene> {
    let (header, sections) = Header::split(bytes)?;
    header.check(&sections)?;
    let counts = header.counts;
    budget.check(counts.triangles as usize, counts.positions as usize)?;
    budget.check_round(counts.spheres as usize + counts.disks as usize)?;
    let [description, positions, normals, triangles, materials, spheres, disks] = sections;
    let mesh = Mesh {
        positions: list(positions),
        normals: list(normals),
        triangles: list(triangles),
        materials: list(materials),
    };
    let scene = Description::parse(description)?.scene(mesh, list(spheres), list(disks));
    if scene.cameras.is_empty() {
        return Err("it has no camera".into());
    }
    scene.check().map_err(|error| error.message())?;
    Ok(scene)
}

/// A section's records.
fn list<T: Pod + Send>(bytes: &[u8]) -> Vec<T> {
    bytes.par_chunks_exact(size_of::<T>()).map(bytemuck::pod_read_unaligned).collect()
}
