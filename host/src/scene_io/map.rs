//! The textures that a scene file names, and how its materials take them.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::Vec2;

use super::budget::Budget;
use super::bump::{Made, ReliefMap, Slopes};
use super::grid::{self, Named};
use super::load::Loading;
use super::moment::Instant;
use super::table::Table;
use crate::error::{Error, Result};
use crate::image::{Relief, TextureBudget, read_heights, read_relief, read_texture};
#[cfg(test)]
use crate::memory::Room;
use crate::scene::displace::Heights;
use crate::scene::{FinishMaps, Grid, Map, Maps, Placement, Quantity, Range, Temperature, Texture, Wrap, studio};

/// Pictures already read, since materials share them.
pub struct Images {
    folder: PathBuf,
    /// How the meshes that name some of them are read.
    pub loading: Loading,
    budget: TextureBudget,
    /// For what is read beside them.
    pub room: Budget,
    textures: HashMap<PathBuf, Arc<Texture>>,
    opacities: HashMap<PathBuf, Arc<Texture>>,
    /// Those whose heights are slopes of materials.
    slopes: Slopes,
    /// Which of them are normal maps, where only their colours tell.
    of_normals: HashMap<PathBuf, bool>,
    /// Grids that were read beside them.
    grids: Vec<PathBuf>,
}

impl Images {
    /// The pictures that a file in `folder` names, and those that its meshes do, with all the room that there is.
    #[cfg(test)]
    pub fn new(folder: &Path, loading: Loading) -> Self {
        Images::within(folder, Budget::new(Room::now()), loading)
    }

    /// The pictures that a file in `folder` names, and those that its meshes do, and what there is room for beside them.
    pub fn within(folder: &Path, room: Budget, loading: Loading) -> Self {
        Images {
            folder: folder.to_owned(),
            loading,
            budget: TextureBudget::default(),
            room,
            textures: HashMap::new(),
            opacities: HashMap::new(),
            slopes: Slopes::default(),
            of_normals: HashMap::new(),
            grids: Vec::new(),
        }
    }

    /// The picture of a name, relative to the folder.
    ///
    /// # Errors
    /// Those of [`read_texture`].
    pub fn texture(&mut self, name: &str) -> Result<Arc<Texture>> {
        self.at(&self.folder.join(name))
    }

    /// The picture of a path.
    ///
    /// # Errors
    /// Those of [`read_texture`].
    pub fn at(&mut self, path: &Path) -> Result<Arc<Texture>> {
        if let Some(texture) = self.textures.get(path) {
            return Ok(texture.clone());
        }
        if self.loading.instant == Instant::Later {
            return Ok(studio::blank());
        }
        let texture = Arc::new(read_texture(path, &mut self.budget)?);
        self.textures.insert(path.to_owned(), texture.clone());
        Ok(texture)
    }

    /// The picture of a name, relative to the folder, as heights, and its path. It is not kept.
    ///
    /// # Errors
    /// Those of [`read_heights`].
    pub fn heights(&self, name: &str) -> Result<(Heights, PathBuf)> {
        let path = self.folder.join(name);
        Ok((read_heights(&path, &mut self.budget.clone())?, path))
    }

    /// The slopes of the picture of a name, relative to the folder, as a normal map that lies so.
    ///
    /// # Errors
    /// Those of [`read_heights`], and no room for them.
    pub fn slopes(&mut self, name: &str, placement: Placement) -> Result<Made> {
        self.slopes_at(&self.folder.join(name), placement)
    }

    /// As [`Images::slopes`], of a path.
    fn slopes_at(&mut self, path: &Path, placement: Placement) -> Result<Made> {
        if self.loading.instant == Instant::Later {
            return Ok(Made::blank(placement));
        }
        if let Some(made) = self.slopes.find(path, placement) {
            return Ok(made);
        }
        let heights = read_heights(path, &mut self.budget.clone())?;
        self.slopes.make(path, placement, &heights, &mut self.budget)
    }

    /// The picture of a path as a normal map, or else the slopes of its heights, whichever its colours say.
    ///
    /// # Errors
    /// Those of [`read_relief`], and no room for slopes.
    pub fn relief(&mut self, path: &Path, placement: Placement) -> Result<ReliefMap> {
        let normals = |texture| ReliefMap::Normals(Map { texture, placement });
        if self.loading.instant == Instant::Later {
            return Ok(normals(studio::blank()));
        }
        match self.of_normals.get(path) {
            Some(false) => return self.slopes_at(path, placement).map(ReliefMap::Heights),
            Some(true) => return self.at(path).map(normals),
            None => {}
        }
        let before = self.budget.clone();
        let relief = read_relief(path, &mut self.budget)?;
        self.of_normals.insert(path.to_owned(), matches!(relief, Relief::Normals(_)));
        match relief {
            Relief::Heights(heights) => {
                self.slopes.make(path, placement, &heights, &mut self.budget).map(ReliefMap::Heights)
            }
            Relief::Normals(texture) => {
                // A material that takes it for something else has brought it.
                if self.textures.contains_key(path) {
                    self.budget = before;
                }
                Ok(normals(self.textures.entry(path.to_owned()).or_insert_with(|| Arc::new(texture)).clone()))
            }
        }
    }

    /// The grid of densities that a table names.
    ///
    /// # Errors
    /// Those of [`grid::named`].
    pub fn density(&mut self, table: &mut Table) -> Result<Option<Arc<Grid>>> {
        Ok(self.grid(table, Quantity::Density)?.map(|(grid, _)| grid))
    }

    /// The grid of temperatures that a table names.
    ///
    /// # Errors
    /// Those of [`grid::named`], and places that are too hot.
    pub fn temperature(&mut self, table: &mut Table) -> Result<Option<Temperature>> {
        let Some((grid, kelvins)) = self.grid(table, Quantity::Temperature)? else { return Ok(None) };
        let temperature = Temperature { grid, kelvins };
        let (name, key) = (&temperature.grid.name, Quantity::Temperature.name());
        temperature.check_hottest().map_err(|fault| table.fault_of(key, format!("{name}: {fault}")))?;
        Ok(Some(temperature))
    }

    /// A grid, and how many kelvins a number of it is.
    fn grid(&mut self, table: &mut Table, quantity: Quantity) -> Result<Option<(Arc<Grid>, f32)>> {
        let named = grid::named(table, quantity, &self.folder, &self.room)?;
        Ok(named.map(|Named { grid, path, kelvins }| {
            self.grids.push(path);
            (Arc::new(grid), kelvins)
        }))
    }

    /// The [opacity](Texture::opacity) of the picture of a path.
    pub fn opacity_of(&mut self, path: &Path, texture: &Texture) -> Arc<Texture> {
        self.opacities.entry(path.to_owned()).or_insert_with(|| Arc::new(texture.opacity())).clone()
    }

    /// Every file that was read, in the order of their names.
    pub fn paths(self) -> Vec<PathBuf> {
        let mut paths: Vec<_> = self.textures.into_keys().chain(self.slopes.paths()).chain(self.grids).collect();
        paths.sort();
        paths.dedup();
        paths
    }
}

/// Takes the maps of a `[[material]]` table: each the name of a picture, or a table of that and its placement.
///
/// # Errors
/// A picture that cannot be read, or a number out of range.
pub fn maps(table: &mut Table, images: &mut Images) -> Result<Maps> {
    let mut map = |key| Ok::<_, Error>(map(table, key, images)?.map(|(map, _)| map));
    let maps = Maps {
        base: map("base_texture")?,
        metallic_roughness: map("metallic_roughness_texture")?,
        emission: map("emission_texture")?,
        transmission: map("transmission_texture")?,
        specular_weight: map("specular_weight_texture")?,
        specular_tint: map("specular_tint_texture")?,
        anisotropy: map("anisotropy_texture")?,
        opacity: map("opacity_texture")?,
        ..Maps::default()
    };
    let normal = self::map(table, "normal_texture", images)?;
    let normal_scale = normal.as_ref().map_or(1.0, |(_, scale)| *scale);
    Ok(Maps { normal: normal.map(|(map, _)| map), normal_scale, finish: finish(table, images)?, ..maps })
}

/// The maps of what lies on a material, and of what else its base does with light.
fn finish(table: &mut Table, images: &mut Images) -> Result<FinishMaps> {
    let (coat_normal, coat_normal_scale) = map(table, "coat_normal_texture", images)?.unzip();
    let mut map = |key| Ok::<_, Error>(map(table, key, images)?.map(|(map, _)| map));
    Ok(FinishMaps {
        coat: map("coat_texture")?,
        coat_roughness: map("coat_roughness_texture")?,
        coat_normal,
        coat_normal_scale: coat_normal_scale.unwrap_or_default(),
        sheen_colour: map("sheen_color_texture")?,
        sheen_roughness: map("sheen_roughness_texture")?,
        diffuse_transmission: map("diffuse_transmission_texture")?,
        diffuse_transmission_colour: map("diffuse_transmission_color_texture")?,
        film: map("film_texture")?,
        film_thickness: map("film_thickness_texture")?,
    })
}

/// A map and, of normals, their scale.
fn map(table: &mut Table, key: &'static str, images: &mut Images) -> Result<Option<(Map, f32)>> {
    let Some((name, of)) = table.text_or_table(key, "file")? else { return Ok(None) };
    let texture = images.texture(&name).map_err(|error| table.fault_of(key, error.to_string()))?;
    let Some(mut of) = of else { return Ok(Some((Map { texture, placement: Placement::default() }, 1.0))) };
    let placement = placement(&mut of)?;
    let is_of_normals = matches!(key, "normal_texture" | "coat_normal_texture");
    let strength = if is_of_normals { of.number("strength", Range::ANY)? } else { None };
    of.done()?;
    Ok(Some((Map { texture, placement }, strength.unwrap_or(1.0))))
}

/// Takes where a picture lies.
///
/// # Errors
/// A number out of range, or a wrap that there is not.
pub fn placement(of: &mut Table) -> Result<Placement> {
    let scale = of.two("scale", Range::ANY)?.unwrap_or(Vec2::ONE);
    let offset = of.two("offset", Range::ANY)?.unwrap_or(Vec2::ZERO);
    let rotation = of.number("rotation", Range::ANY)?.unwrap_or(0.0);
    let wrap: Wrap = of.choice("wrap")?.unwrap_or_default();
    Ok(Placement {
        set: of.whole("set", 0, 1)?.unwrap_or(0),
        wrap: [wrap; 2],
        nearest: of.flag("nearest")?.unwrap_or(false),
        ..Placement::default().transformed(scale, rotation, offset)
    })
}
