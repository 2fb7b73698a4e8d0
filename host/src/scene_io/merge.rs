//! One scene of many objects, and the materials in use.

use std::cell::Cell;
use std::collections::{BTreeMap, HashMap, TryReserveError};

use glam::{Vec2, Vec3, Vec4};

use super::Warning;
use super::bump::Bump;
use super::copies::Copies;
use super::geometry::Geometry;
use super::material::{DEFAULT, Fields};
use super::mesh_table::Placed;
use super::suggest::suggest;
use crate::scene::{Disk, Instance, Material, Mesh, Object, Primitives, SharedMesh, Sphere, Unplaced};

/// A `[[material]]` table, and whether any surface has it.
pub struct Override {
    fields: Fields,
    idle: Warning,
    used: Cell<bool>,
}

impl Override {
    /// What the table says, and the warning for when no surface has it.
    pub fn new(fields: Fields, idle: Warning) -> Self {
        Override { fields, idle, used: Cell::new(false) }
    }

    /// The warning, if no surface has it.
    pub fn warning(&self) -> Option<Warning> {
        (!self.used.get()).then(|| self.idle.clone())
    }

    /// Does it have textures?
    pub fn has_maps(&self) -> bool {
        self.fields.has_maps()
    }

    /// Does it ask for tangents?
    pub fn has_axes(&self) -> bool {
        self.fields.has_axes()
    }

    fn over(&self, fields: Fields) -> Fields {
        self.used.set(true);
        self.fields.clone().over(fields)
    }
}

/// By name.
pub type Overrides = BTreeMap<String, Override>;

/// The objects so far.
#[derive(Default)]
pub struct Merge {
    mesh: Mesh,
    spheres: Vec<Sphere>,
    disks: Vec<Disk>,
    copies: Copies,
    /// The numbers of the first meshes of what is repeated.
    repeated: HashMap<String, usize>,
    objects: Vec<Object>,
    materials: Vec<Material>,
    bumps: Vec<(u32, Bump)>,
    by_name: HashMap<String, Vec<u32>>,
}

/// Adds what more vertices have, and `none` for those that have nothing; nothing as long as none has anything.
fn put<T: Copy>(all: &mut Vec<T>, more: Vec<T>, (before, after): (usize, usize), none: T) {
    if all.is_empty() && more.is_empty() {
        return;
    }
    all.resize(before, none);
    all.extend(more);
    all.resize(after, none);
}

/// The fields of a scene that its objects make.
pub struct Merged {
    pub mesh: Mesh,
    pub spheres: Vec<Sphere>,
    pub disks: Vec<Disk>,
    pub shared: Vec<SharedMesh>,
    pub instances: Vec<Instance>,
    pub objects: Vec<Object>,
    pub materials: Vec<Material>,
    /// Heights of materials, by their numbers, whose slopes are not yet those of a surface.
    pub bumps: Vec<(u32, Bump)>,
}

impl Merge {
    /// Adds what was placed, whose materials `overrides` has the last word on.
    ///
    /// # Errors
    /// Its material is unknown, or there is no memory for it.
    pub fn add(&mut self, placed: Placed, overrides: &Overrides) -> Unplaced<()> {
        let full = |_| "there is no memory left for this mesh; use fewer triangles or spheres";
        self.reserve(&placed.geometry).map_err(full)?;
        let all = placed.material.as_deref();
        let all = all.map(|name| self.named(name, &placed, overrides)).transpose()?;
        self.objects.extend(placed.objects(self.next(&placed.geometry), self.copies.places.len()));
        let Placed { mut geometry, mut copies, repeated, materials, lit_by, .. } = placed;
        let mut numbers = vec![all; materials.len()];
        let mut number = |local: u32| {
            let (name, fields) = &materials[local as usize];
            *numbers[local as usize].get_or_insert_with(|| self.number(name, (fields.clone(), &lit_by), overrides))
        };
        geometry.renumber(&mut number);
        let of_copies = copies.meshes.iter_mut().flat_map(|mesh| &mut mesh.materials);
        of_copies.for_each(|material| *material = number(*material));
        let next = self.copies.meshes.len();
        let first = repeated.map_or(next, |what| *self.repeated.entry(what).or_insert(next));
        if first == next {
            self.copies.meshes.extend(copies.meshes);
        }
        self.copies.place(first, copies.places);
        match geometry {
            Geometry::Mesh(mesh) => self.append(mesh),
            Geometry::Spheres(spheres) => self.spheres.extend(spheres),
            Geometry::Disks(disks) => self.disks.extend(disks),
        }
        Ok(())
    }

    /// Where the geometry will stand.
    fn next(&self, geometry: &Geometry) -> Primitives {
        let after = |count: usize, more: usize| count..count + more;
        match geometry {
            Geometry::Mesh(mesh) => Primitives::Triangles(after(self.mesh.triangles.len(), mesh.triangles.len())),
            Geometry::Spheres(spheres) => Primitives::Spheres(after(self.spheres.len(), spheres.len())),
            Geometry::Disks(disks) => Primitives::Disks(after(self.disks.len(), disks.len())),
        }
    }

    fn append(&mut self, mesh: Mesh) {
        if self.mesh.positions.is_empty() {
            self.mesh = mesh;
            return;
        }
        let before = self.mesh.positions.len();
        self.mesh.normals.resize(before, Vec3::ZERO);
        let first = before as u32;
        let shift = |triangle: [u32; 3]| triangle.map(|vertex| first + vertex);
        self.mesh.triangles.extend(mesh.triangles.into_iter().map(shift));
        self.mesh.materials.extend(mesh.materials);
        self.mesh.positions.extend(mesh.positions);
        self.mesh.normals.extend(mesh.normals);
        let after = self.mesh.positions.len();
        self.mesh.normals.resize(after, Vec3::ZERO);
        let [first, second] = mesh.coordinates;
        put(&mut self.mesh.coordinates[0], first, (before, after), Vec2::ZERO);
        put(&mut self.mesh.coordinates[1], second, (before, after), Vec2::ZERO);
        put(&mut self.mesh.tangents, mesh.tangents, (before, after), Vec4::ZERO);
        put(&mut self.mesh.colours, mesh.colours, (before, after), Vec4::ONE);
    }

    fn reserve(&mut self, more: &Geometry) -> Result<(), TryReserveError> {
        match more {
            // It is taken as it is.
            Geometry::Mesh(_) if self.mesh.positions.is_empty() => Ok(()),
            Geometry::Mesh(mesh) => {
                self.mesh.materials.try_reserve(mesh.materials.len())?;
                self.mesh.triangles.try_reserve(mesh.triangles.len())?;
                self.mesh.positions.try_reserve(mesh.positions.len())?;
                self.mesh.normals.try_reserve(mesh.positions.len())
            }
            Geometry::Spheres(spheres) => self.spheres.try_reserve(spheres.len()),
            Geometry::Disks(disks) => self.disks.try_reserve(disks.len()),
        }
    }

    /// All of it, with the materials that it uses, each once.
    pub fn finish(mut self) -> Merged {
        let (meshes, instances) = std::mem::take(&mut self.copies).finish();
        let mut shared = Vec::new();
        for mesh in meshes {
            let (vertex, triangle) = (self.mesh.positions.len(), self.mesh.triangles.len());
            self.append(mesh);
            shared.push(SharedMesh {
                vertices: vertex..self.mesh.positions.len(),
                triangles: triangle..self.mesh.triangles.len(),
            });
        }
        if self.mesh.normals.iter().all(|&normal| normal == Vec3::ZERO) {
            self.mesh.normals = Vec::new();
        }
        let maps = || self.materials.iter().flat_map(|material| material.maps.all());
        let is_covered = |set| maps().any(|map| map.placement.set == set);
        let is_used = [maps().next().is_some(), is_covered(1)];
        for (coordinates, is_used) in self.mesh.coordinates.iter_mut().zip(is_used) {
            if !is_used {
                *coordinates = Vec::new();
            }
        }
        let Merge { mesh, spheres, disks, objects, materials, bumps, .. } = self;
        Merged { mesh, spheres, disks, shared, instances, objects, materials, bumps }
    }

    fn named(&mut self, name: &str, placed: &Placed, overrides: &Overrides) -> Unplaced<u32> {
        // The last of a name counts, as in the file itself.
        let own = placed.materials.iter().rev().find(|(own, _)| own == name);
        if own.is_none() && !overrides.contains_key(name) && name != DEFAULT {
            let own = placed.materials.iter().map(|(own, _)| own.as_str());
            let known = own.chain(overrides.keys().map(String::as_str));
            return Err(format!("unknown material {name:?}; {}", suggest(name, known)));
        }
        let fields = own.map_or(Fields::default(), |(_, fields)| fields.clone());
        Ok(self.number(name, (fields, &placed.lit_by), overrides))
    }

    /// The number of a material of a mesh, which may be lit by other lamps than others of it.
    fn number(&mut self, name: &str, (fields, lit_by): (Fields, &Option<Vec<String>>), overrides: &Overrides) -> u32 {
        let mut fields = match overrides.get(name) {
            Some(over) => over.over(fields),
            None => fields,
        };
        let bump = fields.bump.take();
        if let Some(bump) = &bump {
            bump.cover(&mut fields.maps);
        }
        let lit_by = lit_by.clone().or_else(|| fields.lit_by.clone());
        let material = Fields { lit_by, ..fields }.finish(name);
        // Two files may mean different things by a name.
        let same = self.by_name.entry(name.to_owned()).or_default();
        let found = same.iter().find(|&&number| self.materials[number as usize] == material);
        if let Some(&number) = found {
            return number;
        }
        let number = self.materials.len() as u32;
        same.push(number);
        self.bumps.extend(bump.map(|bump| (number, bump)));
        self.materials.push(material);
        number
    }
}
