//! Grids of densities and temperatures in a file: the description tells what they are and who takes them, their numbers lie before the texels of textures.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DAffine3;
use serde::{Deserialize, Serialize};

use crate::scene::hierarchy::records;
use crate::scene::{Grid, Leaf, Scene, Temperature, Unplaced, Volume};

/// A grid: its leaves follow those of the grid before, the even ones first.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored {
    name: String,
    background: f32,
    extent: [[i32; 3]; 2],
    placement: [f64; 12],
    has_edges: bool,
    even: u64,
    voxels: u64,
}

/// Every grid of a scene, once, and which material takes which.
#[derive(Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Grids {
    grids: Vec<Stored>,
    taken: Vec<[u32; 2]>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    heated: Vec<Heated>,
}

/// A material that takes a grid for its temperature.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Heated {
    material: u32,
    grid: u32,
    kelvins: f32,
}

/// Bytes of an even leaf: its place and its number.
const EVEN: usize = 16;
/// Bytes of another.
const VOXELS: usize = 12 + 4 * 512;

impl Grids {
    /// Those of a scene, and the bytes of their leaves.
    pub fn of(scene: &Scene) -> (Grids, Vec<u8>) {
        let (mut grids, mut bytes, mut known) = (Vec::new(), Vec::new(), Vec::<Arc<Grid>>::new());
        let mut place = |grid: &Arc<Grid>| {
            let found = known.iter().position(|other| Arc::ptr_eq(other, grid));
            let place = found.unwrap_or_else(|| {
                known.push(grid.clone());
                grids.push(Stored::of(grid, &mut bytes));
                known.len() - 1
            });
            place as u32
        };
        let (mut taken, mut heated) = (Vec::new(), Vec::new());
        for (material, number) in scene.materials.iter().zip(0..) {
            let Some(volume) = &material.volume else { continue };
            taken.extend(volume.density.as_ref().map(|grid| [number, place(grid)]));
            heated.extend(volume.temperature.as_ref().map(|temperature| {
                let Temperature { grid, kelvins } = temperature;
                Heated { material: number, grid: place(grid), kelvins: *kelvins }
            }));
        }
        (Grids { grids, taken, heated }, bytes)
    }

    /// Is there none?
    pub fn is_empty(&self) -> bool {
        self.grids.is_empty()
    }

    /// Gives a scene these grids, whose leaves are the first of these bytes.
    ///
    /// # Errors
    /// Fewer bytes, or something that takes or is taken by nothing.
    pub fn give(self, scene: &mut Scene, bytes: &mut &[u8]) -> Unplaced<()> {
        let mut grids = Vec::new();
        for stored in self.grids {
            grids.push(Arc::new(stored.grid(bytes)?));
        }
        let taken = |place: u32| {
            let grid = grids.get(place as usize).cloned();
            grid.ok_or_else(|| format!("something takes grid {place} of {}", grids.len()))
        };
        for [material, grid] in self.taken {
            volume(scene, material)?.density = Some(taken(grid)?);
        }
        for Heated { material, grid, kelvins } in self.heated {
            volume(scene, material)?.temperature = Some(Temperature { grid: taken(grid)?, kelvins });
        }
        Ok(())
    }
}

/// The volume of a material that takes a grid.
fn volume(scene: &mut Scene, material: u32) -> Unplaced<&mut Volume> {
    let volume = scene.materials.get_mut(material as usize).and_then(|material| material.volume.as_mut());
    volume.ok_or_else(|| format!("material {material} takes a grid without a volume"))
}

impl Stored {
    fn of(grid: &Grid, bytes: &mut Vec<u8>) -> Stored {
        let (mut even, mut voxels) = (0, 0);
        for (place, leaf) in &grid.leaves {
            if let Leaf::Even(number) = leaf {
                even += 1;
                place.iter().for_each(|at| bytes.extend(at.to_le_bytes()));
                bytes.extend(number.to_le_bytes());
            }
        }
        for (place, leaf) in &grid.leaves {
            if let Leaf::Voxels(numbers) = leaf {
                voxels += 1;
                place.iter().for_each(|at| bytes.extend(at.to_le_bytes()));
                numbers.iter().for_each(|number| bytes.extend(number.to_le_bytes()));
            }
        }
        let Grid { background, extent, has_edges, .. } = *grid;
        let placement = grid.placement.to_cols_array();
        Stored { name: grid.name.clone(), background, extent, placement, has_edges, even, voxels }
    }

    fn grid(self, bytes: &mut &[u8]) -> Unplaced<Grid> {
        let Stored { name, background, extent, placement, has_edges, even, voxels } = self;
        let mut take = |count: u64, size: usize| {
            let own = usize::try_from(count).ok().and_then(|count| count.checked_mul(size));
            let (own, rest) = own
                .and_then(|own| bytes.split_at_checked(own))
                .ok_or_else(|| format!("the grid {name:?} has {} bytes of leaves and needs more", bytes.len()))?;
            *bytes = rest;
            Ok::<_, String>(own)
        };
        let place = |leaf: &[u8]| -> [i32; 3] { records::<i32>(&leaf[..12]).try_into().expect("three numbers") };
        let mut leaves = BTreeMap::new();
        for leaf in take(even, EVEN)?.chunks_exact(EVEN) {
            leaves.insert(place(leaf), Leaf::Even(records::<f32>(&leaf[12..])[0]));
        }
        for leaf in take(voxels, VOXELS)?.chunks_exact(VOXELS) {
            let numbers: Box<[f32]> = records::<f32>(&leaf[12..]).into();
            leaves.insert(place(leaf), Leaf::Voxels(numbers.try_into().expect("512 numbers")));
        }
        Ok(Grid { name, leaves, background, extent, placement: DAffine3::from_cols_array(&placement), has_edges })
    }
}
