//! One mesh of many parts, and the materials in use.

use std::cell::Cell;
use std::collections::{BTreeMap, HashMap, TryReserveError};

use glam::Vec3;

use super::material::{DEFAULT, Fields};
use super::part::Placed;
use super::suggest::suggest;
use super::{Material, Mesh, Part, Unplaced};

/// A `[[material]]` table, and whether any surface has it.
pub struct Override {
    fields: Fields,
    idle: String,
    used: Cell<bool>,
}

impl Override {
    /// What the table says, and the warning for when no surface has it.
    pub fn new(fields: Fields, idle: String) -> Self {
        Override { fields, idle, used: Cell::new(false) }
    }

    /// The warning, if no surface has it.
    pub fn warning(&self) -> Option<String> {
        (!self.used.get()).then(|| self.idle.clone())
    }

    fn over(&self, fields: Fields) -> Fields {
        self.used.set(true);
        self.fields.over(fields)
    }
}

/// By name.
pub type Overrides = BTreeMap<String, Override>;

/// The parts so far.
#[derive(Default)]
pub struct Merge {
    mesh: Mesh,
    parts: Vec<Part>,
    materials: Vec<Material>,
    by_name: HashMap<String, Vec<u32>>,
}

impl Merge {
    /// Adds a part, whose materials `overrides` has the last word on.
    ///
    /// # Errors
    /// Its material is unknown, or there is no memory for it.
    pub fn add(&mut self, placed: Placed, overrides: &Overrides) -> Unplaced<()> {
        let full = |_| "there is no memory left for this mesh; use fewer triangles";
        self.reserve(&placed.mesh).map_err(full)?;
        let all = placed.material.as_deref();
        let all = all.map(|name| self.named(name, &placed, overrides)).transpose()?;
        let mut numbers = vec![all; placed.materials.len()];
        let first = self.mesh.positions.len() as u32;
        for &local in &placed.mesh.materials {
            let local = local as usize;
            let number = *numbers[local].get_or_insert_with(|| {
                let (name, fields) = &placed.materials[local];
                self.number(name, *fields, overrides)
            });
            self.mesh.materials.push(number);
        }
        let triangles = self.mesh.triangles.len()..self.mesh.materials.len();
        self.parts.push(placed.part(triangles));
        let shift = |triangle: [u32; 3]| triangle.map(|vertex| first + vertex);
        self.mesh.triangles.extend(placed.mesh.triangles.into_iter().map(shift));
        self.mesh.positions.extend(placed.mesh.positions);
        self.mesh.normals.extend(placed.mesh.normals);
        self.mesh.normals.resize(self.mesh.positions.len(), Vec3::ZERO);
        Ok(())
    }

    fn reserve(&mut self, more: &Mesh) -> Result<(), TryReserveError> {
        self.mesh.materials.try_reserve(more.materials.len())?;
        self.mesh.triangles.try_reserve(more.triangles.len())?;
        self.mesh.positions.try_reserve(more.positions.len())?;
        self.mesh.normals.try_reserve(more.positions.len())
    }

    /// The whole mesh, its parts, and the materials that it uses, each once.
    pub fn finish(mut self) -> (Mesh, Vec<Part>, Vec<Material>) {
        if self.mesh.normals.iter().all(|&normal| normal == Vec3::ZERO) {
            self.mesh.normals = Vec::new();
        }
        (self.mesh, self.parts, self.materials)
    }

    fn named(&mut self, name: &str, placed: &Placed, overrides: &Overrides) -> Unplaced<u32> {
        // The last of a name counts, as in the file itself.
        let own = placed.materials.iter().rev().find(|(own, _)| own == name);
        if own.is_none() && !overrides.contains_key(name) && name != DEFAULT {
            let own = placed.materials.iter().map(|(own, _)| own.as_str());
            let known = own.chain(overrides.keys().map(String::as_str));
            return Err(format!("unknown material {name:?}; {}", suggest(name, known)));
        }
        let fields = own.map_or(Fields::default(), |(_, fields)| *fields);
        Ok(self.number(name, fields, overrides))
    }

    fn number(&mut self, name: &str, fields: Fields, overrides: &Overrides) -> u32 {
        let fields = match overrides.get(name) {
            Some(over) => over.over(fields),
            None => fields,
        };
        let material = fields.finish(name);
        // Two files may mean different things by a name.
        let same = self.by_name.entry(name.to_owned()).or_default();
        let found = same.iter().find(|&&number| self.materials[number as usize] == material);
        if let Some(&number) = found {
            return number;
        }
        let number = self.materials.len() as u32;
        same.push(number);
        self.materials.push(material);
        number
    }
}
