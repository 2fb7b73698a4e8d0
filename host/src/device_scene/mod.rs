//! From a scene in world units to the records that devices hold.

use std::sync::OnceLock;
use std::time::{Duration, Instant};

use eyerays_bvh::{Bvh8, Quality, Statistics};
use eyerays_shader::data::{
    Bounds, CentredPair, CwbvhNode, Effects, Finish, FinishMaps, Finishes, Instance as InstanceRecord,
    Light as LightRecord, Material as MaterialRecord, Normals, Physical as PhysicalRecord, Primitive,
};
use glam::UVec4;

mod accessors;
mod alias;
mod boxes;
mod casters;
mod copies;
mod environment;
mod feature;
mod flags;
mod frame;
mod grids;
mod hierarchy;
mod keys;
mod levels;
mod light_tree;
mod lighting;
mod media;
mod moved;
mod normalisation;
mod records;
mod shining;
mod spectra;
mod tangents;
mod textures;
mod two_levels;
mod view;
mod words;

pub use boxes::NodeBox;
pub(crate) use casters::extent as casters_extent;
pub use copies::fitted;
pub(crate) use copies::{unfit_objects, unfit_triangles};
pub use feature::Feature;
pub use hierarchy::hierarchy;
pub use lighting::Lighting;
pub use normalisation::Normalisation;
pub(crate) use normalisation::{flushed, flushed_number};
pub(crate) use tangents::made_tangents;
pub use textures::Textures;
pub use view::SceneView;
pub use words::{NodeWords, PrimitiveWords};

use hierarchy::{centred, gathered};
pub(crate) use keys::Movement;
use keys::Way;
use lighting::Lamps;
use media::Media;
use spectra::Spectra;
use two_levels::Levels;

use crate::error::{Error, Result};
use crate::memory::Room;
use crate::optics::Optics;
use crate::scene::{Background, Light, LightGroups, Matte, Scene};

/// A scene as the kernels read it, owned. Whatever it was made of was checked, and nothing outside can change it, since
/// kernels read through its numbers without checking them.
pub struct DeviceScene {
    /// Empty until it is asked for where a device builds its own.
    nodes: OnceLock<Vec<CentredPair>>,
    wide: Vec<CwbvhNode>,
    primitives: Vec<Primitive>,
    instances: Vec<InstanceRecord>,
    movement: Movement,
    /// Pairs and slots of what stands in the world; those of shared meshes follow.
    top: (usize, usize),
    bounds: Vec<Bounds>,
    normals: Vec<Normals>,
    materials: Vec<MaterialRecord>,
    physicals: Vec<PhysicalRecord>,
    finish_bits: Finishes,
    finishes: Vec<Finish>,
    media: Media,
    spectra: Spectra,
    lights: Vec<LightRecord>,
    lighting: Lighting,
    textures: Textures,
    environment: Vec<u32>,
    /// A material that emits, by its name.
    emissive: Option<String>,
    groups: LightGroups,
    /// The group of the surroundings.
    background_group: u32,
    has_catchers: bool,
    lamps: Lamps,
    /// Where photons are sent, see [`eyerays_shader::photon::Casters`].
    casters: Vec<UVec4>,
    /// Those of any settings.
    effects: Effects,
    background: Background,
    optics: Optics,
    normalisation: Normalisation,
    /// Likewise.
    statistics: OnceLock<Statistics>,
    /// How its hierarchy is built, and whether with nodes of eight children.
    quality: (Quality, bool),
    /// Was it fitted to this scene, from the hierarchy of another moment?
    is_fitted: bool,
    /// What that cost by the surface area heuristic when it was built.
    built_cost: f64,
    build_time: Duration,
    bvh8: OnceLock<Bvh8>,
}

impl DeviceScene {
    /// Normalises, builds the hierarchy or takes the one that the scene brings along, and packs. All methods follow rays through
    /// it but [`Method::Wide`](crate::method::Method::Wide) on a GPU.
    ///
    /// # Errors
    /// A mesh that names vertices or materials which are not there. What no device could hold or no ray meet: too many triangles,
    /// a light too far away for the scene's numbers.
    pub fn new(scene: &Scene, quality: Quality) -> Result<DeviceScene> {
        scene.check()?;
        Self::of_checked(scene, quality, false, None)
    }

    /// As [`DeviceScene::new`], with the nodes of eight children beside that a GPU walks by
    /// [`Method::Wide`](crate::method::Method::Wide).
    ///
    /// # Errors
    /// As there.
    pub fn with_wide_nodes(scene: &Scene, quality: Quality) -> Result<DeviceScene> {
        scene.check()?;
        Self::of_checked(scene, quality, true, None)
    }

    /// Of a scene that was checked; `is_wide` with nodes of eight children, too; by the hierarchy of the scene as it was `before`, if
    /// that will do.
    ///
    /// # Errors
    /// As [`DeviceScene::new`].
    pub(crate) fn of_checked(
        scene: &Scene,
        quality: Quality,
        is_wide: bool,
        before: Option<&DeviceScene>,
    ) -> Result<DeviceScene> {
        let emissive = scene.emissive().map(str::to_owned);
        let effects = records::effects(scene);
        let normalisation = normalisation(scene);
        let start = Instant::now();
        let Levels { bvh, top, primitives, mut instances, places, bends, statistics, is_split, is_fitted } =
            Levels::new(scene, &normalisation, (quality, is_wide), before)?;
        let own_cost = statistics.map_or(0.0, |statistics| statistics.sah_cost);
        let built_cost = before.filter(|_| is_fitted).map_or(own_cost, |before| before.built_cost);
        let movement = Movement::new(scene, &normalisation, &mut instances)?;
        let build_time = start.elapsed();
        let groups = LightGroups::of(scene);
        let media = Media::of(scene, &normalisation)?;
        let spectra = Spectra::of(scene)?;
        let material =
            |(m, &filling)| records::material(m, filling, groups.unlit(m), (scene.ambient, normalisation.scale));
        // One thing after the other, so that no more lies in memory than must.
        let nodes = centred(bvh.nodes);
        let mut primitives = gathered(primitives, &bvh.order);
        let mut normals = if effects.has(Effects::SMOOTH) { records::normals(scene, &bvh.order) } else { Vec::new() };
        let physical = |m| records::physical(m, normalisation.scale, &spectra);
        let physicals =
            if effects.has(Effects::PHYSICAL) { scene.materials.iter().map(physical).collect() } else { Vec::new() };
        let lights = lights(&scene.lights, &normalisation, (&movement.ways, &spectra))?;
        let mut textures = Textures::new(scene, effects, &bvh.order)?;
        let finish_bits = records::finish_bits(scene);
        let maps = |material: usize| textures.finish_maps.get(material).copied().unwrap_or(FinishMaps::NONE);
        let finish = |(material, m)| records::finish(m, maps(material), &spectra);
        let finishes =
            if finish_bits.any() { scene.materials.iter().enumerate().map(finish).collect() } else { Vec::new() };
        bends.shape((scene, &normalisation), &bvh.order, (&mut primitives, &mut normals, &mut textures.tangents));
        let far = scene.environment.as_ref().map(|of| environment::words(of, Room::now())).transpose()?;
        let (environment, far_light) = far.map_or((Vec::new(), None), |(words, light)| (words, Some(light)));
        let background_group = groups.number(&scene.background_group);
        let shining = shining::of(scene, &normalisation, (&primitives, top.1), (&instances, &places))?;
        let casters = casters::of(scene, &normalisation, (&primitives, top.1), (&instances, &places));
        let lamps = Lamps::new((&scene.materials, &groups, &spectra), &shining, (&textures, far_light));
        let dark = if lamps.is_empty() { Effects::EMISSIVE } else { 0 };
        let lighting = Lighting::new(
            (&scene.lights, &lights, &movement.ways),
            &lamps,
            (&groups, background_group),
            &normalisation,
        );
        let many = if lighting.nodes.is_empty() { 0 } else { Effects::MANY_LIGHTS };
        Ok(DeviceScene {
            quality: (quality, is_wide),
            is_fitted,
            built_cost,
            statistics: statistics.map_or_else(OnceLock::new, OnceLock::from),
            primitives,
            instances,
            movement,
            top,
            normals,
            nodes: if nodes.is_empty() { OnceLock::new() } else { OnceLock::from(nodes) },
            wide: bvh.wide,
            bounds: if is_split { bvh.bounds } else { Vec::new() },
            materials: scene.materials.iter().zip(&media.fillings).map(material).collect(),
            media,
            spectra,
            physicals,
            finish_bits,
            finishes,
            lights,
            lighting,
            textures,
            environment,
            emissive,
            groups,
            background_group,
            has_catchers: flags::mattes(scene).any(|matte| matte == Matte::Catcher),
            lamps,
            casters,
            effects: Effects(effects.0 & !dark | many),
            background: scene.background,
            optics: Optics::of(&scene.cameras),
            normalisation,
            build_time,
            bvh8: OnceLock::new(),
        })
    }

    /// The records of other lights for the same kernels: as many, of the same kinds. Those that move while the shutter is open stay on
    /// their way.
    ///
    /// # Errors
    /// They are others, or too far away.
    pub fn relit(&self, others: &[Light]) -> Result<(Vec<LightRecord>, Lighting)> {
        let records = lights(others, &self.normalisation, (&self.movement.ways, &self.spectra))?;
        let kinds = |lights: &[LightRecord]| lights.iter().map(|light| light.position.w).collect::<Vec<_>>();
        if kinds(&records) != kinds(&self.lights) {
            let number = self.lights.len();
            return Err(Error::new(format!(
                "the scene was packed with {number} lights of other kinds: pack it again to change more than their values"
            )));
        }
        let groups = (&self.groups, self.background_group);
        let lighting = Lighting::new((others, &records, &self.movement.ways), &self.lamps, groups, &self.normalisation);
        Ok((records, lighting))
    }
}

fn normalisation(scene: &Scene) -> Normalisation {
    // The cells of a checkerboard are counted from the world's origin.
    let moves = !records::effects(scene).has(Effects::CHECKER);
    Normalisation::of(scene.extremes(), moves)
}

/// Records of lights, of which some move.
fn lights(
    lights: &[Light],
    normalisation: &Normalisation,
    (ways, spectra): (&[Way], &Spectra),
) -> Result<Vec<LightRecord>> {
    let record = |(i, light): (usize, &Light)| {
        let mut record = records::light(light, i, normalisation)?;
        record.position.w |= spectra.light(light.illuminant()) << LightRecord::ILLUMINANT;
        Ok(record)
    };
    let mut records: Vec<LightRecord> = lights.iter().enumerate().map(record).collect::<Result<_>>()?;
    for way in ways {
        if let Some(record) = records.get_mut(way.light) {
            record.position.w |= (way.first + 1) << LightRecord::KEYS;
        }
    }
    Ok(records)
}
