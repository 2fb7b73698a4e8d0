//! The table of what kernels bind: each resource once.

/// Who may do what with a resource.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Access {
    /// A small record that all threads read.
    Uniform,
    /// A buffer that kernels read.
    Read,
    /// A buffer that some kernel writes, and every kernel declares writable: naga wants accesses to match.
    Write,
}

/// A buffer that kernels bind, in descriptor set 0.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Resource {
    /// Its number in the modules, and its place in [`RESOURCES`].
    pub binding: u32,
    /// What kernels call it.
    pub parameter: &'static str,
    /// What people call it.
    pub name: &'static str,
    /// Who may do what with it.
    pub access: Access,
}

/// Gives the table to a macro, after a dollar for macros that it declares: number, parameter, constant, access, record
/// and name.
macro_rules! resources {
    ($then:ident $dollar:tt) => {
        $then! { $dollar
            0 frame FRAME: Uniform Frame, "frame";
            1 nodes NODES: Read UVec4, "hierarchy";
            2 primitives PRIMITIVES: Read UVec4, "primitives";
            3 normals NORMALS: Read Normals, "normals";
            4 materials MATERIALS: Read Material, "materials";
            5 lights LIGHTS: Read Light, "lights";
            6 paths PATHS: Write UVec4, "paths";
            7 hits HITS: Write UVec4, "hits";
            8 shadows SHADOWS: Write u32, "shadows";
            9 sums SUMS: Write UVec4, "sums";
            10 queue QUEUE: Write u32, "queue";
            11 next NEXT: Write u32, "next queue";
            12 counters COUNTERS: Write u32, "counters";
            13 wide WIDE: Read CwbvhNode, "wide hierarchy";
            14 optics OPTICS: Read u32, "optics";
            15 film FILM: Write u32, "film";
            16 arguments ARGUMENTS: Write u32, "arguments";
            17 segments SEGMENTS: Write UVec4, "shadow rays";
            18 emitters EMITTERS: Read Emitter, "emitters";
            19 emissions EMISSIONS: Read Emission, "emissions";
            20 physicals PHYSICALS: Read Physical, "physical materials";
            21 maps MAPS: Read Maps, "texture maps";
            22 textures TEXTURES: Read TextureMap, "table of textures";
            23 texels TEXELS: Read u32, "textures";
            24 coordinates COORDINATES: Read TexCoords, "texture coordinates";
            25 colours COLOURS: Read Colours, "vertex colours";
            26 tangents TANGENTS: Read Normals, "tangents";
            27 opacities OPACITIES: Read Opacity, "opacities";
            28 environment ENVIRONMENT: Read u32, "environment";
            29 albedos ALBEDOS: Read u32, "albedos of facets";
            30 light_nodes LIGHT_NODES: Read LightNode, "hierarchy of lights";
            31 cells CELLS: Read u32, "table of cells";
            32 instances INSTANCES: Read Instance, "instances";
            33 media MEDIA: Read Medium, "media";
            34 grids GRIDS: Read u32, "grids";
            35 finishes FINISHES: Read Finish, "finishes of materials";
            36 spectra SPECTRA: Read UVec4, "spectra";
            37 casters CASTERS: Read UVec4, "balls around what casts caustics";
            38 photons PHOTONS: Read UVec4, "photons";
            39 heads HEADS: Write u32, "lists of photons";
            40 landed LANDED: Write UVec4, "photons that land";
        }
    };
}
#[cfg(target_arch = "spirv")]
pub(crate) use resources;

macro_rules! list {
    ($d:tt $($binding:tt $parameter:ident $constant:ident: $access:ident $record:ty, $name:literal;)*) => {
        /// The numbers of the resources.
        pub mod binding {
            $(#[doc = $name] pub const $constant: u32 = $binding;)*
        }

        /// Every resource, by its number.
        pub const RESOURCES: &[Resource] =
            &[$(Resource { binding: $binding, parameter: stringify!($parameter), name: $name, access: Access::$access }),*];
    };
}
resources!(list $);
