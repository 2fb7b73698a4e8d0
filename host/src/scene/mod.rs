//! A scene in world units, as files describe it and before anything is packed for a device. [`scene_io`](crate::scene_io) reads and
//! writes it.

mod animation;
mod camera;
mod check;
mod copies;
pub mod displace;
mod environment;
pub(crate) mod extent;
mod falloff;
mod filter;
mod finish;
pub(crate) mod frame;
mod grid;
pub(crate) mod hierarchy;
mod idle;
mod instance;
mod lens;
mod light_groups;
mod matrices;
mod medium;
mod motion;
pub(crate) mod normal;
mod object;
mod physical;
mod pixel_filter;
mod primitive;
mod projection;
mod range;
mod sampler;
mod seen;
mod stereo;
pub(crate) mod studio;
pub mod subdivide;
mod texture;
mod transport;
mod visibility;

pub use animation::Animation;
pub use camera::Camera;
pub use environment::Environment;
pub use falloff::Falloff;
pub use filter::Filter;
pub use finish::{Coat, DiffuseTransmission, Sheen, ThinFilm};
pub use frame::{default_camera, without_spare_lamps};
pub use grid::{Grid, LEAF, Leaf};
pub use hierarchy::Hierarchy;
pub use instance::{Instance, SharedMesh};
pub use lens::{Focus, Lens};
pub use light_groups::LightGroups;
pub use medium::{Medium, Volume};
pub use motion::{Motion, Moved, Pose, Shape};
pub use object::{Object, ObjectNumbers};
pub use physical::{Absorption, Conductor, Physical, Wall};
pub use pixel_filter::PixelFilter;
pub use primitive::{Disk, Primitives, Sphere};
pub use projection::{Mapping, Projection};
pub use range::Range;
pub use sampler::Sampler;
pub use stereo::{Stereo, StereoLayout};
pub use texture::{Alpha, FinishMaps, Map, Maps, Placement, Texels, Texture, Wrap};
pub use transport::{Direct, Integrator, Transport};
pub use visibility::{Matte, Visibility};

use eyerays_shader::data::NodeRef;
use glam::{DVec3, Vec2, Vec3, Vec4};
use serde::{Deserialize, Serialize};

use crate::choice::Named;
use crate::error::{self, Error};

/// The result of a check that does not know whose line it checks: the error is a fault and its remedy.
pub(crate) type Unplaced<T> = Result<T, String>;

/// The most triangles, spheres and disks that a scene may have together: traversal numbers them in the bits that a node
/// reference has.
pub const MAX_PRIMITIVES: usize = NodeRef::MAX_INDEX as usize;

/// All that a picture is made from. Everything in it is finite and in range: a [`Job`](crate::job::Job) refuses the rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Every surface of triangles, merged: first what stands where it is, in world units, then what [`Scene::shared`] says.
    pub mesh: Mesh,
    /// Meshes that stand in several places: the last vertices and triangles of [`Scene::mesh`], one after the other.
    pub shared: Vec<SharedMesh>,
    /// Where they stand. Where primitives are numbered, the triangles of copies follow those that stand where they are.
    pub instances: Vec<Instance>,
    /// Whole spheres. Where primitives are numbered, they follow all triangles.
    pub spheres: Vec<Sphere>,
    /// Disks, which follow the spheres.
    pub disks: Vec<Disk>,
    /// Which triangles, spheres and disks came of what, in file order; together all of them.
    pub objects: Vec<Object>,
    /// How the file that it came from may move; it has the shape of one moment.
    pub animations: Vec<Animation>,
    /// The meshes, material files and pictures that it was read from, beside the scene file itself.
    pub files: Vec<std::path::PathBuf>,
    /// What the mesh's materials index; never empty.
    pub materials: Vec<Material>,
    /// In file order, which is the order of their sums.
    pub lights: Vec<Light>,
    /// Never empty; a bare mesh gets one that frames it.
    pub cameras: Vec<Camera>,
    /// What a ray that leaves the scene sees.
    pub background: Background,
    /// Light from far away, which takes the background's place.
    pub environment: Option<Environment>,
    /// The group of lamps that the background or the environment is in, empty for none.
    pub background_group: String,
    /// What is everywhere outside of closed surfaces, if anything is.
    pub fog: Option<Medium>,
    /// Ambient light, linear RGB; times a material's ambient colour.
    pub ambient: Vec3,
    /// What the scene file asks of a rendering; the command line has the last word.
    pub settings: Settings,
    /// What moves while the shutter is open, if anything does.
    pub motion: Option<Motion>,
    /// What a binary scene brings along to be built no more. It is of this geometry alone: who changes that sets this to
    /// `None`, or the scene is refused.
    pub hierarchy: Option<Hierarchy>,
}

impl Scene {
    /// How many triangles, spheres and disks are seen: those of copies as often as they are copied.
    pub fn primitives(&self) -> u64 {
        (self.own_triangles() + self.spheres.len() + self.disks.len()) as u64 + self.copied_triangles()
    }

    /// The first material that emits, by its name.
    pub(crate) fn emissive(&self) -> Option<&str> {
        self.materials.iter().find(|material| material.emission != Vec3::ZERO).map(|material| material.name.as_str())
    }

    /// Bytes of its geometry.
    pub fn bytes(&self) -> usize {
        let Mesh { positions, normals, triangles, materials, coordinates, tangents, colours } = &self.mesh;
        let mesh = [
            size_of_val(&self.instances[..]),
            size_of_val(&coordinates[0][..]),
            size_of_val(&coordinates[1][..]),
            size_of_val(&tangents[..]),
            size_of_val(&colours[..]),
            size_of_val(&positions[..]),
            size_of_val(&normals[..]),
            size_of_val(&triangles[..]),
            size_of_val(&materials[..]),
        ];
        mesh.iter().sum::<usize>() + size_of_val(&self.spheres[..]) + size_of_val(&self.disks[..])
    }
}

/// An indexed triangle mesh.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// Vertex positions in world units.
    pub positions: Vec<Vec3>,
    /// Vertex normals of unit length; a zero stands for "flat here". As many as positions, or none at all.
    pub normals: Vec<Vec3>,
    /// Three vertices each, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// One index into [`Scene::materials`] a triangle.
    pub materials: Vec<u32>,
    /// Two sets of texture coordinates, the second down; each as many as positions, or none at all.
    pub coordinates: [Vec<Vec2>; 2],
    /// Unit tangents along the first texture coordinate, and the sign of the bitangent (the cross product of normal and tangent times
    /// it); zeros for none. As many as positions, or none at all.
    pub tangents: Vec<Vec4>,
    /// Colours that base and diffuse colours are multiplied with, linear RGB and opacity in [0, 1]. As many as positions, or none
    /// at all.
    pub colours: Vec<Vec4>,
}

impl Mesh {
    /// The least and the greatest corner of the vertices, in their units; zeros where there are none.
    pub fn bounds(&self) -> [Vec3; 2] {
        extent::of(self.positions.iter().copied())
    }
}

/// The thesis' illumination model (chapters 3.1 and 3.3); colours are linear RGB in [0, 1].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// By this name a scene file overrides it.
    pub name: String,
    /// Answer to the scene's ambient light, if it is not the diffuse colour.
    pub ambient: Option<Vec3>,
    /// Lambert's diffuse colour.
    pub diffuse: Vec3,
    /// Phong's specular colour.
    pub specular: Vec3,
    /// Phong's exponent, at least 0.
    pub shininess: f32,
    /// Share of the mirrored ray that an opaque surface adds.
    pub reflection: Vec3,
    /// What of the light passes, weighted by Fresnel's equations; zero is opaque.
    pub transmission: Vec3,
    /// Index of refraction of the inside, in [1, 4]; of use where `transmission` is not zero.
    pub ior: f32,
    /// A second diffuse colour in cells of a checkerboard.
    pub checker: Option<Checker>,
    /// Radiance that it sends out, linear RGB, at least 0.
    pub emission: Vec3,
    /// Does its back emit too? Culling leaves it.
    pub two_sided: bool,
    /// The group of lamps that what is made of it is in, empty for none.
    #[serde(default)]
    pub group: String,
    /// The groups of lamps that light it, [`LightGroups::REST`] for those without one; all if none is said. Paths tell.
    #[serde(default)]
    pub lit_by: Option<Vec<String>>,
    /// Is the emission multiplied with the colours of vertices?
    #[serde(default)]
    pub emission_is_coloured: bool,
    /// How it scatters where integrators sample it; without this as the rest says.
    pub physical: Option<Physical>,
    /// What is inside of its closed surfaces, if anything is.
    #[serde(default)]
    pub volume: Option<Volume>,
    /// Its textures.
    #[serde(skip)]
    pub maps: Maps,
    /// Who sees what is made of it.
    #[serde(default)]
    pub visibility: Visibility,
    /// How opaque it is.
    #[serde(default)]
    pub alpha: Alpha,
    /// The opacity in [0, 1] that `alpha` asks for, where its texture has 1.
    #[serde(default = "opaque")]
    pub opacity: f32,
}

fn opaque() -> f32 {
    1.0
}

/// A procedural checkerboard over the surface's two major axes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Checker {
    /// The diffuse colour of every second cell; the others have the material's.
    pub colour: Vec3,
    /// The answer of those cells to the scene's ambient light.
    pub ambient: Vec3,
    /// A cell's edge in world units.
    pub size: f32,
}

/// A light without extent; `colour` is linear RGB times intensity, at least 0.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Light {
    /// Shines every way from a place.
    Point {
        /// World units.
        position: Vec3,
        /// Linear RGB times intensity.
        colour: Vec3,
        /// The group that it is in, empty for none.
        #[serde(default)]
        group: String,
    },
    /// Shines one way from infinitely far.
    Directional {
        /// The way light travels; not zero.
        direction: Vec3,
        /// Linear RGB times intensity.
        colour: Vec3,
        /// The group that it is in, empty for none.
        #[serde(default)]
        group: String,
    },
    /// Shines into a cone.
    Spot {
        /// World units.
        position: Vec3,
        /// A point on the cone's axis; not the position.
        target: Vec3,
        /// Linear RGB times intensity.
        colour: Vec3,
        /// Half the angle of the full cone in degrees, in (0, 90).
        outer: f32,
        /// Half the angle of the cone of full light, in [0, outer].
        inner: f32,
        /// How it fades between them.
        #[serde(default)]
        falloff: Falloff,
        /// The group that it is in, empty for none.
        #[serde(default)]
        group: String,
    },
}

impl Material {
    /// Do its surfaces need tangents?
    pub(crate) fn has_axes(&self) -> bool {
        let turns_normals = self.maps.normal.is_some() || self.maps.finish.coat_normal.is_some();
        turns_normals || self.physical.is_some_and(|p| p.anisotropy > 0.0)
    }
}

impl Light {
    /// The group that it is in, empty for none.
    pub fn group(&self) -> &str {
        let (Light::Point { group, .. } | Light::Directional { group, .. } | Light::Spot { group, .. }) = self;
        group
    }

    /// Where it is and which way it shines, where it does not shine every way.
    pub(crate) fn stance(&self) -> (Vec3, Option<DVec3>) {
        let way = |from: Vec3, to: Vec3| Some((to.as_dvec3() - from.as_dvec3()).normalize_or_zero());
        match *self {
            Light::Point { position, .. } => (position, None),
            Light::Directional { direction, .. } => (Vec3::ZERO, way(Vec3::ZERO, direction)),
            Light::Spot { position, target, .. } => (position, way(position, target)),
        }
    }

    /// Is it of the kind of another, where that is, turned alike?
    pub(crate) fn stands_as(&self, other: &Light) -> bool {
        self.is_as(other) && self.stance() == other.stance()
    }

    /// Is it of the kind of another?
    pub(crate) fn is_as(&self, other: &Light) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(other)
    }

    /// The same light in a group.
    #[must_use]
    pub fn in_group(mut self, name: &str) -> Light {
        let (Light::Point { group, .. } | Light::Directional { group, .. } | Light::Spot { group, .. }) = &mut self;
        name.clone_into(group);
        self
    }
}

/// What a ray that hits nothing returns, linear RGB.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Background {
    /// The same every way.
    Colour(Vec3),
    /// From the horizon (and below it) to straight up.
    Gradient {
        /// At the horizon and below.
        horizon: Vec3,
        /// Straight up.
        zenith: Vec3,
    },
}

/// A scene file's `[render]` table.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Image width and height in pixels.
    pub size: (u32, u32),
    /// Samples along a pixel's edge.
    pub samples: u32,
    /// Samples of a pixel; 0 for the square of `samples`.
    pub spp: u32,
    /// Where in a pixel its samples lie.
    pub sampler: Sampler,
    /// The most times a ray is followed on.
    pub bounces: u32,
    /// A ray whose every weight is less is not followed.
    pub min_contribution: f32,
    /// Skip triangles seen from behind.
    pub culling: bool,
    /// Give back what is lost between the facets of physical materials.
    #[serde(default = "always")]
    pub compensation: bool,
    /// How textures are filtered.
    #[serde(default)]
    pub filter: Filter,
    /// How a pixel weighs what is around its middle; without one as the integrator does, see [`Settings::pixel_filter`].
    #[serde(default)]
    pub pixel_filter: Option<PixelFilter>,
    /// Is what the camera sees of the surroundings left out, so that the picture tells how much of it is opaque?
    #[serde(default)]
    pub transparent: bool,
    /// How light is carried.
    pub transport: Transport,
}

fn always() -> bool {
    true
}

impl Settings {
    /// Samples of a pixel.
    pub fn samples_a_pixel(&self) -> u32 {
        if self.spp > 0 { self.spp } else { self.samples * self.samples }
    }

    /// How a pixel weighs what is around its middle: unless it is said, by [`PixelFilter::BlackmanHarris`] where light is sampled, and else
    /// all of the pixel alike.
    pub fn pixel_filter(&self) -> PixelFilter {
        let samples = self.transport.integrator.samples();
        self.pixel_filter.unwrap_or(if samples { PixelFilter::BlackmanHarris } else { PixelFilter::Box })
    }

    /// The edge of the grid that a pixel's samples lie in, 1 without a grid.
    ///
    /// # Errors
    /// That many do not fill one.
    pub fn grid(&self) -> error::Result<u32> {
        if !self.sampler.has_cells() {
            return Ok(1);
        }
        let samples = self.samples_a_pixel();
        let edge = samples.isqrt();
        if edge * edge == samples && edge <= Self::MOST_SAMPLES {
            return Ok(edge);
        }
        let sampler = self.sampler.name();
        let remedy = "make it a square up to 4096, or the sampler sobol or random";
        Err(Error::new(format!("the sampler {sampler} has no grid of {samples} samples a pixel: {remedy}")))
    }

    /// The largest width and height in pixels.
    pub const MOST_SIDE: u32 = crate::picture::Picture::MAX_SIDE;
    /// The most samples along a pixel's edge.
    pub const MOST_SAMPLES: u32 = 64;
    /// The most samples of a pixel, which single precision still counts.
    pub const MOST_SPP: u32 = 1 << 24;
    /// The largest limit of bounces.
    pub const MOST_BOUNCES: u32 = 65_535;
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            size: (512, 512),
            samples: 1,
            spp: 0,
            sampler: Sampler::default(),
            bounces: 5,
            min_contribution: 1.0 / 1024.0,
            culling: false,
            compensation: true,
            filter: Filter::default(),
            pixel_filter: None,
            transparent: false,
            transport: Transport::default(),
        }
    }
}
