//! Pictures of heights that turn the normals of materials: their slopes are those of a surface once all of a scene is read.

use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::face_areas;
use super::map::{self, Images};
use super::table::Table;
use super::tally::Tally;
use super::{Warning, WarningKind};
use crate::error::Result;
use crate::image::TextureBudget;
use crate::scene::bump::Lay;
use crate::scene::displace::Heights;
use crate::scene::{Map, Maps, Placement, Range, Scene, Texture, studio};

/// Heights of a material.
#[derive(Debug, Clone, PartialEq)]
pub struct Bump {
    /// Their slopes as a normal map.
    map: Map,
    /// How far, in world units, a surface rises at the steepest along one unit of its texture coordinates.
    rise: f64,
    /// The key that says so, its file, and the line in that.
    key: &'static str,
    file: PathBuf,
    line: usize,
}

/// The steepest slope: what is steeper, single precision can't tell from upright.
const STEEPEST: f64 = (1 << 20) as f64;

impl Bump {
    /// That of a normal map, where white is `height` above black.
    pub fn new(Made { map, steepest }: Made, height: f32, (key, file, line): (&'static str, &Path, usize)) -> Self {
        Bump { map, rise: f64::from(height) * steepest, key, file: file.to_owned(), line }
    }

    /// Gives it to a material that has no normal map of its own.
    pub fn cover(&self, maps: &mut Maps) {
        if maps.normal.is_none() {
            maps.normal = Some(self.map.clone());
            // Until the surfaces are known, so that other heights make another material.
            maps.normal_scale = self.rise.clamp(-STEEPEST, STEEPEST) as f32;
        }
    }
}

/// Reads `bump_texture` of a `[[material]]` table.
///
/// # Errors
/// No height, a number out of range, or a picture that can't be read.
pub fn read(table: &mut Table, images: &mut Images) -> Result<Option<Bump>> {
    const KEY: &str = "bump_texture";
    let Some((name, of)) = table.text_or_table(KEY, "file")? else { return Ok(None) };
    let Some(mut of) = of else {
        let fault = "how high white is above black is to be said; write { file = \"...\", height = 0.02 }";
        return Err(table.fault_of(KEY, fault));
    };
    let height = of.number("height", Range::ANY)?;
    let (height, placement) = (of.need("height", height)?, map::placement(&mut of)?);
    of.done()?;
    let made = images.slopes(&name, placement).map_err(|error| table.fault_of(KEY, error.to_string()))?;
    let here = table.fault_of(KEY, "");
    let (file, line) = here.place().unwrap_or((Path::new(""), None));
    Ok(Some(Bump::new(made, height, (KEY, file, line.unwrap_or(1)))))
}

/// The slopes of a picture as a normal map.
pub struct Made {
    map: Map,
    /// The steepest of them, of heights from 0 to 1 along one unit of the surface's texture coordinates.
    steepest: f64,
}

impl Made {
    /// Of a picture that isn't read.
    pub fn blank(placement: Placement) -> Self {
        Made { map: Map { texture: studio::blank(), placement: Lay::placed(placement) }, steepest: 0.0 }
    }
}

/// What a picture is that turns normals.
pub enum ReliefMap {
    /// A normal map.
    Normals(Map),
    /// Slopes of heights.
    Heights(Made),
}

/// The slopes of pictures that materials share.
#[derive(Default)]
pub struct Slopes(HashMap<(PathBuf, Lay), (Arc<Texture>, f64)>);

impl Slopes {
    /// Those of the picture of a path that were made before.
    pub fn find(&self, path: &Path, placement: Placement) -> Option<Made> {
        let (lay, factor) = Lay::of(&placement);
        let (texture, steepest) = self.0.get(&(path.to_owned(), lay))?;
        let map = Map { texture: texture.clone(), placement: Lay::placed(placement) };
        Some(Made { map, steepest: factor * steepest })
    }

    /// Makes those of a picture.
    ///
    /// # Errors
    /// The pictures before it or memory leave no room, or it is too large to be mirrored.
    pub fn make(
        &mut self,
        path: &Path,
        placement: Placement,
        heights: &Heights,
        budget: &mut TextureBudget,
    ) -> Result<Made> {
        let (lay, factor) = Lay::of(&placement);
        let (width, height) = lay.size(heights.width, heights.height);
        budget.take_floats(width, height).map_err(|error| error.of(path))?;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let slopes = lay.slopes(&name, heights);
        let texture = Arc::new(slopes.texture);
        let map = Map { texture: texture.clone(), placement: Lay::placed(placement) };
        self.0.insert((path.to_owned(), lay), (texture, slopes.steepest));
        Ok(Made { map, steepest: factor * slopes.steepest })
    }

    /// The pictures.
    pub fn paths(self) -> impl Iterator<Item = PathBuf> {
        self.0.into_keys().map(|(path, _)| path)
    }
}

/// Makes slopes in world units of those of materials, by how large their surfaces are in the world and in texture coordinates, and tells
/// in one warning a file of those that change nothing.
pub fn settle(scene: &mut Scene, bumps: Vec<(u32, Bump)>) -> Vec<Warning> {
    let mut sets = vec![None; scene.materials.len()];
    for (material, bump) in &bumps {
        sets[*material as usize] = Some(bump.map.placement.set as usize);
    }
    let areas = if bumps.is_empty() { Vec::new() } else { face_areas::of(scene, &sets) };
    let mut idle: BTreeMap<&Path, [Tally; 2]> = BTreeMap::new();
    for (number, bump) in &bumps {
        let maps = &mut scene.materials[*number as usize].maps;
        let [beside, bare] = idle.entry(&bump.file).or_default();
        if maps.normal.as_ref() != Some(&bump.map) {
            beside.add(bump.line, bump.key);
            continue;
        }
        match areas[*number as usize].scale() {
            Some(scale) => maps.normal_scale = (bump.rise / scale).clamp(-STEEPEST, STEEPEST) as f32,
            None => {
                bare.add(bump.line, bump.key);
                (maps.normal, maps.normal_scale) = (None, Maps::default().normal_scale);
            }
        }
    }
    let warnings = idle.into_iter().flat_map(|(file, [beside, bare])| {
        [
            beside.warn(
                WarningKind::Idle,
                file,
                "ignored: the material has a normal map, too, which counts; remove one",
            ),
            bare.warn(
                WarningKind::Idle,
                file,
                "ignored: no triangle of the material has texture coordinates; give some",
            ),
        ]
    });
    warnings.flatten().collect()
}
