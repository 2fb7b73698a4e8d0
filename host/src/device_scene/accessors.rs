//! What a packed scene holds, to be read.

use std::time::Duration;

use eyerays_bvh::{Bvh8, Quality, Statistics};
use eyerays_shader::data::{
    Bounds, CentredPair, CwbvhNode, Effects, Filling, Finish, Finishes, Instance as InstanceRecord,
    Light as LightRecord, Material as MaterialRecord, Media as MediaBits, Medium as MediumRecord, Normals,
    Physical as PhysicalRecord, Primitive,
};

use glam::UVec4;

use super::spectra::Spectra;
use super::{DeviceScene, Feature, Lighting, Movement, Normalisation, Textures, hierarchy, records, two_levels};
use crate::error::{Error, Result};
use crate::method::Method;
use crate::optics::Optics;
use crate::scene::{LightGroups, Settings};

impl DeviceScene {
    /// Child pairs of the hierarchy. Where a device may build its own they are built when they are first asked for.
    pub fn nodes(&self) -> &[CentredPair] {
        self.nodes.get_or_init(|| hierarchy::in_place(&self.primitives))
    }

    /// May a device build the hierarchy, over triangles in any order?
    pub(crate) fn is_left_open(&self) -> bool {
        self.quality.0 == Quality::Linear && self.top.0 == 0
    }

    /// Its pairs, where references behind them lead to copies.
    pub(crate) fn pairs(&self) -> u32 {
        if self.instances.is_empty() { 0 } else { self.nodes().len() as u32 }
    }

    /// The same hierarchy with nodes of eight children, none unless it was packed [`with_wide_nodes`](Self::with_wide_nodes).
    pub fn wide(&self) -> &[CwbvhNode] {
        &self.wide
    }

    /// Refuses a method of a GPU that walks what was not packed.
    ///
    /// # Errors
    /// There are no wide nodes.
    pub(crate) fn check_walks(&self, method: Method) -> Result<()> {
        if method == Method::Wide && self.wide.is_empty() {
            return Err(Error::new(
                "wide walks nodes that the scene was packed without: pack it by Job::with_wide_nodes",
            ));
        }
        Ok(())
    }

    /// The same hierarchy with nodes of eight children as a CPU loads them: made when it is first asked for.
    pub fn bvh8(&self) -> &Bvh8 {
        self.bvh8.get_or_init(|| {
            let (pairs, slots) = self.top;
            let (primitives, bounds) = (&self.primitives[..slots], self.bounds.get(..slots).unwrap_or_default());
            if self.instances.is_empty() {
                return Bvh8::of(self.nodes(), primitives, bounds);
            }
            Bvh8::of(&two_levels::leaves(self.nodes(), pairs, primitives), primitives, bounds)
        })
    }

    /// Primitives in leaf order, in the normalised scene; a split triangle has several places. Those of shared meshes come last, each in
    /// its own cube.
    pub fn primitives(&self) -> &[Primitive] {
        &self.primitives
    }

    /// What moves while the shutter is open.
    pub(crate) fn movement(&self) -> &Movement {
        &self.movement
    }

    /// Copies of meshes, each that moves with its keys, and the keys of cameras.
    pub fn instances(&self) -> &[InstanceRecord] {
        &self.instances
    }

    /// Bounds in leaf order; empty unless triangles are split.
    pub fn bounds(&self) -> &[Bounds] {
        &self.bounds
    }

    /// Vertex normals in leaf order; empty if every mesh is flat.
    pub fn normals(&self) -> &[Normals] {
        &self.normals
    }

    /// Materials.
    pub fn materials(&self) -> &[MaterialRecord] {
        &self.materials
    }

    /// Materials by microfacets; empty if there are none.
    pub fn physicals(&self) -> &[PhysicalRecord] {
        &self.physicals
    }

    /// What physical materials have beside base, facets and what passes; empty if none has any of it.
    pub fn finishes(&self) -> &[Finish] {
        &self.finishes
    }

    /// Where photons are sent; empty if nothing casts caustics.
    pub(crate) fn casters(&self) -> &[UVec4] {
        &self.casters
    }

    /// What kernels are compiled for that know of what lies on materials.
    pub(crate) fn finish_bits(&self) -> Finishes {
        self.finish_bits
    }

    /// What is between surfaces: media by their numbers, from 1 on.
    pub fn media(&self) -> &[MediumRecord] {
        &self.media.records
    }

    /// Words of the grids in which some are denser.
    pub fn grids(&self) -> &[u32] {
        &self.media.grids
    }

    /// What is inside of surfaces, by material.
    pub(crate) fn fillings(&self) -> &[Filling] {
        &self.media.fillings
    }

    /// The number of the medium outside of all surfaces; 0 for none.
    pub(crate) fn fog(&self) -> u32 {
        self.media.fog
    }

    /// What kernels are compiled for that know what is between surfaces.
    pub(crate) fn media_bits(&self) -> MediaBits {
        self.media.bits
    }

    /// What covers surfaces.
    pub fn textures(&self) -> &Textures {
        &self.textures
    }

    /// Light from far away, see [`eyerays_shader::light::Environment`]; empty if there is none.
    pub fn environment(&self) -> &[u32] {
        &self.environment
    }

    /// The spectra that its things have of their own.
    pub(crate) fn own_spectra(&self) -> &Spectra {
        &self.spectra
    }

    /// Lights in file order.
    pub fn lights(&self) -> &[LightRecord] {
        &self.lights
    }

    /// What an integrator chooses from that samples one light of all.
    pub fn lighting(&self) -> &Lighting {
        &self.lighting
    }

    /// The effects that it has which some settings ask for.
    pub(crate) fn asked(&self, settings: &Settings) -> Effects {
        records::asked(self.effects, settings)
    }

    /// Those that matter to a feature.
    pub(crate) fn shown(&self, feature: Feature) -> Effects {
        feature.asked(self.effects)
    }

    /// A material that emits, by its name.
    pub(crate) fn emissive(&self) -> Option<&str> {
        self.emissive.as_deref()
    }

    /// Are some materials not lit by all lamps?
    pub(crate) fn is_linked(&self) -> bool {
        self.effects.has(Effects::LINKED)
    }

    /// Its groups of lamps.
    pub fn light_groups(&self) -> &LightGroups {
        &self.groups
    }

    /// The number of the group that its surroundings are in.
    pub(crate) fn background_group(&self) -> u32 {
        self.background_group
    }

    /// Are some objects shadow catchers?
    pub(crate) fn has_catchers(&self) -> bool {
        self.has_catchers
    }

    /// Are some objects no part of a picture?
    pub(crate) fn has_mattes(&self) -> bool {
        self.has_catchers || self.effects.has(Effects::HOLDOUT)
    }

    /// How the scene became what kernels take.
    pub fn normalisation(&self) -> &Normalisation {
        &self.normalisation
    }

    /// How many triangles, spheres, disks and copies there are, each once.
    pub fn primitive_count(&self) -> usize {
        self.statistics.get().map_or(self.primitives.len(), |statistics| statistics.primitives)
    }

    /// The hierarchy's figures; of one that a device builds, those of the same built here.
    pub fn statistics(&self) -> &Statistics {
        self.statistics.get_or_init(|| hierarchy::statistics(&self.primitives))
    }

    /// What it holds of each kind, in bytes, with what a CPU makes of it.
    pub fn bytes(&self) -> [(&'static str, usize); 9] {
        [
            ("node pairs", size_of_val(self.nodes())),
            ("wide nodes", size_of_val(&self.wide[..])),
            ("primitives", size_of_val(&self.primitives[..])),
            ("copies", size_of_val(&self.instances[..])),
            ("own boxes", size_of_val(&self.bounds[..])),
            ("normals", size_of_val(&self.normals[..])),
            ("textures", self.textures.bytes()),
            ("environment", size_of_val(&self.environment[..])),
            ("nodes and leaves of a CPU", self.bvh8().bytes()),
        ]
    }

    /// What building the hierarchy took.
    pub fn build_time(&self) -> Duration {
        self.build_time
    }

    /// What its cameras need.
    pub(crate) fn optics(&self) -> &Optics {
        &self.optics
    }
}
