//! A scene in world units, as files describe it and before anything is packed for a device. [`scene_io`](crate::scene_io) reads and
//! writes it.

mod animation;
mod background;
pub mod bump;
mod camera;
mod check;
mod copies;
pub mod curves;
pub mod displace;
mod environment;
pub(crate) mod extent;
mod falloff;
mod filter;
mod finish;
pub(crate) mod frame;
mod grid;
mod hair;
pub(crate) mod hierarchy;
mod idle;
mod instance;
mod lens;
mod light;
mod light_groups;
mod material;
mod matrices;
mod medium;
mod mesh;
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
mod settings;
mod stereo;
pub(crate) mod studio;
pub mod subdivide;
mod temperature;
mod texture;
mod transport;
mod visibility;

pub use animation::Animation;
pub use background::Background;
pub use camera::Camera;
pub use environment::Environment;
pub use falloff::Falloff;
pub use filter::Filter;
pub use finish::{Coat, DiffuseTransmission, Sheen, ThinFilm};
pub use frame::{default_camera, without_spare_lamps};
pub use grid::{Grid, LEAF, Leaf, Quantity};
pub use hair::{Hair, Pigment};
pub use hierarchy::Hierarchy;
pub use instance::{Instance, SharedMesh};
pub use lens::{Focus, Lens};
pub use light::Light;
pub use light_groups::LightGroups;
pub use material::{Checker, Material};
pub use medium::{Medium, Volume};
pub use mesh::Mesh;
pub use motion::{Motion, Moved, Pose, Shape};
pub use object::{Object, ObjectNumbers};
pub use physical::{Absorption, Conductor, Physical, Wall};
pub use pixel_filter::PixelFilter;
pub use primitive::{Disk, Primitives, Sphere};
pub use projection::{Mapping, Projection};
pub use range::Range;
pub use sampler::Sampler;
pub use settings::Settings;
pub use stereo::{Stereo, StereoLayout};
pub use temperature::Temperature;
pub use texture::{Alpha, FinishMaps, Map, Maps, Placement, Texels, Texture, Wrap};
pub use transport::{Direct, Integrator, Transport};
pub use visibility::{Matte, Visibility};

use eyerays_shader::data::NodeRef;
use glam::Vec3;

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
    /// A mesh in the dark: one material, no lamps, no camera, a black background and no object that has a name.
    pub fn of_mesh(mesh: Mesh, material: Material) -> Scene {
        Scene {
            mesh,
            shared: Vec::new(),
            instances: Vec::new(),
            spheres: Vec::new(),
            disks: Vec::new(),
            objects: Vec::new(),
            animations: Vec::new(),
            files: Vec::new(),
            materials: vec![material],
            lights: Vec::new(),
            cameras: Vec::new(),
            background: Background::Colour(Vec3::ZERO),
            environment: None,
            background_group: String::new(),
            fog: None,
            ambient: Vec3::ZERO,
            settings: Settings::default(),
            motion: None,
            hierarchy: None,
        }
    }

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
