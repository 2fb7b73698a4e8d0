//! Scenes in glTF 2.0, as JSON with files beside it or as one binary file.
//!
//! Files come from strangers. Their JSON is read into lists of bounded size, all counts are checked before anything is
//! allocated for them, and no index is followed unchecked.

mod accessor;
mod animation;
mod buffer;
mod camera;
mod component;
mod container;
mod document;
mod extension;
mod instance;
mod light;
mod material;
mod mesh;
mod morph;
mod node;
mod notes;
mod picture;
mod pointer;
mod primitive;
mod shading;
mod skin;
mod uri;
mod vertices;
mod whole;

use std::collections::{BTreeMap, HashSet};
use std::path::{Path, PathBuf};

use serde::Deserialize;

use self::accessor::Accessors;
use self::animation::Pose;
use self::buffer::Buffers;
use self::camera::Cameras;
use self::document::{Asset, Document};
use self::mesh::Merge;
use self::node::Placed;
use self::notes::Notes;
use self::picture::Pictures;
use self::skin::Skins;
use super::budget::Budget;
use super::copies::Copies;
use super::material::{DEFAULT, Fields};
use super::neighbours::Neighbours;
use super::obj::Obj;
use super::{Instant, LightUnit, Loading, file};
use crate::error::{Error, Result};
use crate::scene::{Animation, Camera, Light, LightGroups, Mesh, Object, Unplaced};

/// A scene but for its surroundings.
#[derive(Debug)]
pub struct Gltf {
    /// All meshes as one in world units, the materials that its triangles index (the first is the default), what each
    /// node has of the mesh, what was ignored, and every other file that was read.
    pub obj: Obj,
    /// In the order of nodes.
    pub lights: Vec<Light>,
    /// Likewise, each with a name of its own.
    pub cameras: Vec<Camera>,
    /// In the order of the file.
    pub animations: Vec<Animation>,
    /// Width over height of the picture of the first camera, if it says so.
    pub aspect: Option<f64>,
}

/// Reads a `.gltf` or `.glb` file and those that it names, which lie in its folder or below, as it is at a moment.
/// Its lights are in `unit`, or else in that of what wrote the file.
///
/// # Errors
/// A file that cannot be read, is no glTF 2.0, requires an extension that is not read, names what does not exist, holds no
/// triangle, or more than the budget has room for: each says where in the JSON.
pub fn load(path: &Path, budget: Budget, loading: Loading) -> Result<Gltf> {
    let read = || {
        let mut file = file::open(path, file::MOST_MESH)?;
        let length = file.length();
        let start = file.start(container::START)?;
        container::check(&start, length)?;
        file.whole_after(start)
    };
    let bytes = read().map_err(|fault: String| Error::file(path, fault))?;
    parse(path, &bytes, budget, loading)
}

/// The scene of the bytes of a file.
pub(super) fn parse(path: &Path, bytes: &[u8], budget: Budget, loading: Loading) -> Result<Gltf> {
    read(path, bytes, budget, loading).map_err(|fault| Error::file(path, fault))
}

fn read(path: &Path, bytes: &[u8], budget: Budget, loading: Loading) -> Unplaced<Gltf> {
    let neighbours = &Neighbours::new(path, loading.allow_outside);
    let unit = loading.light_unit;
    let container = container::open(bytes)?;
    let json = bytes.get(container.json).unwrap_or_default();
    budget.check_bytes(document::memory(json)).map_err(|why| format!("its JSON would {why}; split the file"))?;
    let document = document(json)?;
    let chunk = container.chunk.and_then(|range| bytes.get(range));
    let mut notes = Notes::new(path);
    extension::check(&document, &mut notes)?;
    let buffers = Buffers::read(&document, chunk, neighbours)?;
    let pose = Pose::of(&document, &Accessors::new(&document, &buffers), &loading.moment, &mut notes)?;
    let changed = match &pose.settings[..] {
        [] => None,
        settings => Some(self::document(&pointer::patched(json, settings, &budget)?)?),
    };
    let document = changed.as_ref().unwrap_or(&document);
    let nodes = node::walk(document, &pose)?;
    let is_alone = loading.instant == Instant::Alone;
    let (mesh, copies, objects) = merged((document, &buffers), &nodes, budget, is_alone, &mut notes)?;
    let by_writer = LightUnit::of_generator(document.asset.generator.as_deref());
    let mut lights = Vec::new();
    let mut cameras = Cameras::default();
    for placed in &nodes {
        lights.extend(light::read(placed, &document.extensions.lights.lights, unit.unwrap_or(by_writer), &mut notes)?);
        cameras.add(placed, document, &mut notes)?;
    }
    let groups: HashSet<&str> = lights.iter().map(Light::group).filter(|name| !name.is_empty()).collect();
    if groups.len() > LightGroups::MOST {
        let text = format!("its lights are in no groups, as {} are more than {}", groups.len(), LightGroups::MOST);
        notes.left_out("groups", &text);
        lights = lights.into_iter().map(|light| light.in_group("")).collect();
    }
    if unit.is_none() && by_writer == LightUnit::Blender && !lights.is_empty() {
        notes.changed(
            "unit",
            "its lights are divided by 683, which Blender's exporter multiplies them with by default; \
             --light-unit gltf takes them as they are",
        );
    }
    let is_drawn = loading.instant != Instant::Later;
    let (materials, pictures) = materials((document, &buffers), (&mesh, &copies), neighbours, is_drawn, &mut notes)?;
    let libraries = buffers.paths.iter().cloned().chain(pictures).collect();
    let obj = Obj { mesh, copies, materials, warnings: notes.finish(), libraries, objects, ..Obj::default() };
    let animations = animation::list(document, &Accessors::new(document, &buffers));
    Ok(Gltf { obj, lights, aspect: cameras.aspect, cameras: cameras.all, animations })
}

fn document(json: &[u8]) -> Unplaced<Document> {
    let json = document::text(json);
    if json.trim_ascii_start().first().is_some_and(|&byte| byte != b'{') {
        return Err("the JSON: it does not begin with {; write the file again as glTF 2.0".into());
    }
    let json = whole::without_points(json);
    let mut from = serde_json::Deserializer::from_slice(&json);
    let document: Document = serde_path_to_error::deserialize(&mut from).map_err(|error| {
        // What makes no sense may do so in another version.
        let asset = serde_json::from_slice::<Versioned>(&json).map(|document| document.asset).unwrap_or_default();
        if let Err(fault) = check_version(&asset) {
            return fault;
        }
        let (path, fault) = (error.path().to_string(), error.inner());
        let owner = if path == "." { "the JSON".into() } else { path };
        format!("{owner}: {}; write the file again as glTF 2.0", plain(fault))
    })?;
    from.end().map_err(|fault| format!("the JSON: {fault}; write the file again as glTF 2.0"))?;
    check_version(&document.asset)?;
    Ok(document)
}

/// What any version of a file has.
#[derive(Deserialize)]
struct Versioned {
    asset: Asset,
}

fn check_version(asset: &Asset) -> Unplaced<()> {
    if let Some(version) = asset.min_version.as_deref().filter(|version| !matches!(*version, "2" | "2.0")) {
        return Err(format!("asset.minVersion: this needs a reader of glTF {version}; convert it to 2.0"));
    }
    match asset.version.as_deref() {
        None | Some("2") => Ok(()),
        Some(version) if version.starts_with("2.") => Ok(()),
        Some(version) => Err(format!("asset.version: this is glTF {version}; convert it to 2.0")),
    }
}

/// What a parser found, without what it wanted: the names of types in this program.
fn plain(fault: &serde_json::Error) -> String {
    let text = fault.to_string();
    let Some((found, _)) = text.split_once(", expected ") else { return text };
    let found = found.trim_start_matches("invalid type: ").trim_start_matches("invalid value: ").replace('`', "");
    let words = [
        ("floating point ", ""),
        ("integer ", ""),
        ("boolean ", ""),
        ("map", "a table"),
        ("sequence", "a list"),
        ("invalid length ", "a list of length "),
    ];
    let found = words.into_iter().fold(found, |found, (theirs, ours)| match found.strip_prefix(theirs) {
        Some(rest) => format!("{ours}{rest}"),
        None => found,
    });
    format!("{found} makes no sense here (line {}, column {})", fault.line(), fault.column())
}

/// All meshes where nodes have them. Unless it is alone, those of nodes that move are held once, whoever else has them.
fn merged(
    (document, buffers): (&Document, &Buffers),
    nodes: &[Placed],
    budget: Budget,
    is_alone: bool,
    notes: &mut Notes,
) -> Unplaced<(Mesh, Copies, Vec<Object>)> {
    // A mesh has another shape at each node that has weights of its own.
    let mut by_mesh: BTreeMap<(usize, Option<usize>), Vec<&Placed>> = BTreeMap::new();
    for placed in nodes {
        if let Some(mesh) = placed.node.mesh {
            let own = placed.weights.map(|_| placed.number);
            by_mesh.entry((mesh, own)).or_default().push(placed);
        }
    }
    let skins = Skins::new(document, nodes);
    let mut merge = Merge::new(document, Accessors::new(document, buffers), skins, budget);
    for ((mesh, _), nodes) in by_mesh {
        let is_kept = !is_alone && nodes.iter().any(|placed| placed.moves);
        merge.add(mesh, (&nodes, is_kept), notes)?;
    }
    let (mesh, copies, objects) = merge.finish();
    if mesh.triangles.is_empty() && copies.places.is_empty() {
        return Err(nothing(document));
    }
    Ok((mesh, copies, objects))
}

/// Why nothing is drawn, and what to do.
fn nothing(document: &Document) -> String {
    let shown = document.scene.unwrap_or(0);
    let others =
        document.scenes.iter().enumerate().filter(|&(number, scene)| number != shown && !scene.nodes.is_empty());
    let Some((other, _)) = others.into_iter().next() else {
        return "there is no triangle in its scene; does a node of it have a mesh?".into();
    };
    let count = document.scenes.len();
    let why = match document.scene {
        Some(number) => format!("scene: it asks for scenes[{number}], which holds no triangle"),
        None => {
            format!("scene: it is not given, and the first of {count} scenes, which is shown then, holds no triangle")
        }
    };
    format!("{why}; write \"scene\": {other} into the JSON to see another")
}

/// All materials under the numbers that triangles have, read if any has it, and the files of their pictures.
type Materials = (Vec<(String, Fields)>, Vec<PathBuf>);

fn materials(
    (document, buffers): (&Document, &Buffers),
    (mesh, copies): (&Mesh, &Copies),
    neighbours: &Neighbours,
    is_drawn: bool,
    notes: &mut Notes,
) -> Unplaced<Materials> {
    let mut pictures = Pictures::new(document, buffers, neighbours);
    let mut is_used = vec![false; document.materials.len() + 1];
    for &material in copies.meshes.iter().chain([mesh]).flat_map(|mesh| &mesh.materials) {
        if let Some(is_used) = is_used.get_mut(material as usize) {
            *is_used = true;
        }
    }
    let mut materials = vec![(DEFAULT.to_owned(), material::plain())];
    for ((number, of), is_used) in document.materials.iter().enumerate().zip(is_used.into_iter().skip(1)) {
        let fields =
            if is_used && is_drawn { material::read(of, number, &mut pictures, notes)? } else { material::plain() };
        let name =
            of.name.clone().filter(|name| !name.trim().is_empty()).unwrap_or_else(|| format!("material {number}"));
        materials.push((name, fields));
    }
    if let Some(warning) = pictures.warning() {
        notes.missing("pictures", &warning);
    }
    Ok((materials, pictures.paths))
}
