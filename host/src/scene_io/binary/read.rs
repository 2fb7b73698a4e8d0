//! Reading binary scenes.

use std::path::Path;

use super::description::{Description, Geometry};
use super::header::{AGAIN, Header};
use crate::error::{Error, Result};
use crate::scene::hierarchy::records;
use crate::scene::{Hierarchy, Mesh, Scene, Unplaced};
use crate::scene_io::{budget::Budget, file};

/// Loads a scene.
///
/// # Errors
/// A file that cannot be read, is not of this form, or is damaged; one that holds what no scene may, whatever its hash.
pub fn load(path: &Path, budget: Budget) -> Result<Scene> {
    let scene = bytes(path).and_then(|bytes| parse(&bytes, budget));
    scene.map_err(|fault| Error::file(path, fault))
}

/// The bytes of a file that begins as it should: a large one of another kind is not read.
fn bytes(path: &Path) -> Unplaced<Vec<u8>> {
    let mut file = file::open(path, u64::MAX)?;
    let start = file.start(size_of::<Header>())?;
    Header::of_start(&start, file.length())?;
    file.whole_after(start)
}

/// The scene in these bytes.
pub fn parse(bytes: &[u8], budget: Budget) -> Unplaced<Scene> {
    let (header, sections) = Header::read(bytes)?;
    let all = sections.map(|section| &bytes[section]);
    header.check(&all)?;
    let counts = header.counts;
    budget.check_textures(counts.texels)?;
    // Sections are copied.
    let primitives = counts.triangles.saturating_add(counts.spheres).saturating_add(counts.disks);
    budget.check_packed(primitives as usize, 2 * bytes.len() as u64)?;
    let [description, positions, normals, first, second, tangents, colours, rest @ ..] = all;
    let [triangles, materials, spheres, disks, instances, poses, texels, ..] = rest;
    let mesh = Mesh {
        positions: records(positions),
        normals: records(normals),
        triangles: records(triangles),
        materials: records(materials),
        coordinates: [records(first), records(second)],
        tangents: records(tangents),
        colours: records(colours),
    };
    let again = |fault| format!("{fault}; {AGAIN}");
    let description = Description::parse(description, &budget)?;
    let [.., pairs, order, bounds] = all;
    let kept = description.hierarchy.map(|quality| Hierarchy::new(quality, [pairs, order, bounds]));
    let (spheres, disks, instances) = (records(spheres), records(disks), records(instances));
    let scene = description.scene(Geometry { mesh, spheres, disks, instances }, poses, texels).map_err(again)?;
    let scene = Scene { hierarchy: kept, ..scene };
    if scene.cameras.is_empty() {
        return Err(again("it has no camera".into()));
    }
    let checked = scene.check().and_then(|()| scene.settings.check());
    checked.map_err(|error| format!("{}; {MENDED}", error.message()))?;
    Ok(scene)
}

/// The remedy for what no scene may be: this form is not for changing.
const MENDED: &str = "mend it in the scene that this was made of, and write it again with eyerays convert";
