//! From a path to a scene.

use std::path::Path;

use glam::Vec3;

use super::budget::Budget;
use super::document;
use super::file;
use super::frame;
use super::material::Fields;
use super::merge::{Merge, Override, Overrides};
use super::obj;
use super::part::{self, Files, Placed, is};
use super::range::Range;
use super::source::Source;
use super::table::Table;
use super::{Background, Camera, Mesh, Scene, Settings};
use crate::error::{Error, Result};
use crate::memory::Room;

/// Loads a TOML scene or a bare Wavefront mesh, and says in warnings what of it is not drawn.
///
/// A bare mesh is seen from three quarters in front and above, lit by two lights under a pale sky.
///
/// # Errors
/// A path that is no readable `.toml` or `.obj` file, or anything in it that makes no sense: each is one line
/// that names file, line and remedy.
pub fn load(path: &Path) -> Result<(Scene, Vec<String>)> {
    load_within(path, Budget::new(Room::now()))
}

/// As [`load`], of a scene within the budget.
pub(super) fn load_within(path: &Path, budget: Budget) -> Result<(Scene, Vec<String>)> {
    file::open(path, file::MOST_MESH).map_err(|fault| Error::file(path, fault))?;
    if is(path, "toml") {
        load_toml(path, budget)
    } else if is(path, "obj") {
        load_obj(path, budget)
    } else {
        let fault = "unknown kind of scene; name a .toml scene or an .obj mesh";
        Err(Error::file(path, fault))
    }
}

fn load_obj(path: &Path, budget: Budget) -> Result<(Scene, Vec<String>)> {
    let obj = obj::load(path, budget)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let placed = Placed { name, mesh: obj.mesh, materials: obj.materials, material: None };
    let mut merge = Merge::default();
    merge.add(placed, &Overrides::new()).map_err(|fault| Error::file(path, fault))?;
    let (mesh, parts, materials) = merge.finish();
    let settings = Settings::default();
    let scene = Scene {
        cameras: framing(path, &mesh, &settings)?,
        mesh,
        parts,
        files: obj.libraries,
        materials,
        lights: frame::lights(),
        background: frame::background(),
        ambient: Vec3::splat(0.2),
        settings,
    };
    Ok((scene, obj.warnings))
}

fn framing(path: &Path, mesh: &Mesh, settings: &Settings) -> Result<Vec<Camera>> {
    let (width, height) = settings.size;
    match frame::default_camera(mesh, f64::from(width) / f64::from(height)) {
        Some(camera) => Ok(vec![camera]),
        None => {
            let fault = "the mesh is too large to be seen whole; make it smaller or add a [[camera]]";
            Err(Error::file(path, fault))
        }
    }
}

fn load_toml(path: &Path, budget: Budget) -> Result<(Scene, Vec<String>)> {
    let bytes = file::read(path, file::MOST_TEXT).map_err(|fault| Error::file(path, fault))?;
    parse(path, &bytes, budget)
}

/// Makes something of the tables of a TOML file.
///
/// # Errors
/// No readable TOML file, and those of `make`.
pub fn read_table<T>(path: &Path, make: impl FnOnce(Table) -> Result<T>) -> Result<T> {
    let bytes = file::read(path, file::MOST_TEXT).map_err(|fault| Error::file(path, fault))?;
    make(Source::new(path, text(path, &bytes)?).parse()?)
}

fn text<'b>(path: &Path, bytes: &'b [u8]) -> Result<&'b str> {
    std::str::from_utf8(bytes).map_err(|error| {
        let good = &bytes[..error.valid_up_to()];
        let line = 1 + good.iter().filter(|&&byte| byte == b'\n').count();
        Error::line(path, line, "this is not UTF-8 text; save the file as UTF-8")
    })
}

/// The scene of a TOML text, whose meshes are relative to the folder of `path`.
pub(super) fn parse(path: &Path, bytes: &[u8], budget: Budget) -> Result<(Scene, Vec<String>)> {
    let mut table = Source::new(path, text(path, bytes)?).parse()?;
    let settings = table.table("render")?.map(document::settings);
    let settings = settings.transpose()?.unwrap_or_default();
    let background = table.table("background")?.map(document::background);
    let background = background.transpose()?;
    let ambient = table.triple("ambient", Range::AMOUNT)?;
    let cameras = document::cameras(table.tables("camera")?.unwrap_or_default())?;
    let lights = table.tables("light")?.map(document::lights).transpose()?;
    let overrides = overrides(table.tables("material")?.unwrap_or_default())?;
    let meshes = table.tables("mesh")?.unwrap_or_default();
    // A section's misspelt name is a likelier fault than a missing section.
    table.done()?;
    if meshes.is_empty() {
        let fault = "there is no [[mesh]]; add one with a file or a shape";
        return Err(Error::file(path, fault));
    }
    let mut files = Files::new(file::folder(path), budget);
    let (mesh, parts, materials) = merge(meshes, &overrides, &mut files)?.finish();
    let mut warnings = files.warnings;
    warnings.extend(overrides.values().filter_map(Override::warning));
    let cameras = match cameras.is_empty() {
        true => framing(path, &mesh, &settings)?,
        false => cameras,
    };
    let scene = Scene {
        mesh,
        parts,
        files: files.paths,
        materials,
        lights: lights.unwrap_or_else(frame::lights),
        cameras,
        background: background.unwrap_or(Background::Colour(Vec3::ZERO)),
        ambient: ambient.unwrap_or(Vec3::ZERO),
        settings,
    };
    Ok((scene, warnings))
}

fn overrides(tables: Vec<Table>) -> Result<Overrides> {
    let mut overrides = Overrides::new();
    for mut table in tables {
        let (name, fields) = Fields::read(&mut table)?;
        let idle = format!("no surface has the material {name:?}");
        let idle = table.fault_of("name", idle).to_string();
        if overrides.contains_key(&name) {
            let fault = format!("a second material {name:?}; rename one");
            return Err(table.fault_of("name", fault));
        }
        table.done()?;
        overrides.insert(name, Override::new(fields, idle));
    }
    Ok(overrides)
}

fn merge(tables: Vec<Table>, overrides: &Overrides, files: &mut Files) -> Result<Merge> {
    let mut merge = Merge::default();
    for mut table in tables {
        let placed = part::read(&mut table, files)?;
        let key = if placed.material.is_some() { "material" } else { "file" };
        let fault = merge.add(placed, overrides).err();
        if let Some(fault) = fault {
            return Err(table.fault_of(key, fault));
        }
        table.done()?;
    }
    Ok(merge)
}
