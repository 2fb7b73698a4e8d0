//! A `[[mesh]]` of a TOML scene: a file or a shape, and where it goes.

use super::budget::Budget;
use super::copies::Copies;
use super::curves;
use super::face_sizes::FaceSizes;
use super::files::{Files, is, is_gltf};
use super::geometry::Geometry;
use super::material::{DEFAULT, Fields};
use super::named::{self, Wish};
use super::obj::Obj;
use super::object_table::Worlds;
use super::surface::Surface;
use super::table::Table;
use super::{Instant, visible};
use crate::error::Result;
use crate::scene::{Instance, Mesh, Object, Primitives, Unplaced, Visibility, extent, normal};
use glam::{DMat4, Vec3};

/// Geometry in place, and the materials that it numbers.
pub struct Placed {
    /// The file as the scene names it, or the shape's word.
    pub name: String,
    pub geometry: Geometry,
    /// What of it stands in several places.
    pub copies: Copies,
    /// What it is, where other tables are the same elsewhere: the meshes of its copies are those of the first of them.
    pub repeated: Option<String>,
    pub materials: Vec<(String, Fields)>,
    /// This one instead of them all.
    pub material: Option<String>,
    /// What a file itself is made of, by the triangles of the geometry.
    pub objects: Vec<Object>,
    pub visibility: Visibility,
    /// The groups of lamps that light it, where it says more than its materials do.
    pub lit_by: Option<Vec<String>>,
}

impl Placed {
    /// The objects that stand there: those of a file that has several, or all of it as one. Their own primitives will be `primitives`,
    /// and so many places of other copies lie before theirs, whose bounds are measured when all is read.
    pub fn objects(&self, primitives: Primitives, copies: usize) -> Vec<Object> {
        let visibility = self.visibility;
        if let (Geometry::Mesh(mesh), Primitives::Triangles(all), [_, _, ..]) =
            (&self.geometry, &primitives, &*self.objects)
        {
            let of_file = self.objects.iter().filter_map(|object| {
                let (primitives, bounds) = match &object.primitives {
                    Primitives::Triangles(own) => {
                        let corners = mesh.triangles.get(own.clone())?.iter().flatten();
                        let bounds = extent::of(corners.map(|&vertex| mesh.positions[vertex as usize]));
                        (Primitives::Triangles(all.start + own.start..all.start + own.end), bounds)
                    }
                    Primitives::Instances(own) => {
                        (Primitives::Instances(copies + own.start..copies + own.end), Default::default())
                    }
                    _ => return None,
                };
                Some(Object { name: object.name.clone(), primitives, bounds, visibility })
            });
            return of_file.collect();
        }
        let name = match &self.material {
            Some(material) => format!("{} ({material})", self.name),
            None => self.name.clone(),
        };
        let copied = Primitives::Instances(copies..copies + self.copies.places.len());
        let there = [(primitives, self.geometry.bounds()), (copied, Default::default())];
        let there = there.into_iter().filter(|(primitives, _)| primitives.count() > 0);
        there.map(|(primitives, bounds)| Object { name: name.clone(), primitives, bounds, visibility }).collect()
    }
}

/// What a `[[mesh]]` table is of, wherever it goes: tables of the same are equal texts.
pub fn of_what(table: &Table) -> String {
    table.text_without(&["scale", "rotate", "translate", "key", "on", "place"])
}

/// Reads a `[[mesh]]` table, but for refusing unknown keys. `repeated` is what it is of if others are, too.
///
/// # Errors
/// A file that cannot be read, no file and no shape or both, a number out of range, or a transform that
/// leads out of single precision.
pub fn read(table: &mut Table, repeated: Option<String>, files: &mut Files) -> Result<Placed> {
    let material = table.name("material")?;
    let smooth = table.flag("smooth")?;
    let loading = &files.images.loading;
    let seconds = loading.moment.seconds.unwrap_or(0.0);
    let Worlds { places, last } = files.objects.worlds(table, seconds, &files.budget)?;
    let is_kept = last.is_some() && loading.instant != Instant::Alone;
    files.move_until(last);
    // What one of them makes of spheres they are everywhere.
    let transform = places.iter().find(|place| !place.keeps_spheres()).or(places.first()).copied();
    let wish = Wish { smooth, transform };
    let visibility = visible::read(table)?.unwrap_or_default();
    let lit_by = table.names("lit_by")?;
    let surface = Surface::read(table, files)?;
    // What differs by its place is no copy of what another table says.
    let repeated = repeated.filter(|_| !surface.differs_by_place());
    let Source { name, mut geometry, faces, mut copies, materials, mut objects } = source(table, &wish, files)?;
    if surface
        .put((&mut geometry, &faces), &mut copies, &places, files)
        .map_err(|(key, why)| table.fault_of(key, why))?
    {
        // Their numbers of triangles are others now.
        objects.clear();
    }
    let shade = |mesh: &mut Mesh| match smooth {
        Some(true) => normal::smooth(mesh),
        Some(false) => mesh.normals.clear(),
        None => {}
    };
    if let Geometry::Mesh(mesh) = &mut geometry {
        shade(mesh);
    }
    copies.meshes.iter_mut().for_each(shade);
    let repeated = repeated.filter(|_| matches!(geometry, Geometry::Mesh(_)));
    let is_copied = repeated.is_some() || is_kept || places.len() > 1;
    if let (true, Geometry::Mesh(mesh)) = (is_copied, &mut geometry) {
        copies = Copies::with(std::mem::take(mesh), copies);
        objects.clear();
    }
    check_room(&geometry, &copies, places.len().max(1), &files.budget).map_err(|fault| table.fault(fault))?;
    geometry.put(&places);
    copies.put(&places);
    if let Some(fault) = geometry.fault().or_else(|| copies.fault()) {
        return Err(table.fault(fault));
    }
    files.budget.take(&geometry);
    if repeated.as_ref().is_none_or(|what| files.repeated.insert(what.clone())) {
        copies.meshes.iter().for_each(|mesh| files.budget.take_mesh(mesh));
    }
    Ok(Placed { name, geometry, copies, repeated, materials, material, objects, visibility, lit_by })
}

/// Refuses what takes too much memory at so many places.
fn check_room(geometry: &Geometry, copies: &Copies, places: usize, budget: &Budget) -> Unplaced<()> {
    let round = match geometry {
        Geometry::Mesh(_) => 0,
        Geometry::Spheres(spheres) => spheres.len(),
        Geometry::Disks(disks) => disks.len(),
    };
    budget.check_round(round.saturating_mul(places))?;
    let copies = copies.places.len().saturating_mul(places) as u64;
    let bytes = copies.saturating_mul((size_of::<(usize, DMat4)>() + size_of::<Instance>()) as u64);
    budget.check_bytes(bytes).map_err(|why| format!("{copies} copies {why}; use fewer"))
}

/// A file or a shape as it is.
struct Source {
    name: String,
    geometry: Geometry,
    /// Those that a mesh is of.
    faces: FaceSizes,
    copies: Copies,
    materials: Vec<(String, Fields)>,
    objects: Vec<Object>,
}

impl Source {
    /// Of what names no material.
    fn plain(name: impl Into<String>, geometry: Geometry) -> Source {
        let (faces, copies, objects) = Default::default();
        Source { name: name.into(), geometry, faces, copies, materials: plain(), objects }
    }
}

fn source(table: &mut Table, wish: &Wish, files: &mut Files) -> Result<Source> {
    match (table.has("file"), table.has("shape")) {
        (true, false) => from_file(table, wish, files),
        (false, true) => {
            let (word, geometry) = named::read(table, wish, files)?;
            let mut source = Source::plain(word, geometry);
            if let ("quad" | "box", Geometry::Mesh(mesh)) = (word, &source.geometry) {
                (0..mesh.triangles.len() / 2).for_each(|_| source.faces.push(2));
            }
            Ok(source)
        }
        (true, true) => Err(table.fault_of("shape", "a mesh is a file or a shape; remove the one")),
        (false, false) => Err(table.fault("[[mesh]] needs \"file\" or \"shape\"; add one")),
    }
}

fn from_file(table: &mut Table, wish: &Wish, files: &mut Files) -> Result<Source> {
    table.rename("a mesh of a file");
    let name = table.name("file")?;
    let name = table.need("file", name)?;
    let path = files.place(table, &name)?;
    let budget = files.budget;
    if is(&path, "xyzr") {
        table.rename("a file of spheres");
        let geometry = named::spheres(table, wish, budget, files.spheres(&path)?)?;
        return Ok(Source::plain(name, geometry));
    }
    if curves::is(&path) {
        let (mesh, has_colours) = curves::of_file(table, &path, files)?;
        let materials = if has_colours { white() } else { plain() };
        return Ok(Source { materials, ..Source::plain(name, Geometry::Mesh(mesh)) });
    }
    if !is(&path, "obj") && !is(&path, "ply") && !is_gltf(&path) {
        let fault =
            format!("{name:?} is no .obj, .ply, .gltf, .glb, .xyzr, .hair or .txt; name a mesh, spheres or curves");
        return Err(table.fault_of("file", fault));
    }
    let Obj { mesh, faces, copies, materials, objects, .. } = files.mesh(&path)?;
    budget.check(mesh.triangles.len(), mesh.positions.len()).map_err(|fault| table.fault(fault))?;
    let geometry = Geometry::Mesh(mesh.clone());
    let (faces, copies) = (faces.clone(), copies.clone());
    Ok(Source { name, geometry, faces, copies, materials: materials.clone(), objects: objects.clone() })
}

/// The materials of what names none.
pub fn plain() -> Vec<(String, Fields)> {
    vec![(DEFAULT.into(), Fields::default())]
}

/// The same beneath colours of vertices, which say what colour it is.
pub fn white() -> Vec<(String, Fields)> {
    vec![(DEFAULT.into(), Fields { diffuse: Some(Vec3::ONE), ..Fields::default() })]
}
