//! What is between surfaces, as kernels read it.

use eyerays_shader::data::{Filling, Media as Bits, Medium as MediumRecord, pack};
use glam::{DVec3, Vec3};

use super::grids;
use super::normalisation::{Normalisation, flushed};
use crate::error::{Error, Result};
use crate::memory::Room;
use crate::scene::{Absorption, Grid, Material, Medium, Scene, Temperature, Volume};

/// The media of a scene, and which material is filled with which.
#[derive(Default)]
pub struct Media {
    /// Records by their numbers, which begin with 1.
    pub records: Vec<MediumRecord>,
    /// By material.
    pub fillings: Vec<Filling>,
    /// Words of their grids.
    pub grids: Vec<u32>,
    /// The number of the medium outside of all surfaces, 0 for none.
    pub fog: u32,
    /// What of it kernels are compiled for.
    pub bits: Bits,
}

impl Media {
    /// Those of a scene; nothing of one without.
    ///
    /// # Errors
    /// There are too many, or a grid is too large.
    pub fn of(scene: &Scene, normalisation: &Normalisation) -> Result<Media> {
        let volumes = || scene.materials.iter().filter_map(|material| material.volume.as_ref());
        if scene.fog.is_none() && volumes().next().is_none() {
            let fillings = vec![Filling::default(); scene.materials.len()];
            return Ok(Media { fillings, ..Media::default() });
        }
        let mut tables =
            Tables { normalisation, records: Vec::new(), grids: Vec::new(), placed: Vec::new(), glowing: Vec::new() };
        let fog = match &scene.fog {
            Some(fog) => tables.number(record(fog, DVec3::ZERO, (0, 1.0), normalisation.scale))?,
            None => 0,
        };
        let fillings = scene.materials.iter().map(|material| tables.filling(material)).collect::<Result<_>>()?;
        let glows = |medium: &Medium| medium.emission != Vec3::ZERO;
        let is_hot = |volume: &Volume| volume.temperature.is_some() || glows(&volume.medium);
        let bit = |bit, holds: bool| if holds { bit } else { 0 };
        let bends = |record: &&MediumRecord| record.emission.w != 1.0f32.to_bits();
        let is_nested = tables.records.iter().filter(bends).count() > 1;
        let bits = Bits(
            Bits::PRESENT
                | bit(Bits::NESTED, is_nested)
                | bit(Bits::OPEN, volumes().any(|volume| !volume.interface))
                | bit(Bits::GRIDS, volumes().any(Volume::has_grid))
                | bit(Bits::GLOWING, volumes().any(is_hot) || scene.fog.iter().any(glows)),
        );
        let Tables { records, mut grids, .. } = tables;
        // Blocks that turned out even need no room for their corners.
        grids.shrink_to_fit();
        Ok(Media { records, fillings, grids, fog, bits })
    }
}

/// The tables of media while they are made.
struct Tables<'a> {
    normalisation: &'a Normalisation,
    records: Vec<MediumRecord>,
    grids: Vec<u32>,
    /// Grids, and their first words.
    placed: Vec<(&'a Grid, u32)>,
    /// The greatest number of a grid of temperatures and its kelvins, and the first word of the table of their light.
    glowing: Vec<([f32; 2], u32)>,
}

impl<'a> Tables<'a> {
    fn filling(&mut self, material: &'a Material) -> Result<Filling> {
        let scale = self.normalisation.scale;
        let Some(volume) = &material.volume else {
            // Fog ends at the surface of clear glass, too.
            let clear = record(&Medium::default(), DVec3::ZERO, (0, material.ior), scale);
            return if material.lets_light_in() {
                Ok(Filling::new(self.number(clear)?, false))
            } else {
                Ok(Filling::default())
            };
        };
        let absorption = material.physical.and_then(|physical| physical.absorption).map_or(DVec3::ZERO, coefficient);
        let ior = if volume.interface { material.ior } else { 1.0 };
        let mut record = record(&volume.medium, absorption, (volume.priority.into(), ior), scale);
        if let Some(grid) = &volume.density {
            record = record.with_grid(self.grid(grid)?);
        }
        if let Some(Temperature { grid, kelvins }) = &volume.temperature {
            let at = self.grid(grid)?;
            record = record.with_temperature(at, self.glow(at, *kelvins)?);
        }
        Ok(Filling::new(self.number(record)?, !volume.interface))
    }

    /// The first word of a grid, which several media share.
    fn grid(&mut self, grid: &'a Grid) -> Result<u32> {
        let known = self.placed.iter().find(|(other, _)| std::ptr::eq(*other, grid) || *other == grid);
        if let Some((_, at)) = known {
            return Ok(*at);
        }
        let at = self.grids.len() as u32;
        grids::append(grid, self.normalisation, Room::now(), &mut self.grids)?;
        self.placed.push((grid, at));
        Ok(at)
    }

    /// The first word of the table of the light of a grid's temperatures, which grids that are as hot share.
    fn glow(&mut self, grid: u32, kelvins: f32) -> Result<u32> {
        let hottest = [grids::greatest(&self.grids, grid), kelvins];
        if let Some((_, at)) = self.glowing.iter().find(|(other, _)| *other == hottest) {
            return Ok(*at);
        }
        let at = self.grids.len() as u32;
        grids::append_glow(hottest[0], kelvins, Room::now(), &mut self.grids)?;
        self.glowing.push((hottest, at));
        Ok(at)
    }

    /// The number of a medium, which those of several materials share that are alike.
    fn number(&mut self, record: MediumRecord) -> Result<u32> {
        let place = self.records.iter().position(|other| *other == record);
        let place = place.unwrap_or_else(|| {
            self.records.push(record);
            self.records.len() - 1
        });
        if self.records.len() > Filling::MOST as usize {
            let most = Filling::MOST;
            return Err(Error::new(format!("the scene has more than {most} media: let materials share theirs")));
        }
        Ok(place as u32 + 1)
    }
}

/// The absorption coefficient of what leaves so much of light.
fn coefficient(Absorption { colour, distance }: Absorption) -> DVec3 {
    let depth = Absorption::depth;
    DVec3::new(depth(colour.x), depth(colour.y), depth(colour.z)) / f64::from(distance)
}

/// A record, with what is absorbed beside.
fn record(of: &Medium, absorbed: DVec3, (priority, ior): (u32, f32), scale: f64) -> MediumRecord {
    /// Beyond this nothing is seen through anything, and products with lengths overflow.
    const MOST: f64 = 1e24;
    let (scattering, absorption) = (of.scattering.as_dvec3(), of.absorption.as_dvec3() + absorbed);
    let all = scattering + absorption;
    let extinction = (all / scale).min(DVec3::splat(MOST)).as_vec3();
    let share = |part: f64, all: f64| if all > 0.0 { part / all } else { 0.0 };
    let albedo = DVec3::new(share(scattering.x, all.x), share(scattering.y, all.y), share(scattering.z, all.z));
    MediumRecord {
        extinction: pack(flushed(extinction), priority),
        albedo: pack(flushed(albedo.as_vec3()), of.anisotropy.to_bits()),
        emission: pack(flushed(of.emission), ior.to_bits()),
        density: Default::default(),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use eyerays_shader::data::GlowTable;

    use super::*;

    /// The media of a scene whose first materials glow with so many kelvins.
    fn hot(grid: &Arc<Grid>, kelvins: &[f32]) -> Media {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/whitted.toml");
        let mut scene = crate::scene_io::load(path.as_ref()).unwrap().0;
        let of = Medium { absorption: Vec3::ONE, emission: Vec3::ONE, ..Medium::default() };
        for (material, &kelvins) in scene.materials.iter_mut().zip(kelvins) {
            let temperature = Some(Temperature { grid: grid.clone(), kelvins });
            material.volume = Some(Volume { temperature, ..Volume::open(of) });
        }
        Media::of(&scene, &Normalisation { origin: Vec3::ZERO, scale: 1.0 }).unwrap()
    }

    #[test]
    fn grids_of_temperatures_and_tables_of_their_light_are_shared() {
        let grid = Arc::new(Grid::dense("fire", [1, 1, 2], &[1.0, 2.0], [DVec3::ZERO, DVec3::ONE]));
        let (one, same, other) = (hot(&grid, &[900.0]), hot(&grid, &[900.0; 2]), hot(&grid, &[900.0, 800.0]));
        assert!(one.bits.has(Bits::GRIDS) && one.bits.has(Bits::GLOWING));
        assert_eq!(one.grids, same.grids);
        assert_eq!(other.grids.len() - one.grids.len(), GlowTable::WORDS as usize);
        let tables: Vec<u32> =
            other.records.iter().filter(|record| record.has_temperature()).map(|record| record.density.z).collect();
        let first = one.grids.len() as u32 - GlowTable::WORDS;
        assert_eq!(tables, [first, first + GlowTable::WORDS]);
        // Each number of the grid is half of all steps.
        assert_eq!(f32::from_bits(one.grids[first as usize]), 127.5);
    }
}
