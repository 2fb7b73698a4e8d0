//! Surfaces to test, in double precision: flat, facing up the third axis.

use eyerays_shader::data::{Effects, Finish, Finishes};
use eyerays_shader::geometry::SurfaceInteraction;
use eyerays_shader::material::{
    ALBEDOS, Albedos, Bsdf, Closure, ClosureSample, Coat, Coated, Ggx, Hair, Layers, Reflectance, Scattering, Sheen,
    Way, conductor_mean,
};
use eyerays_shader::real::V3;
use eyerays_shader::sampler::hash;
use glam::{DVec3, UVec4, Vec3};
use std::sync::OnceLock;

pub type V = V3<f64>;

pub const WHITE: V = V { x: 1.0, y: 1.0, z: 1.0 };
pub const BLACK: V = V { x: 0.0, y: 0.0, z: 0.0 };

/// Facets of some roughness that reflect everything.
pub fn facets(x: f64, y: f64) -> Layers<f64> {
    let reflectance = Reflectance {
        normal: WHITE,
        grazing: WHITE,
        is_conductor: false,
        mean_colour: BLACK,
        glass: 0.0,
        eta: 1.0,
        has_two_faces: false,
    };
    let ggx = Ggx { x, y };
    Layers { diffuse: BLACK, beyond: BLACK, through: BLACK, reflectance, is_coated: true, way: Way::OPAQUE, ggx }
}

/// White plastic.
pub fn plastic(x: f64, y: f64) -> Layers<f64> {
    let normal = V { x: 0.04, y: 0.04, z: 0.04 };
    let facets = facets(x, y);
    Layers { diffuse: WHITE, reflectance: Reflectance { normal, ..facets.reflectance }, ..facets }
}

/// Gold.
pub fn gold(x: f64, y: f64) -> Layers<f64> {
    let (eta, k) = (Vec3::new(0.143, 0.375, 1.442), Vec3::new(3.983, 2.386, 1.603));
    let mean_colour = V3::splat(conductor_mean(eta, k));
    let (eta, k) = (V3::splat(eta), V3::splat(k));
    let facets = facets(x, y);
    let reflectance = Reflectance { normal: eta, grazing: k, is_conductor: true, mean_colour, ..facets.reflectance };
    Layers { reflectance, ..facets }
}

/// Glass, seen from its side where the index is `eta` times that on the other.
pub fn glass(x: f64, y: f64, eta: f64) -> Layers<f64> {
    let facets = facets(x, y);
    let reflectance = Reflectance { normal: BLACK, grazing: BLACK, glass: 1.0, eta, ..facets.reflectance };
    Layers { through: WHITE, reflectance, way: Way::BODY, ..facets }
}

/// A pane that lets through what it does not reflect or scatter.
pub fn pane(x: f64, y: f64) -> Layers<f64> {
    let half = WHITE * 0.5;
    Layers { through: half, diffuse: half, way: Way::THIN, ..plastic(x, y) }
}

/// A leaf: half of what its base scatters leaves on the far side.
pub fn leaf(x: f64, y: f64) -> Layers<f64> {
    let half = WHITE * 0.5;
    Layers { diffuse: half, beyond: half, ..plastic(x, y) }
}

/// What lies on a surface.
#[derive(Clone, Copy, Default)]
pub struct Over {
    /// How much of it a coat is on, and the roughness of its facets.
    pub coat: Option<(f64, f64)>,
    /// The perceived roughness of white fibres.
    pub sheen: Option<f64>,
}

/// The words of the tables.
pub fn albedos() -> &'static [u32] {
    static WORDS: OnceLock<Vec<u32>> = OnceLock::new();
    WORDS.get_or_init(|| ALBEDOS.chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect())
}

/// A closure that is seen from some direction, which may be below.
pub struct Seen {
    closure: Coated<'static, f64>,
    interaction: SurfaceInteraction<f64>,
}

impl Seen {
    /// From the unit direction `viewer`, with what is lost between facets.
    pub fn from(layers: Layers<f64>, viewer: DVec3) -> Self {
        Self::by(Effects(u32::MAX), layers, Over::default(), viewer)
    }

    /// The same below what lies on it.
    pub fn below(over: Over, layers: Layers<f64>, viewer: DVec3) -> Self {
        Self::by(Effects(u32::MAX), layers, over, viewer)
    }

    /// Where facets scatter once.
    pub fn once(layers: Layers<f64>, viewer: DVec3) -> Self {
        Self::by(Effects(!Effects::COMPENSATED), layers, Over::default(), viewer)
    }

    /// Hair of a colour and an index of refraction along the first axis, from above.
    pub fn hair(finish: &Finish, viewer: DVec3, colour: V, ior: f64) -> Self {
        let seen = Self::by(Effects(u32::MAX), plastic(0.5, 0.5), Over::default(), viewer);
        Seen { closure: seen.closure.or_hair(Hair::new(finish, of(viewer), colour, ior)), ..seen }
    }

    fn by(effects: Effects, layers: Layers<f64>, over: Over, viewer: DVec3) -> Self {
        let up = if viewer.z < 0.0 { -1.0 } else { 1.0 };
        let normal = V::new(0.0, 0.0, up);
        let axes = [V::new(1.0, 0.0, 0.0), V::new(0.0, up, 0.0), normal];
        let interaction = SurfaceInteraction {
            position: V::splat(Vec3::ZERO),
            error_offset: 1e-9,
            normal,
            front: up > 0.0,
            coordinates: (0.0, 0.0),
            number: 0,
            is_curved: false,
            radius: 0.0,
            is_lifted: false,
            lift: 0.0,
        };
        let base = Bsdf::new((effects, Finishes(u32::MAX)), Albedos(albedos()), axes, -of(viewer), layers);
        let coat = over.coat.map_or(Coat::none(), |(weight, alpha)| {
            let ggx = Ggx { x: alpha, y: alpha };
            Coat::new(effects, Albedos(albedos()), (normal, -of(viewer)), (weight, ggx))
        });
        let own = V::new(viewer.x, viewer.y * up, viewer.z * up);
        let sheen = over.sheen.map_or(Sheen::none(), |roughness| Sheen::new(own, WHITE, roughness));
        Seen { closure: Coated::new(Finishes(u32::MAX), base, (coat, sheen)), interaction }
    }

    /// How it scatters light from a unit direction.
    pub fn scattering(&self, light: DVec3) -> Scattering<f64> {
        self.closure.eval(&self.interaction, of(light))
    }

    /// The sample of a number in a run.
    pub fn sample(&self, run: u32, number: u32) -> ClosureSample<f64> {
        let [a, b, c] = hash([run, number, 1]);
        let [c, d, _] = hash([a, b, c]);
        self.closure.sample((&self.interaction, V3::zero()), (a, b), || UVec4::new(c, d, 0, 0))
    }
}

fn of(v: DVec3) -> V {
    V::new(v.x, v.y, v.z)
}

/// The direction at polar coordinates.
pub fn direction(polar: f64, azimuth: f64) -> DVec3 {
    DVec3::new(polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos())
}
