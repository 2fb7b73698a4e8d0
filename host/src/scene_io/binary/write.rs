//! Writing binary scenes.

use std::io::Write;

use eyerays_bvh::Bvh;

use super::description::Description;
use super::grids::Grids;
use super::header::{ALIGNMENT, Counts, Header, SECTIONS, hash};
use super::motion;
use super::textures::{Pictures, bytes};
use crate::error::{Error, Result};
use crate::quality;
use crate::scene::Scene;

/// Writes the binary form of a scene, from which [`load`](crate::scene_io::load) makes the same scene, but for
/// [`Scene::files`], which it stands for itself, and with this hierarchy of it
/// ([`hierarchy`](crate::device_scene::hierarchy)) instead of [`Scene::hierarchy`].
///
/// # Errors
/// What [`Scene::check`] refuses, settings out of range, and what keeps `out` from being written.
pub fn write(scene: &Scene, hierarchy: Option<(quality::Bvh, &Bvh)>, out: &mut dyn Write) -> Result<()> {
    scene.check()?;
    scene.settings.check()?;
    let (pictures, textures) = Pictures::of(scene);
    let (grids, leaves) = Grids::of(scene);
    let texels = textures.iter().map(|texture| bytes(texture));
    let texels = [&leaves[..]].into_iter().chain(texels).collect::<Vec<_>>().concat();
    let description = Description::of(scene, (grids, pictures), hierarchy.map(|(quality, _)| quality));
    let description = description.text().map_err(Error::new)?;
    let none = Bvh { nodes: Vec::new(), wide: Vec::new(), order: Vec::new(), bounds: Vec::new() };
    let poses = motion::bytes(scene.motion.as_ref());
    let (counts, sections) = sections(scene, (&description, &poses, &texels), hierarchy.map_or(&none, |(_, bvh)| bvh));
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

/// A hash of all that a picture of a scene shows, by whichever camera and settings: of its binary form without those and without a
/// hierarchy. Equal scenes have equal hashes on every machine, wherever they came from.
///
/// # Errors
/// What [`Scene::check`] refuses.
pub fn fingerprint(scene: &Scene) -> Result<[u8; 32]> {
    scene.check()?;
    let (pictures, textures) = Pictures::of(scene);
    let (grids, leaves) = Grids::of(scene);
    let description = Description::bare(scene, (grids, pictures)).text().map_err(Error::new)?;
    let none = Bvh { nodes: Vec::new(), wide: Vec::new(), order: Vec::new(), bounds: Vec::new() };
    let poses = motion::bytes(scene.motion.as_ref());
    let (counts, sections) = sections(scene, (&description, &poses, &[]), &none);
    let textures = textures.iter().map(|texture| bytes(texture));
    let leaves = [&leaves[..]].into_iter().filter(|leaves| !leaves.is_empty());
    Ok(hash(&counts, sections.into_iter().chain(leaves).chain(textures)))
}

/// What a file holds after its header, and how much of it there is.
fn sections<'a>(
    scene: &'a Scene,
    (description, poses, texels): (&'a str, &'a [u8], &'a [u8]),
    bvh: &'a Bvh,
) -> (Counts, [&'a [u8]; SECTIONS]) {
    let mesh = &scene.mesh;
    let counts = Counts {
        description: description.len() as u64,
        positions: mesh.positions.len() as u64,
        normals: mesh.normals.len() as u64,
        coordinates: mesh.coordinates.each_ref().map(|coordinates| coordinates.len() as u64),
        tangents: mesh.tangents.len() as u64,
        colours: mesh.colours.len() as u64,
        triangles: mesh.triangles.len() as u64,
        spheres: scene.spheres.len() as u64,
        disks: scene.disks.len() as u64,
        instances: scene.instances.len() as u64,
        poses: poses.len() as u64,
        texels: texels.len() as u64,
        pairs: bvh.nodes.len() as u64,
        slots: bvh.order.len() as u64,
    };
    let sections = [
        description.as_bytes(),
        bytemuck::cast_slice(&mesh.positions),
        bytemuck::cast_slice(&mesh.normals),
        bytemuck::cast_slice(&mesh.coordinates[0]),
        bytemuck::cast_slice(&mesh.coordinates[1]),
        bytemuck::cast_slice(&mesh.tangents),
        bytemuck::cast_slice(&mesh.colours),
        bytemuck::cast_slice(&mesh.triangles),
        bytemuck::cast_slice(&mesh.materials),
        bytemuck::cast_slice(&scene.spheres),
        bytemuck::cast_slice(&scene.disks),
        bytemuck::cast_slice(&scene.instances),
        poses,
        texels,
        bytemuck::cast_slice(&bvh.nodes),
        bytemuck::cast_slice(&bvh.order),
        bytemuck::cast_slice(&bvh.bounds),
    ];
    (counts, sections)
}
