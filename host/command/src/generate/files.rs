//! The files of a generated scene.

use std::ffi::OsStr;
use std::io::{self, Write};
use std::iter;
use std::path::{Path, PathBuf};

use super::{COMMAND, fault};
use crate::error::{Error, Result};
use crate::output::{self, Destination};

/// Where a generated scene goes: a mesh, and beside it its materials and a scene of the same name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Files {
    mesh: PathBuf,
    materials: PathBuf,
    scene: PathBuf,
    names: [String; 2],
}

type Fill<'f> = &'f dyn Fn(&mut dyn Write) -> io::Result<()>;

impl Files {
    /// The files of a mesh at `mesh`.
    ///
    /// # Errors
    /// A name that is no `.obj`, or that the other files could not hold.
    pub fn beside(mesh: &Path) -> Result<Self> {
        if mesh == Path::new("-") {
            return Err(Error::new("-o - can't be: a scene is three files; name an .obj file"));
        }
        if !mesh.extension().is_some_and(|e| e.eq_ignore_ascii_case("obj")) {
            return Err(Error::file(mesh, "the mesh is a Wavefront file: give -o a name that ends in .obj"));
        }
        let (materials, scene) = (mesh.with_extension("mtl"), mesh.with_extension("toml"));
        let names = [plain_name(mesh)?, plain_name(&materials)?];
        Ok(Files { mesh: mesh.to_owned(), materials, scene, names })
    }

    /// The mesh, its materials, and the scene.
    pub fn paths(&self) -> [&Path; 3] {
        [&self.mesh, &self.materials, &self.scene]
    }

    pub(super) fn mesh_name(&self) -> &str {
        &self.names[0]
    }

    pub(super) fn materials_name(&self) -> &str {
        &self.names[1]
    }

    /// Fails where [`Files::write`] would, without changing a file. What a person made is not replaced.
    pub(super) fn check_writable(&self) -> Result<()> {
        check_all(&self.paths())
    }

    /// Writes all three under temporary names and renames them once the mesh, by far the largest, is whole.
    pub(super) fn write(&self, mesh: Fill, materials: Fill, scene: Fill) -> Result<()> {
        output::write_atomically(&self.scene, |out| {
            filled(scene, out)?;
            output::write_atomically(&self.materials, |out| {
                filled(materials, out)?;
                output::write_atomically(&self.mesh, |out| filled(mesh, out))
            })
        })
    }
}

/// Where a scene of spheres or of plants goes: the scene, and beside it a file of the same name of what it shows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pair {
    scene: PathBuf,
    list: PathBuf,
    list_name: String,
}

impl Pair {
    /// The files of a scene of spheres or of a list of them at `path`.
    ///
    /// # Errors
    /// A name that is neither `.toml` nor `.xyzr`, or that the scene could not hold.
    pub fn beside(path: &Path) -> Result<Self> {
        Pair::of("xyzr", path)
    }

    /// The files of a scene or of what it shows, which ends in `ending`, at `path`.
    ///
    /// # Errors
    /// A name that ends otherwise, or that the scene could not hold.
    pub fn of(ending: &str, path: &Path) -> Result<Self> {
        if path == Path::new("-") {
            return Err(Error::new("-o - can't be: the scene is two files; name a .toml file"));
        }
        let is = |end: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(end));
        let (scene, list) = match (is("toml"), is(ending)) {
            (true, _) => (path.to_owned(), path.with_extension(ending)),
            (_, true) => (path.with_extension("toml"), path.to_owned()),
            _ => return Err(Error::file(path, "this makes a scene: give -o a name that ends in .toml")),
        };
        let list_name = plain_name(&list)?;
        Ok(Pair { scene, list, list_name })
    }

    /// The scene and the list.
    pub fn paths(&self) -> [&Path; 2] {
        [&self.scene, &self.list]
    }

    pub(super) fn list_name(&self) -> &str {
        &self.list_name
    }

    /// As [`Files::check_writable`].
    pub(super) fn check_writable(&self) -> Result<()> {
        check_all(&self.paths())
    }

    /// Writes both under temporary names and renames them once the list, by far the larger, is whole.
    pub(super) fn write(&self, list: Fill, scene: Fill) -> Result<()> {
        output::write_atomically(&self.scene, |out| {
            filled(scene, out)?;
            output::write_atomically(&self.list, |out| filled(list, out))
        })
    }
}

/// Fails where one of the files could not be written, or is not our own, without changing any.
fn check_all(paths: &[&Path]) -> Result<()> {
    let files: Vec<_> = paths.iter().map(|path| Destination::File(path.to_path_buf())).collect();
    output::check_apart(&files, iter::empty::<&Path>())?;
    for (path, file) in paths.iter().zip(&files) {
        output::check_writable(file)?;
        output::check_own(path, COMMAND, "-o")?;
    }
    Ok(())
}

/// The name of a file as another file holds it.
fn plain_name(path: &Path) -> Result<String> {
    let name = path.file_name().and_then(OsStr::to_str).filter(|name| is_plain(name));
    let fault = "the scene file could not hold this name: give -o one of plain characters";
    name.map(str::to_owned).ok_or_else(|| Error::file(path, fault))
}

/// Flushes too, so that a full disk is met before any file is renamed.
fn filled(fill: Fill, out: &mut dyn Write) -> Result<()> {
    fill(out).and_then(|()| out.flush()).map_err(fault)
}

/// Whether both a Wavefront and a TOML file hold this name as it is.
fn is_plain(name: &str) -> bool {
    !name.starts_with(char::is_whitespace) && !name.contains(|c: char| c.is_control() || matches!(c, '\\' | ':'))
}
