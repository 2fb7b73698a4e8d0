//! What a kernel is compiled for: constants, so that it holds no instruction for anything else.

use super::Aovs;

/// A set of bits of which a kernel knows each while it is compiled.
macro_rules! bits {
    ($(#[$doc:meta])* $name:ident { $($(#[$bit_doc:meta])* $bit:ident = $place:literal;)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
        pub struct $name(pub u32);

        impl $name {
            $($(#[$bit_doc])* pub const $bit: u32 = 1 << $place;)*

            /// Is any of these bits set?
            #[inline(always)]
            pub fn has(self, bits: u32) -> bool {
                self.0 & bits != 0
            }

            /// With more bits.
            #[inline(always)]
            pub fn with(self, bits: u32) -> Self {
                $name(self.0 | bits)
            }
        }
    };
}

pub(super) use bits;

bits! {
    /// What a scene shading like; a kernel holds no instruction for effects that it does not have.
    Effects {
        /// Some mesh has vertex normals.
        SMOOTH = 0;
        /// Some material is a checker.
        CHECKER = 1;
        /// Some material is a mirror or reflects as glass, and bounces are allowed.
        REFLECTION = 2;
        /// Some material lets light pass, and bounces are allowed.
        REFRACTION = 3;
        /// Some light is a spot.
        SPOT = 4;
        /// Some light is directional.
        DIRECTIONAL = 5;
        /// Some material has a Phong highlight.
        SPECULAR = 6;
        /// Triangles seen from behind are skipped.
        CULLING = 7;
        /// The background is a gradient.
        GRADIENT = 8;
        /// There are lights.
        LIT = 9;
        /// Some material lets light pass: what is made of it casts no shadow.
        TRANSPARENT = 10;
        /// Some primitives are spheres.
        SPHERE = 11;
        /// Some primitives are disks.
        DISK = 12;
        /// Some material emits light.
        EMISSIVE = 13;
        /// Some material scatters by microfacets, and the integrator samples what they do.
        PHYSICAL = 14;
        /// Some such material is a conductor.
        CONDUCTOR = 15;
        /// Some such material is a thin wall that lets light pass.
        THIN = 16;
        /// Some such material absorbs light on its way inside.
        ABSORBING = 17;
        /// Some material has a texture.
        TEXTURED = 18;
        /// Some mesh has vertex colours.
        COLOURED = 19;
        /// Some primitives have tangents, and some material a use for them.
        TANGENTS = 20;
        /// Some material by microfacets is rougher along one axis than along the other.
        ANISOTROPIC = 21;
        /// Some material is not opaque everywhere.
        CUTOUT = 22;
        /// The background is a picture.
        ENVIRONMENT = 23;
        /// What is lost between facets is given back.
        COMPENSATED = 24;
        /// Several lights have places, and an integrator chooses one of them by a hierarchy.
        MANY_LIGHTS = 25;
        /// Some spot fades by the square of a ramp.
        RAMP = 26;
        /// What some material emits is multiplied with the colours of vertices.
        GLOWING_COLOURS = 27;
        /// Some primitives are not met by the rays of the camera, of shadows or of other surfaces.
        HIDDEN = 28;
        /// Some cut a hole into the picture.
        HOLDOUT = 29;
        /// Some surfaces are not lit by lamps of all groups, and the integrator traces paths.
        LINKED = 30;
        /// Some primitives are copies of meshes.
        INSTANCED = 31;
    }
}

bits! {
    /// What a scene has between its surfaces.
    Media {
        /// Some light is absorbed, scattered or sent there: paths know what they are in.
        PRESENT = 0;
        /// Some surfaces are not there themselves, but what is inside of them: rays go on through them.
        OPEN = 1;
        /// Some media send light.
        GLOWING = 2;
        /// Some are denser in one place than in another.
        GRIDS = 3;
        /// Bodies that bend light may lie in each other, and priorities tell which is there.
        NESTED = 4;
    }
}

bits! {
    /// What physical materials have beside a base, facets and what passes.
    Finishes {
        /// Some have a coat.
        COATED = 0;
        /// Some have fibres.
        FIBROUS = 1;
        /// Some bases send light to their far side.
        TRANSLUCENT = 2;
        /// Some have a film in which waves of light interfere.
        FILMED = 3;
        /// Some bodies bend blue light more than red.
        DISPERSIVE = 4;
        /// Some are hair.
        HAIR = 5;
    }
}

bits! {
    /// What of light comes by mirrors and glass, see [`photon`](crate::photon).
    Caustics {
        /// Photons tell it where paths are scattered that look for them.
        GATHERED = 0;
        /// The launch's paths are those of photons.
        PHOTONS = 1;
    }
}

impl Finishes {
    /// Is there anything at all?
    #[inline(always)]
    pub fn any(self) -> bool {
        self.0 != 0
    }
}

bits! {
    /// How light has wavelengths.
    Waves {
        /// Paths carry three wavelengths instead of red, green and blue.
        SPECTRAL = 0;
        /// Some lamps have spectra of their own.
        ILLUMINANTS = 1;
        /// Some bodies bend light, or some metals reflect it, as was measured at each wavelength.
        MEASURED = 2;
    }
}

bits! {
    /// Which rays a launch follows, where in a pixel the camera's are, and by which test they meet triangles.
    Launch {
        /// Secondary rays: the slots come from a queue.
        SECONDARY = 0;
        /// Rays that lie in memory as [`crate::stage::Segment`]s.
        STREAM = 1;
        /// Triangles are met by the test of Moeller and Trumbore, unless [`Real::EXACT`](crate::real::Real::EXACT).
        MOLLER = 2;
        /// A pixel's samples lie anywhere in the cells of a regular grid, each in its own; without this bit or one of the
        /// next, in the centres of the cells.
        JITTERED = 3;
        /// Anywhere in the pixel.
        RANDOM = 4;
        /// At the points of a scrambled Sobol sequence.
        SOBOL = 5;
        /// Only how much of its surroundings a surface sees.
        OCCLUSION = 6;
        /// Lights with extent are found by chance alone, not sampled.
        BY_SURFACE = 7;
        /// They are sampled, and count for nothing where chance finds them.
        BY_LIGHT = 8;
        /// Of both, each is weighted as its probability is; without any of these bits, as the square of it.
        BALANCED = 9;
        /// Paths go on after this wave's vertices.
        GOES_ON = 10;
        /// Paths branch at mirrors and glass, and go on from nowhere else.
        TREE = 11;
        /// Of a texture the nearest texel counts; without this bit, the four around.
        NEAREST = 12;
        /// They are of the level whose texels are nearest in size to what a ray sees.
        MIPMAPPED = 13;
        /// Only the colour of what the camera sees first.
        ALBEDO = 14;
        /// Only its shading normal.
        NORMAL = 15;
        /// Only where and which primitive it is.
        PLACE = 16;
        /// Rays of the camera may be parallel ([`Projection::PARALLEL`](super::Projection)).
        PARALLEL = 17;
        /// Lanes of a subgroup vote where their slots join the next wave.
        SUBGROUPS = 18;
        /// Pixels are those of cells that a table lists, wherever they are in the image.
        CELLS = 19;
        /// The film keeps squares of what blocks of samples are in the mean, instead of squares of samples.
        BLOCKS = 20;
        /// They may go through a lens.
        LENS = 21;
        /// A pixel's samples lie as a filter weights what is around its middle.
        FILTERED = 22;
        /// Rays of the camera may go all around.
        ROUND = 23;
        /// They lie in memory where integrators do not sample, too.
        KEPT = 24;
        /// The film counts the samples whose camera's ray finds nothing: what is behind everything is not in the picture.
        CLEAR = 25;
        /// It keeps what shadow catchers get of light, and what they would get if nothing else were there.
        CATCHER = 26;
        /// Rays of the camera start and end at its clipping planes.
        CLIPPED = 27;
        /// The image may hold those of two eyes.
        STEREO = 28;
        /// Only where what the camera sees first is.
        POSITION = 29;
        /// Copies of meshes move while the shutter is open: each sample's rays have a time of their own.
        MOVING = 30;
        /// The camera moves while it is open.
        PANNED = 31;
    }
}

impl Launch {
    /// What the camera sees first is asked for, not its light.
    pub const FEATURE: u32 = Launch::ALBEDO | Launch::NORMAL | Launch::PLACE | Launch::POSITION;
}

bits! {
    /// How the hierarchy and its triangles lie in memory; without any bit, each triangle with its vertices.
    Layout {
        /// Primitives are given as indices of vertices, see [`crate::scene::LaunchContext::primitive`].
        INDEXED = 0;
        /// Pairs of nodes are [`CompactPair`](super::CompactPair)s.
        COMPACT = 1;
    }
}

bits! {
    /// Which pixels' rays lie beside each other; without any bit, those of blocks of 8x4 pixels.
    Order {
        /// Pixels are taken row by row.
        LINEAR = 0;
        /// Pixels are taken along a Morton curve.
        MORTON = 1;
    }
}

/// Thresholds of the hybrid methods (thesis 6.2.3) and of persistent subgroups.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Tuning(pub u32);

impl Tuning {
    /// Parts a full stack of `stack_max` nodes, or a child that less than `cut` percent of a packet want.
    pub const fn new(stack_max: u32, cut: u32) -> Self {
        Tuning(stack_max | (cut << 8)).with_busy(Self::BUSY)
    }

    /// The default of [`Tuning::busy`], measured.
    const BUSY: u32 = 40;

    /// Lets the lanes of persistent subgroups take new rays when less than `busy` percent are at work.
    pub const fn with_busy(self, busy: u32) -> Self {
        Tuning((self.0 & 0xffff) | (busy << 16))
    }

    /// Percent of a persistent subgroup below which idle lanes take new rays. (Each time all wait for the
    /// rays' preparation.)
    #[inline(always)]
    pub fn busy(self) -> u32 {
        self.0 >> 16
    }

    /// Nodes that wait when a packet parts.
    #[inline(always)]
    pub fn stack_max(self) -> u32 {
        self.0 & 0xff
    }

    /// Percent of a packet below which rays part.
    #[inline(always)]
    pub fn cut(self) -> u32 {
        (self.0 >> 8) & 0xff
    }
}

impl Default for Tuning {
    fn default() -> Self {
        Tuning::new(8, 25)
    }
}

/// Everything that a kernel is compiled for.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub struct Specialisation {
    /// What the scene shading like.
    pub effects: Effects,
    /// Which rays are followed.
    pub launch: Launch,
    /// How the scene lies in memory.
    pub layout: Layout,
    /// Which pixels' rays lie beside each other.
    pub order: Order,
    /// When hybrid methods part.
    pub tuning: Tuning,
    /// What the film keeps beside light.
    pub aovs: Aovs,
    /// What is between surfaces.
    pub media: Media,
    /// What physical materials have beside a base, facets and what passes.
    pub finishes: Finishes,
    /// How light has wavelengths.
    pub waves: Waves,
    /// What of it photons tell.
    pub caustics: Caustics,
}

impl Specialisation {
    /// The same for others of these rays.
    pub fn without_launch(self, bits: u32) -> Self {
        Specialisation { launch: Launch(self.launch.0 & !bits), ..self }
    }

    /// The same for other rays.
    pub fn with_launch(self, bits: u32) -> Self {
        Specialisation { launch: self.launch.with(bits), ..self }
    }

    /// The value of each specialisation constant by its number; the entry points declare them in this order.
    pub fn constants(&self) -> [(u32, u32); 10] {
        let Specialisation { effects, launch, layout, order, tuning, aovs, media, finishes, waves, caustics } = *self;
        [
            (1, effects.0),
            (2, tuning.0),
            (3, launch.0),
            (4, layout.0),
            (5, order.0),
            (6, aovs.0),
            (7, media.0),
            (8, finishes.0),
            (9, waves.0),
            (10, caustics.0),
        ]
    }
}
