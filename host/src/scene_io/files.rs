//! The files that the `[[mesh]]` tables of a scene name.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use super::budget::Budget;
use super::curves::{self, Listed};
use super::gltf::{self, Gltf};
use super::load::Loading;
use super::map::Images;
use super::obj::{self, Obj};
use super::object_table::Objects;
use super::ply::{self, Ply};
use super::table::Table;
use super::{Warning, WarningKind};
use super::{file, mesh_table, xyzr};
use crate::error::Result;
use crate::scene::subdivide::Eye;
use crate::scene::{Animation, Sphere};

/// What a scene file has of which its meshes may have others.
#[derive(Default, Clone, Copy)]
pub struct Own {
    pub lights: bool,
    pub cameras: bool,
}

/// Files already read, since a scene may place one many times, and what is left of the memory for others.
pub struct Files<'p> {
    folder: &'p Path,
    /// What is left for the geometry that is not placed yet.
    pub budget: Budget,
    /// The pictures of all.
    pub images: Images,
    /// Do materials of the scene file cover meshes with textures?
    pub is_covered: bool,
    /// Do they ask for tangents?
    pub has_axes: bool,
    /// Has the scene file lights of its own, and cameras?
    pub has: Own,
    meshes: HashMap<PathBuf, Obj>,
    spheres: HashMap<PathBuf, Vec<Sphere>>,
    /// With the bits of the radius that they were read with.
    strands: HashMap<(PathBuf, Option<u32>), Listed>,
    /// What was ignored in them.
    pub warnings: Vec<Warning>,
    /// Every file that was read, material files too.
    pub paths: Vec<PathBuf>,
    /// How they may move.
    pub animations: Vec<Animation>,
    /// When the last key of the scene file itself is, if it has any.
    last_key: Option<f32>,
    /// The cameras of the scene file, as edges of surfaces are measured by them.
    pub eyes: Vec<Eye>,
    /// What meshes may stand on.
    pub objects: Objects,
    /// What several tables are of, if it is placed.
    pub repeated: HashSet<String>,
}

impl<'p> Files<'p> {
    /// The files that a scene in `folder` names, all within the budget.
    pub fn new(folder: &'p Path, budget: Budget, loading: Loading) -> Self {
        Files {
            folder,
            budget,
            images: Images::within(folder, budget, loading),
            is_covered: false,
            has_axes: false,
            has: Own::default(),
            eyes: Vec::new(),
            objects: Objects::default(),
            meshes: HashMap::new(),
            spheres: HashMap::new(),
            strands: HashMap::new(),
            warnings: Vec::new(),
            paths: Vec::new(),
            animations: Vec::new(),
            last_key: None,
            repeated: HashSet::new(),
        }
    }

    /// Remembers the last key of a table, if it has keys.
    pub fn move_until(&mut self, last: Option<f32>) {
        self.last_key = last.into_iter().chain(self.last_key).reduce(f32::max);
    }

    /// How all of the scene may move: by its own keys, and as its files say.
    pub fn take_animations(&mut self) -> Vec<Animation> {
        let own = self.last_key.map(|last| Animation { name: "keys".into(), seconds: last.into() });
        own.into_iter().chain(std::mem::take(&mut self.animations)).collect()
    }

    /// Where the file of a table's key `file` lies.
    ///
    /// # Errors
    /// There is no file that can be read.
    pub fn place(&self, table: &Table, name: &str) -> Result<PathBuf> {
        let path = self.folder.join(name);
        // What is wrong with the name is the scene's fault, what is in the file is the file's.
        file::open(&path, file::MOST_MESH)
            .map_err(|fault| table.fault_of("file", format!("{}: {fault}", path.display())))?;
        Ok(path)
    }

    /// A mesh.
    ///
    /// # Errors
    /// Those of [`read_mesh`].
    pub fn mesh(&mut self, path: &Path) -> Result<&Obj> {
        if !self.meshes.contains_key(path) {
            let mut obj = match is_gltf(path) {
                true => {
                    let gltf = gltf::load(path, self.budget, self.images.loading.clone())?;
                    self.animations.extend(gltf.animations.iter().cloned());
                    meshes_of(path, gltf, self.has)
                }
                false => read_mesh(path, self.budget, &mut self.images, self.is_covered)?,
            };
            self.warnings.append(&mut obj.warnings);
            self.paths.push(path.to_owned());
            self.paths.append(&mut obj.libraries);
            self.meshes.insert(path.to_owned(), obj);
        }
        Ok(&self.meshes[path])
    }

    /// Spheres.
    ///
    /// # Errors
    /// Those of [`xyzr::load`].
    pub fn spheres(&mut self, path: &Path) -> Result<&[Sphere]> {
        if !self.spheres.contains_key(path) {
            let spheres = xyzr::load(path, self.budget)?;
            self.paths.push(path.to_owned());
            self.spheres.insert(path.to_owned(), spheres);
        }
        Ok(&self.spheres[path])
    }

    /// Strands, whose radius is this one where the file has none, or of a `.hair` file wherever.
    ///
    /// # Errors
    /// Those of [`curves::load`].
    pub fn strands(&mut self, path: &Path, radius: Option<f32>) -> Result<&Listed> {
        let key = (path.to_owned(), radius.map(f32::to_bits));
        if !self.strands.contains_key(&key) {
            let mut listed = curves::load(path, radius, self.budget)?;
            self.warnings.extend(listed.warning.take());
            self.paths.push(path.to_owned());
            self.strands.insert(key.clone(), listed);
        }
        Ok(&self.strands[&key])
    }
}

/// Reads a Wavefront mesh or, by its ending, a PLY mesh, whose material is the default, white beneath colours of vertices; the other
/// arguments are those of [`obj::load`].
///
/// # Errors
/// Those of [`obj::load`] and [`ply::load`].
pub fn read_mesh(path: &Path, budget: Budget, images: &mut Images, is_covered: bool) -> Result<Obj> {
    if !is(path, "ply") {
        return obj::load(path, budget, images, is_covered);
    }
    let Ply { mesh, faces, warnings } = ply::load(path, budget)?;
    let materials = if mesh.colours.is_empty() { mesh_table::plain() } else { mesh_table::white() };
    Ok(Obj { mesh, faces, materials, warnings, ..Obj::default() })
}

/// The meshes of a scene, with a warning of what else it has and the scene file has not.
fn meshes_of(path: &Path, scene: Gltf, own: Own) -> Obj {
    let Gltf { mut obj, lights, cameras, .. } = scene;
    let what = match (!lights.is_empty() && !own.lights, !cameras.is_empty() && !own.cameras) {
        (true, true) => "lights and cameras",
        (true, false) => "lights",
        (false, true) => "cameras",
        (false, false) => return obj,
    };
    let why = "a mesh brings none into a scene file: \"eyerays convert\" writes one that has them";
    obj.warnings.push(Warning::new(WarningKind::LeftOut, path, format!("its {what} are left out, {why}")));
    obj
}

/// Is it a glTF file by its ending, of JSON or binary?
pub fn is_gltf(path: &Path) -> bool {
    is(path, "gltf") || is(path, "glb")
}

/// Does the path end like this, in capitals or not?
pub fn is(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|end| end.eq_ignore_ascii_case(extension))
}
