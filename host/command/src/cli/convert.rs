//! `eyerays convert`.

use std::ffi::OsString;
use std::iter;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::slice;

use clap::Args;

use super::choice::choice;
use super::reading::{Read, Reading};
use super::{console, plural, progress};
use crate::error::{Error, Result, printable};
use crate::output::{self, Destination};
use eyerays::device_scene;
use eyerays::quality::Bvh;
use eyerays::scene::Scene;
use eyerays::scene_io;

pub(super) const EXAMPLES: &str = "\
Examples:
  eyerays convert hall.toml hall.eyerays
  eyerays convert hall.toml hall.eyerays --bvh high
  eyerays render hall.eyerays --camera view1 -o hall.png
  eyerays convert model.glb scene.toml
A binary file holds all that the scene's files say and a hierarchy, and renders to the same picture without them.
It needs neither to be parsed nor, with a hierarchy of its quality, to be built; its hash is checked each time.
A scene file takes its surfaces and textures from the mesh that it names, and holds the rest for you to change.
An .eyerays file of the name is replaced; a .toml file is not, since it may hold changes of yours.";

#[derive(Args)]
pub(super) struct Convert {
    /// The scene: .toml, .gltf, .glb, .obj, .ply or .eyerays
    scene: PathBuf,
    /// The file to write: .eyerays, or .toml of a .gltf, .glb, .obj or .ply
    #[arg(value_name = "FILE", required_unless_present = "output")]
    file: Option<OsString>,
    /// The file to write, instead of FILE
    #[arg(short, long, value_name = "FILE", conflicts_with = "file")]
    output: Option<OsString>,
    /// Quality of the hierarchy that an .eyerays file holds; renderings of another quality build their own [default: medium]
    #[arg(long, value_name = "QUALITY", value_parser = choice::<Bvh>())]
    bvh: Option<Bvh>,
    /// Leave the hierarchy out: a third of the bytes, built again by each command
    #[arg(long, conflicts_with = "bvh")]
    no_bvh: bool,
    #[command(flatten)]
    reading: Reading,
}

impl Convert {
    pub fn run(&self, quiet: bool) -> Result<ExitCode> {
        let path = Path::new(self.file.as_ref().or(self.output.as_ref()).expect("one is required"));
        let is = |ending: &str| path.extension().is_some_and(|end| end.eq_ignore_ascii_case(ending));
        let is_text = is("toml");
        if !is_text && !is(scene_io::ENDING) {
            let ending = scene_io::ENDING;
            return Err(Error::file(path, format!("the ending chooses the form; end the name in .{ending} or .toml")));
        }
        if is_text {
            self.check_text()?;
        }
        let destination = Destination::File(path.to_owned());
        output::check_writable(&destination)?;
        let loading = if is_text { self.reading.moment()? } else { self.reading.loading(None) };
        let Read { scene, .. } = Read::scene(&self.scene, slice::from_ref(&destination), loading, quiet)?;
        output::check_apart(slice::from_ref(&destination), [&self.scene])?;
        if is_text {
            check_new(path)?;
            self.write_text(&scene, path)?;
        } else {
            self.write_binary(&scene, path, quiet)?;
        }
        if !quiet {
            let bytes = std::fs::metadata(path).map_or(0, |file| file.len());
            console::say(format_args!(
                "{}: {}, {bytes} bytes",
                path.display(),
                plural(scene.primitives() as usize, "primitive")
            ));
        }
        Ok(ExitCode::SUCCESS)
    }

    fn write_binary(&self, scene: &Scene, path: &Path, quiet: bool) -> Result<()> {
        let quality = self.bvh.unwrap_or_default();
        let build = || device_scene::hierarchy(scene, quality.quality()).map_err(|e| e.of(&self.scene));
        // That of instances is of several parts, which the form has no place for.
        let has_none = self.no_bvh || !scene.instances.is_empty();
        let bvh = if has_none { None } else { Some(progress::stage("building", quiet, build)?) };
        let hierarchy = bvh.as_ref().map(|bvh| (quality, bvh));
        let write = || output::write_atomically(path, |out| Ok(scene_io::write(scene, hierarchy, out)?));
        progress::stage("writing", quiet, write)
    }

    /// Refuses what a scene file can't be made of.
    fn check_text(&self) -> Result<()> {
        let is_mesh = ["gltf", "glb", "obj", "ply"]
            .iter()
            .any(|ending| self.scene.extension().is_some_and(|end| end.eq_ignore_ascii_case(ending)));
        if !is_mesh {
            let fault = "a scene file takes its surfaces from a .gltf, .glb, .obj or .ply; name one, or end the output in .eyerays";
            return Err(Error::file(&self.scene, fault));
        }
        if self.no_bvh || self.bvh.is_some() {
            return Err(Error::new(
                "--bvh and --no-bvh are of .eyerays files; leave them out, or end the output in .eyerays",
            ));
        }
        Ok(())
    }

    fn write_text(&self, scene: &Scene, path: &Path) -> Result<()> {
        let mesh = from_folder(&self.scene, path)?;
        let name = self.scene.file_name().unwrap_or_default().to_string_lossy();
        let text = format!(
            "# Made by eyerays convert: surfaces and textures are in {}.\n\n{}",
            printable(&name),
            scene_io::describe(scene, &mesh)
        );
        output::write_atomically(path, |out| {
            out.write_all(text.as_bytes()).map_err(|error| output::write_error(&error))
        })
    }
}

/// Refuses to replace a scene file: somebody may have changed it.
fn check_new(path: &Path) -> Result<()> {
    if path.is_file() {
        let fault = "is there already, perhaps with changes of yours; move it, or name another file";
        return Err(Error::file(path, fault));
    }
    Ok(())
}

/// The name of a mesh as a scene file at `path` calls it, from its folder.
fn from_folder(mesh: &Path, path: &Path) -> Result<String> {
    let whole =
        |path: &Path| path.canonicalize().map_err(|error| Error::file(path, format!("it cannot be found: {error}")));
    let folder = match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let (mesh, folder) = (whole(mesh)?, whole(folder)?);
    let shared = mesh.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    // Another drive shares nothing.
    let up = if shared == 0 { 0 } else { folder.components().count() - shared };
    let name: PathBuf = iter::repeat_n("..".as_ref(), up).chain(mesh.iter().skip(shared)).collect();
    let fault = "a scene file is UTF-8 text, and this name is not; rename it";
    name.to_str().map(str::to_owned).ok_or_else(|| Error::file(&name, fault))
}
