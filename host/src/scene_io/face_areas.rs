//! How large the surfaces of materials are, in the world and in texture coordinates.

use std::collections::BTreeMap;
use std::ops::Range;

use glam::{DMat3, DVec2, DVec3};

use crate::scene::{Instance, Scene};

/// The areas of triangles.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Areas {
    /// In world units.
    world: f64,
    /// In units of texture coordinates.
    texture: f64,
}

impl Areas {
    /// How long one unit of texture coordinates is in the world, in the mean over areas; none without texture coordinates.
    pub fn scale(&self) -> Option<f64> {
        let scale = (self.world / self.texture).sqrt();
        (scale.is_finite() && scale > 0.0).then_some(scale)
    }

    fn add(&mut self, other: Areas) {
        self.world += other.world;
        self.texture += other.texture;
    }
}

/// Those of every material that has a set of texture coordinates in `sets`, by all triangles for which these are a plane: those of copies
/// count as often as they are copied.
pub fn of(scene: &Scene, sets: &[Option<usize>]) -> Vec<Areas> {
    let mut areas = vec![Areas::default(); sets.len()];
    covered(scene, sets, 0..scene.own_triangles(), |material, (area, texture)| {
        areas[material].add(Areas { world: area.length(), texture });
    });
    let shared: Vec<_> = scene.shared.iter().map(|shared| Facing::of(scene, sets, shared.triangles.clone())).collect();
    for copy in &scene.instances {
        for (&material, facing) in &shared[copy.mesh as usize] {
            areas[material].add(facing.placed(copy));
        }
    }
    areas
}

/// Tells `take` each triangle's material, its normal as long as its area, and its area in texture coordinates.
fn covered(scene: &Scene, sets: &[Option<usize>], triangles: Range<usize>, mut take: impl FnMut(usize, (DVec3, f64))) {
    let mesh = &scene.mesh;
    for number in triangles {
        let (corners, material) = (mesh.triangles[number], mesh.materials[number] as usize);
        let Some(coordinates) = sets[material].map(|set| &mesh.coordinates[set]).filter(|all| !all.is_empty()) else {
            continue;
        };
        let [a, b, c]: [DVec2; 3] = corners.map(|corner| coordinates[corner as usize].as_dvec2());
        let texture = (b - a).perp_dot(c - a).abs() / 2.0;
        if texture > 0.0 {
            let [a, b, c] = corners.map(|corner| mesh.positions[corner as usize].as_dvec3());
            take(material, ((b - a).cross(c - a) / 2.0, texture));
        }
    }
}

/// What triangles of a mesh are together, so that no copy has to look at each.
struct Facing {
    own: Areas,
    /// The sum of the squares (outer products) of their normals, each times its area.
    squares: DMat3,
}

impl Facing {
    /// Those of the triangles of a mesh, by material.
    fn of(scene: &Scene, sets: &[Option<usize>], triangles: Range<usize>) -> BTreeMap<usize, Facing> {
        let mut all: BTreeMap<usize, Facing> = BTreeMap::new();
        covered(scene, sets, triangles, |material, (area, texture)| {
            let facing = all.entry(material).or_insert(Facing { own: Areas::default(), squares: DMat3::ZERO });
            let world = area.length();
            facing.own.add(Areas { world, texture });
            if world > 0.0 {
                let unit = area / world;
                facing.squares += DMat3::from_cols(area * unit.x, area * unit.y, area * unit.z);
            }
        });
        all
    }

    /// Their areas where a copy stands: that of each triangle by the cofactors of the copy's matrix, and of all by the root of the mean of
    /// the squares. It is exact of planes, and of all where the copy is scaled evenly.
    fn placed(&self, copy: &Instance) -> Areas {
        let [x, y, z] = copy.rows.map(|row| row.as_dvec3());
        let cofactors = [y.cross(z), z.cross(x), x.cross(y)];
        let squares: f64 = cofactors.iter().map(|&row| row.dot(self.squares * row)).sum();
        Areas { world: (self.own.world * squares.max(0.0)).sqrt(), ..self.own }
    }
}
