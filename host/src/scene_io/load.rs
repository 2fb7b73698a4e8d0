//! From a path to a scene.

use std::collections::HashMap;
use std::io::Read;
use std::path::Path;

use glam::Vec3;

use super::binary;
use super::budget::Budget;
use super::bump;
use super::copies::Instancing;
use super::document::Surroundings;
use super::file;
use super::files::{Files, Own, is, is_gltf, read_mesh};
use super::geometry::Geometry;
use super::gltf::{self, Gltf};
use super::light_table;
use super::lit;
use super::map::Images;
use super::material::Fields;
use super::merge::{Merge, Merged, Override, Overrides};
use super::mesh_table::{self, Placed};
use super::obj::Obj;
use super::object_table::Objects;
use super::shutter;
use super::source::Source;
use super::table::Table;
use super::{Instant, LightUnit, Moment, Shutter};
use super::{Warning, WarningKind};
use super::{camera_table, document, medium};
use crate::error::{Error, Result};
use crate::memory::Room;
use crate::scene::Range;
use crate::scene::frame;
use crate::scene::studio;
use crate::scene::subdivide::Eye;
use crate::scene::{Background, Integrator, Sampler, Scene, Settings, Transport, Visibility};

/// Loads a TOML scene, a glTF scene, a bare Wavefront or PLY mesh, or a binary scene ([`write`](super::write)), and says in
/// warnings what of it is not drawn.
///
/// A bare mesh is seen from three quarters in front and above, lit by two lights under a pale sky. A glTF scene is drawn by
/// paths, from its own cameras and by its own lights; without them it is seen as a mesh is, in a studio of three lamps.
///
/// # Errors
/// A path that is no readable `.toml`, `.gltf`, `.glb`, `.obj`, `.ply` or `.eyerays` file, or anything in it that makes no sense: each is one line
/// that names file, line and remedy.
pub fn load(path: &Path) -> Result<(Scene, Vec<Warning>)> {
    load_as(path, Loading::default())
}

/// How a scene is read.
#[derive(Debug, Clone, Default)]
pub struct Loading {
    /// May models name material files, pictures and buffers outside their folders? Those of strangers should not.
    pub allow_outside: bool,
    /// In what unit the intensities of a glTF scene's lights are. Without one they are in what its writer is known to use: candela
    /// and lux, or Blender's, of which a warning tells.
    pub light_unit: Option<LightUnit>,
    /// Which integrator will draw it, if that is known: under paths the light `Ke` of MTL files shines.
    pub integrator: Option<Integrator>,
    /// When a glTF file is looked at that moves.
    pub moment: Moment,
    /// When the shutter is open; without one as the scene says, or for no time.
    pub shutter: Option<Shutter>,
    /// What of the scene is read.
    pub instant: Instant,
    /// Are meshes that stand in several places held once?
    pub instancing: Instancing,
}

/// As [`load`], in this way.
///
/// # Errors
/// Those of [`load`].
pub fn load_as(path: &Path, loading: Loading) -> Result<(Scene, Vec<Warning>)> {
    load_within(path, Budget::new(Room::now()), loading)
}

/// As [`load_as`], of a TOML scene that comes from no file, such as standard input. Errors call it `name`, and the files that it
/// names are relative to the folder of that.
///
/// # Errors
/// Those of [`load_as`].
pub fn read_as(stream: impl Read, name: &Path, loading: Loading) -> Result<(Scene, Vec<Warning>)> {
    let bytes = file::read_stream(stream, file::MOST_TEXT).map_err(|fault| Error::file(name, fault))?;
    parse(name, &bytes, Budget::new(Room::now()), loading)
}

/// As [`load_as`], of a scene within the budget.
pub(super) fn load_within(path: &Path, budget: Budget, loading: Loading) -> Result<(Scene, Vec<Warning>)> {
    file::open(path, u64::MAX).map_err(|fault| Error::file(path, fault))?;
    if is(path, binary::ENDING) {
        let scene = binary::load(path, budget)?;
        let (scene, warnings) = shutter::kept(path, scene, loading.shutter)?;
        Ok((settled(path, scene, budget, &loading)?, warnings))
    } else if is(path, "toml") {
        load_toml(path, budget, loading)
    } else if is(path, "obj") || is(path, "ply") {
        load_mesh(path, budget, loading)
    } else if is_gltf(path) {
        let open = loading.shutter;
        shutter::over(path, budget, (loading, open), |loading| load_gltf(path, budget, loading))
    } else if is(path, "gz") {
        Err(Error::file(path, "it is compressed; unpack it (gunzip) and name what comes out"))
    } else {
        let fault = "unknown kind of scene; name a .toml, .gltf, .glb or .eyerays scene or an .obj or .ply mesh";
        Err(Error::file(path, fault))
    }
}

fn load_mesh(path: &Path, budget: Budget, loading: Loading) -> Result<(Scene, Vec<Warning>)> {
    let mut images = Images::within(file::folder(path), budget, loading.clone());
    let (mut scene, warnings) = bare(path, read_mesh(path, budget, &mut images, false)?, budget, &loading)?;
    scene.files.extend(images.paths());
    if scene.materials.iter().any(|material| material.emission != Vec3::ZERO) {
        // Whitted's model draws nothing that shines, and paths no ambient light.
        (scene.settings, scene.ambient) = (of_paths(), Vec3::ZERO);
    }
    Ok((framed(path, scene, loading.instant)?, warnings))
}

/// What the camera sees behind a glTF scene without light, which the studio lights: a bright grey of 80 %.
const BACKDROP: Vec3 = Vec3::splat(0.6);

fn load_gltf(path: &Path, budget: Budget, loading: Loading) -> Result<(Scene, Vec<Warning>)> {
    let Gltf { obj, lights, cameras, aspect, animations } = gltf::load(path, budget, loading.clone())?;
    let (scene, warnings) = bare(path, obj, budget, &loading)?;
    let is_lit = lit::is_lit(&scene, &lights);
    let background = Background::Colour(if is_lit { Vec3::ZERO } else { BACKDROP });
    let environment = (!is_lit).then(studio::environment);
    let mut settings = of_paths();
    settings.size = aspect.map_or(settings.size, frame::size);
    let scene = Scene { lights, cameras, background, environment, ambient: Vec3::ZERO, settings, animations, ..scene };
    Ok((framed(path, scene, loading.instant)?, warnings))
}

/// Enough samples of paths to look at a model.
fn of_paths() -> Settings {
    Settings {
        spp: 64,
        sampler: Sampler::Sobol,
        bounces: 6,
        transport: Transport { integrator: Integrator::Path, ..Transport::default() },
        ..Settings::default()
    }
}

/// A scene of one mesh without a camera, and the warnings of it.
fn bare(path: &Path, obj: Obj, budget: Budget, loading: &Loading) -> Result<(Scene, Vec<Warning>)> {
    let Obj { mesh, copies, materials, mut warnings, libraries, objects, .. } = obj;
    let name = match &*objects {
        [only] => only.name.clone(),
        _ => path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
    };
    let (geometry, visibility) = (Geometry::Mesh(mesh), Visibility::default());
    let placed =
        Placed { name, geometry, copies, repeated: None, materials, material: None, objects, visibility, lit_by: None };
    let mut merge = Merge::default();
    merge.add(placed, &Overrides::new()).map_err(|fault| Error::file(path, fault))?;
    let Merged { mesh, spheres, disks, shared, instances, objects, materials, bumps } = merge.finish();
    let mut scene = Scene {
        mesh,
        spheres,
        disks,
        shared,
        instances,
        objects,
        animations: Vec::new(),
        files: libraries,
        materials,
        lights: frame::lights(),
        cameras: Vec::new(),
        background: frame::background(),
        environment: None,
        background_group: String::new(),
        ambient: Vec3::splat(0.2),
        settings: Settings::default(),
        motion: None,
        hierarchy: None,
        fog: None,
    };
    warnings.extend(bump::settle(&mut scene, bumps));
    Ok((settled(path, scene, budget, loading)?, warnings))
}

/// A scene with the bounds of its copies, which are held as is asked unless more is to come of it.
fn settled(path: &Path, mut scene: Scene, budget: Budget, loading: &Loading) -> Result<Scene> {
    scene.measure_copies();
    // What moves is settled already.
    if loading.instant != Instant::Alone || scene.motion.is_some() {
        return Ok(scene);
    }
    loading.instancing.of(scene, &budget).map_err(|fault| Error::file(path, fault))
}

/// Gives a scene without a camera one that sees all of it, as it is first.
fn framed(path: &Path, mut scene: Scene, instant: Instant) -> Result<Scene> {
    if scene.cameras.is_empty() && instant != Instant::Later {
        let (width, height) = scene.settings.size;
        let camera = frame::default_camera(&scene, f64::from(width) / f64::from(height));
        let fault = "the scene is too large to be seen whole; make it smaller or add a [[camera]]";
        scene.cameras.push(camera.ok_or_else(|| Error::file(path, fault))?);
    }
    Ok(scene)
}

fn load_toml(path: &Path, budget: Budget, loading: Loading) -> Result<(Scene, Vec<Warning>)> {
    let bytes = file::read(path, file::MOST_TEXT).map_err(|fault| Error::file(path, fault))?;
    parse(path, &bytes, budget, loading)
}

/// Makes something of the tables of a TOML file.
///
/// # Errors
/// No readable TOML file, and those of `make`.
pub fn read_table<T>(path: &Path, make: impl FnOnce(Table) -> Result<T>) -> Result<T> {
    let bytes = file::read(path, file::MOST_TEXT).map_err(|fault| Error::file(path, fault))?;
    make(Source::new(path, text(path, &bytes)?).parse(&Budget::new(Room::now()))?)
}

fn text<'b>(path: &Path, bytes: &'b [u8]) -> Result<&'b str> {
    std::str::from_utf8(bytes).map_err(|error| {
        let good = &bytes[..error.valid_up_to()];
        let line = 1 + good.iter().filter(|&&byte| byte == b'\n').count();
        Error::line(path, line, "this is not UTF-8 text; save the file as UTF-8")
    })
}

/// The scene of a TOML text, whose meshes are relative to the folder of `path`.
pub(super) fn parse(path: &Path, bytes: &[u8], budget: Budget, loading: Loading) -> Result<(Scene, Vec<Warning>)> {
    let mut table = Source::new(path, text(path, bytes)?).parse(&budget)?;
    let own = table.table("shutter")?.map(shutter::read).transpose()?;
    let open = loading.shutter.or(own);
    shutter::over(path, budget, (loading, open), |loading| parse_once(path, bytes, budget, loading))
}

fn parse_once(path: &Path, bytes: &[u8], budget: Budget, loading: Loading) -> Result<(Scene, Vec<Warning>)> {
    let mut table = Source::new(path, text(path, bytes)?).parse(&budget)?;
    table.table("shutter")?.map(shutter::read).transpose()?;
    let settings = table.table("render")?.map(|table| document::settings(table, Settings::default()));
    let settings = settings.transpose()?.unwrap_or_default();
    let holding = loading.clone();
    let integrator = Some(loading.integrator.unwrap_or(settings.transport.integrator));
    let mut files = Files::new(file::folder(path), budget, Loading { integrator, ..loading });
    files.has = Own { lights: table.has("light"), cameras: table.has("camera") };
    let background = table.table("background")?.map(|table| document::background(table, &mut files.images));
    let Surroundings { background, environment, group } = background.transpose()?.unwrap_or_default();
    let ambient = table.triple("ambient", Range::AMOUNT)?;
    let fog = table.table("fog")?.map(medium::fog).transpose()?;
    let seconds = holding.moment.seconds.unwrap_or(0.0);
    let (cameras, last) = camera_table::cameras(table.tables("camera")?.unwrap_or_default(), seconds)?;
    files.move_until(last);
    files.eyes = cameras.iter().map(|camera| Eye::of(camera, settings.size)).collect();
    let lights = table.tables("light")?.map(|tables| light_table::lights(tables, seconds)).transpose()?;
    let (lights, last) = lights.map_or((None, None), |(lights, last)| (Some(lights), last));
    files.move_until(last);
    let overrides = overrides(table.tables("material")?.unwrap_or_default(), &mut files.images)?;
    files.objects = Objects::read(table.tables("object")?.unwrap_or_default(), seconds, &files.budget)?;
    let meshes = table.tables("mesh")?.unwrap_or_default();
    // A section's misspelt name is a likelier fault than a missing section.
    table.done()?;
    if meshes.is_empty() {
        let fault = "there is no [[mesh]]; add one with a file or a shape";
        return Err(Error::file(path, fault));
    }
    files.is_covered = overrides.values().any(Override::has_maps) || meshes.iter().any(|mesh| mesh.has("displace"));
    files.has_axes = overrides.values().any(Override::has_axes);
    let Merged { mesh, spheres, disks, shared, instances, objects, materials, bumps } =
        merge(meshes, &overrides, &mut files)?.finish();
    let animations = files.take_animations();
    let mut warnings = files.warnings;
    warnings.extend(overrides.values().filter_map(Override::warning));
    let names_lights = lights.is_some();
    let mut scene = Scene {
        mesh,
        spheres,
        disks,
        shared,
        instances,
        objects,
        animations,
        files: files.paths.into_iter().chain(files.images.paths()).collect(),
        materials,
        lights: lights.unwrap_or_else(frame::lights),
        cameras,
        background,
        environment,
        background_group: group,
        ambient: ambient.unwrap_or(Vec3::ZERO),
        settings,
        motion: None,
        hierarchy: None,
        fog,
    };
    warnings.extend(bump::settle(&mut scene, bumps));
    let mut scene = settled(path, scene, budget, &holding)?;
    if !names_lights {
        frame::without_spare_lamps(&mut scene, settings.transport.integrator);
    }
    for material in &scene.materials {
        let idle = material.physical.and_then(|physical| physical.idle(&material.maps)).or(material.idle_volume());
        let said = idle.map(|idle| format!("material {:?}: {idle}", material.name));
        warnings.extend(said.map(|said| Warning::new(WarningKind::Idle, path, said)));
    }
    Ok((framed(path, scene, holding.instant)?, warnings))
}

fn overrides(tables: Vec<Table>, images: &mut Images) -> Result<Overrides> {
    let mut overrides = Overrides::new();
    for mut table in tables {
        let (name, fields) = Fields::read(&mut table, images)?;
        let idle = format!("no surface has the material {name:?}");
        let idle = Warning::of(WarningKind::Idle, &table.fault_of("name", idle));
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
    let mut counts: HashMap<String, usize> = HashMap::new();
    let texts: Vec<String> = tables.iter().map(mesh_table::of_what).collect();
    texts.iter().for_each(|text| *counts.entry(text.clone()).or_default() += 1);
    for (mut table, text) in tables.into_iter().zip(texts) {
        let repeated = (counts[&text] > 1).then_some(text);
        let placed = mesh_table::read(&mut table, repeated, files)?;
        let key = if placed.material.is_some() { "material" } else { "file" };
        let fault = merge.add(placed, overrides).err();
        if let Some(fault) = fault {
            return Err(table.fault_of(key, fault));
        }
        table.done()?;
    }
    Ok(merge)
}
