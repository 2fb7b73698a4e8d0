//! Meshes that stand in several places, until all of a scene is read.

use std::collections::HashMap;

use glam::{DMat4, DVec3, DVec4};

use super::budget::Budget;
use super::transform::Transform;
use crate::choice::choices;
use crate::device_scene::{fitted, unfit_objects, unfit_triangles};
use crate::scene::{Instance, Mesh, Scene, Unplaced};

/// Meshes in units of their own, and where they stand.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Copies {
    /// Wound as they are to be seen where nothing mirrors them.
    pub meshes: Vec<Mesh>,
    /// A mesh by its number, and from its units to the world's.
    pub places: Vec<(usize, DMat4)>,
}

impl Copies {
    /// One of a mesh where it is, if it has triangles, with others.
    pub fn with(mesh: Mesh, mut others: Copies) -> Copies {
        if mesh.triangles.is_empty() {
            return others;
        }
        others.meshes.insert(0, mesh);
        others.places.iter_mut().for_each(|(mesh, _)| *mesh += 1);
        others.places.insert(0, (0, DMat4::IDENTITY));
        others
    }

    /// Adds places of meshes of which the first has this number here.
    pub fn place(&mut self, first: usize, places: Vec<(usize, DMat4)>) {
        self.places.extend(places.into_iter().map(|(mesh, world)| (first + mesh, world)));
    }

    /// Moves where they stand, to each of some places if there are any.
    pub fn put(&mut self, places: &[Transform]) {
        if !places.is_empty() {
            let at = |world: DMat4| self.places.iter().map(move |&(mesh, own)| (mesh, world * own)).collect::<Vec<_>>();
            self.places = places.iter().flat_map(|place| at(place.matrix())).collect();
        }
    }

    /// What single precision can't hold of it, and the remedy.
    pub fn fault(&self) -> Option<String> {
        let bounds: Vec<_> = self.meshes.iter().map(Mesh::bounds).collect();
        let reach = |(mesh, world): &(usize, DMat4)| {
            let [low, high] = bounds[*mesh];
            let reach = low.abs().max(high.abs()).as_dvec3();
            let rows = world.transpose();
            let row = |row: DVec4| row.truncate().abs().dot(reach) + row.w.abs();
            DVec3::new(row(rows.x_axis), row(rows.y_axis), row(rows.z_axis))
        };
        let is_far = self.places.iter().any(|place| !reach(place).as_vec3().is_finite());
        is_far.then(|| "the mesh leaves the range of single precision; make it smaller".into())
    }

    /// Meshes and the instances of them: what is mirrored somewhere is a mesh of its own.
    pub fn finish(self) -> (Vec<Mesh>, Vec<Instance>) {
        let mut numbers = HashMap::new();
        let mut meshes = Vec::new();
        let instances = self.places.iter().map(|(mesh, world)| {
            let rows = world.transpose();
            let [x, y, z] = [rows.x_axis, rows.y_axis, rows.z_axis];
            let mirrors = x.truncate().cross(y.truncate()).dot(z.truncate()) < 0.0;
            let number = *numbers.entry((*mesh, mirrors)).or_insert_with(|| {
                let mut own = self.meshes[*mesh].clone();
                if mirrors {
                    own.turn();
                }
                meshes.push(own);
                meshes.len() as u32 - 1
            });
            Instance {
                mesh: number,
                rows: [x, y, z].map(|row| row.truncate().as_vec3()),
                translation: world.w_axis.truncate().as_vec3(),
            }
        });
        let instances = instances.collect();
        (meshes, instances)
    }
}

choices! {
    /// Whether meshes that stand in several places are held once.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum Instancing {
        /// Where their copies would have many triangles
        #[default]
        Auto = "auto",
        /// Wherever they can be
        Always = "always",
        /// Nowhere: each copy has triangles of its own
        Never = "never",
    }
}

impl Instancing {
    /// A scene whose copies are held so. Pictures of it have the same bits.
    ///
    /// # Errors
    /// There is no room for all the triangles that copies would have of their own.
    pub fn of(self, scene: Scene, budget: &Budget) -> Unplaced<Scene> {
        if scene.instances.is_empty() {
            return Ok(scene);
        }
        let unfit = unfit_triangles(&scene);
        let check = |count: u64| budget.check(count as usize, count as usize);
        check(unfit).map_err(|fault| format!("copies of meshes that must be apart have {fault}"))?;
        let scene = fitted(scene);
        let stored = (scene.mesh.triangles.len() - scene.own_triangles()) as u64;
        if self.keeps(scene.copied_triangles().saturating_sub(stored)) {
            return Ok(scene);
        }
        check(scene.copied_triangles())?;
        Ok(scene.flattened())
    }

    /// Which objects of a scene are to be flattened, some of which move: those that can't be copies, and those that stand still where
    /// they are not to be held once.
    ///
    /// # Errors
    /// There is no room for their triangles.
    pub fn flattens(self, scene: &Scene, moving: &[bool], budget: &Budget) -> Unplaced<Vec<bool>> {
        let of = |is: &dyn Fn(usize) -> bool| {
            let objects = scene.objects.iter().enumerate().filter(|&(number, _)| is(number));
            let copies = objects.map(|(_, object)| object.primitives.instances(&scene.instances));
            copies.map(|copies| scene.triangles_of(copies)).sum::<u64>()
        };
        let unfit = unfit_objects(scene);
        let stored = (scene.mesh.triangles.len() - scene.own_triangles()) as u64;
        let keeps = self.keeps(of(&|number| !moving[number]).saturating_sub(stored));
        let is_flat = |number: usize| unfit[number] || (!keeps && !moving[number]);
        let flat: Vec<bool> = (0..scene.objects.len()).map(is_flat).collect();
        let count = of(&is_flat) as usize;
        budget.check(count, count)?;
        Ok(flat)
    }

    /// Are copies kept that save so many triangles beyond those of their meshes?
    fn keeps(self, saved: u64) -> bool {
        /// What takes less than a second to build flat is as well met faster.
        const MANY: u64 = 1 << 18;
        match self {
            Instancing::Auto => saved >= MANY,
            Instancing::Always => true,
            Instancing::Never => false,
        }
    }
}
