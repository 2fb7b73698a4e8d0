//! From a scene in world units to the records that devices hold.

use std::sync::OnceLock;
use std::time::{Duration, Instant};

use eyerays_bvh::{Bvh8, Quality, Statistics};
use eyerays_shader::camera;
use eyerays_shader::data::{
    Bounds, CentredPair, CwbvhNode, Features, Frame, Light as LightRecord, Material as MaterialRecord, Normals,
    Triangle, pack,
};
use glam::{DVec3, Vec3};

mod check;
mod laid;
mod normalisation;
mod words;

pub use laid::Laid;
pub use normalisation::Normalisation;
pub use words::{NodeWords, TriangleWords};

use normalisation::{flushed, flushed_number};

use crate::error::{Error, Result};
use crate::math;
use crate::scene::{Background, Camera, Light, Material, Scene, Settings};

/// References added by splitting triangles, as a share of the triangles.
const SPLIT_BUDGET: f32 = 0.3;

/// A scene as the kernels read it, owned, for one camera and one set of settings.
pub struct Packed {
    /// Child pairs of the hierarchy.
    pub nodes: Vec<CentredPair>,
    /// The same hierarchy with nodes of eight children.
    pub wide: Vec<CwbvhNode>,
    /// Triangles by slot, in the normalised scene; a split one has several slots.
    pub triangles: Vec<Triangle>,
    /// Bounds by slot; empty unless triangles are split.
    pub bounds: Vec<Bounds>,
    /// Vertex normals in leaf order; empty if every mesh is flat.
    pub normals: Vec<Normals>,
    /// Materials.
    pub materials: Vec<MaterialRecord>,
    /// Lights in file order.
    pub lights: Vec<LightRecord>,
    /// The effects that the scene asks for.
    pub features: Features,
    /// What to render.
    pub settings: Settings,
    /// How the scene became what kernels take.
    pub normalisation: Normalisation,
    /// The hierarchy's figures.
    pub statistics: Statistics,
    /// What building the hierarchy took.
    pub build_time: Duration,
    /// Every launch's record but for its region and sample.
    frame: Frame,
    bvh8: OnceLock<Bvh8>,
}

/// A rectangle of the image in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// Left column.
    pub x: u32,
    /// Top row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Packed {
    /// Normalises, builds the hierarchy and packs.
    ///
    /// # Errors
    /// A mesh that names vertices or materials which are not there, or settings out of range. What no device could hold
    /// or no ray meet: too many triangles, a light or camera too far away for the scene's numbers.
    pub fn new(scene: &Scene, camera: &Camera, settings: Settings, quality: Quality) -> Result<Packed> {
        check::scene(scene)?;
        check::settings(&settings)?;
        let mut features = features(scene, &settings);
        let normalisation = normalisation(scene, camera, features);
        let triangles = triangles(scene, &normalisation, features);
        let start = Instant::now();
        let refused = |e: eyerays_bvh::BuildError| Error::new(e.to_string());
        let references = eyerays_bvh::split(&triangles, SPLIT_BUDGET).map_err(refused)?;
        if references.list.len() > triangles.len() {
            features.0 |= Features::SPLIT;
        }
        let bvh = eyerays_bvh::build(&references, quality).map_err(refused)?;
        let build_time = start.elapsed();
        let statistics = Statistics::of(&bvh, &triangles);
        let lights =
            scene.lights.iter().enumerate().map(|(i, l)| light(l, i, &normalisation)).collect::<Result<Vec<_>>>()?;
        Ok(Packed {
            triangles: bvh.gather(&triangles),
            normals: if features.has(Features::SMOOTH) { bvh.gather(&normals(scene)) } else { Vec::new() },
            nodes: bvh.nodes.iter().map(CentredPair::from).collect(),
            wide: bvh.wide,
            bounds: if features.has(Features::SPLIT) { bvh.bounds } else { Vec::new() },
            materials: scene.materials.iter().map(|m| material(m, scene.ambient, normalisation.scale)).collect(),
            frame: frame(scene, camera, &settings, lights.len(), &normalisation)?,
            lights,
            features,
            settings,
            normalisation,
            statistics,
            build_time,
            bvh8: OnceLock::new(),
        })
    }

    /// The same hierarchy with nodes of eight children as a CPU loads them: made when it is first asked for.
    pub fn bvh8(&self) -> &Bvh8 {
        self.bvh8.get_or_init(|| Bvh8::of(&self.nodes, &self.triangles, &self.bounds))
    }

    /// Can a primary ray's light come from further rays?
    pub fn has_secondary_rays(&self) -> bool {
        self.settings.bounces > 0 && (self.features.0 & (Features::REFLECTION | Features::REFRACTION)) != 0
    }

    /// Paths that a slot keeps: the one in hand and those that wait, 0 if there are primary rays only.
    ///
    /// A refracted ray waits at most once a bounce. Waiting rays and the one in hand share their
    /// pixel's light, a unit a colour channel, and each has at least the least contribution of it.
    pub fn levels(&self) -> u32 {
        if !self.has_secondary_rays() {
            return 0;
        }
        if !self.features.has(Features::REFRACTION) {
            return 1;
        }
        let least = f64::from(self.settings.min_contribution);
        let waiting = if least > 0.0 { (3.0 / least).ceil() + 1.0 } else { f64::from(u32::MAX) };
        1 + (self.settings.bounces).min(waiting as u32)
    }

    /// The launches of a pixel: one a sample.
    pub fn samples(&self) -> u32 {
        self.settings.samples * self.settings.samples
    }

    /// Turns to another of the scene's cameras.
    ///
    /// # Errors
    /// If there is no way to look so.
    pub fn look(&mut self, scene: &Scene, camera: &Camera) -> Result<()> {
        self.frame = frame(scene, camera, &self.settings, self.lights.len(), &self.normalisation)?;
        Ok(())
    }

    /// Takes other settings and keeps the hierarchy, which does not depend on them.
    ///
    /// # Errors
    /// As [`Packed::look`], and settings out of range.
    pub fn set(&mut self, scene: &Scene, camera: &Camera, settings: Settings) -> Result<()> {
        check::settings(&settings)?;
        // What was packed stays packed.
        let geometry = Features::SPLIT | Features::SMOOTH;
        self.features = Features(features(scene, &settings).0 & !geometry | self.features.0 & geometry);
        self.settings = settings;
        self.look(scene, camera)
    }

    /// The record of a launch that follows `count` rays of a stream.
    pub fn stream_frame(&self, count: usize) -> Frame {
        let limits = glam::UVec4::new(0, 0, count as u32, self.triangles.len() as u32);
        Frame { limits, ..bytemuck::Zeroable::zeroed() }
    }

    /// The record of one launch, whose slots are in the order of `features`.
    pub fn frame(&self, region: Region, sample: u32, features: Features) -> Frame {
        let mut frame = self.frame;
        frame.forward.w = sample;
        frame.region = glam::UVec4::new(region.x, region.y, region.width, region.height);
        frame.limits.z = camera::slots(region.width, region.height, features);
        frame.limits.w = self.triangles.len() as u32;
        frame
    }
}

fn normalisation(scene: &Scene, camera: &Camera, features: Features) -> Normalisation {
    let eyes = scene.cameras.iter().chain([camera]).map(|c| c.eye);
    // The cells of a checkerboard are counted from the world's origin.
    Normalisation::of(scene.mesh.positions.iter().copied().chain(eyes), !features.has(Features::CHECKER))
}

fn colour(c: Vec3, word: u32) -> glam::UVec4 {
    pack(flushed(c), word)
}

fn features(scene: &Scene, settings: &Settings) -> Features {
    let used = |m: &dyn Fn(&Material) -> bool| scene.materials.iter().any(m);
    let lit = !scene.lights.is_empty();
    let mut bits = 0;
    let mut ask = |bit: u32, asked: bool| bits |= if asked { bit } else { 0 };
    let bounces = settings.bounces > 0;
    ask(Features::SMOOTH, !scene.mesh.normals.is_empty());
    ask(Features::CHECKER, used(&|m| m.checker.is_some()));
    ask(Features::REFLECTION, bounces && used(&|m| m.reflection != Vec3::ZERO || is_transparent(m)));
    ask(Features::REFRACTION, used(&is_transparent));
    ask(Features::SPOT, scene.lights.iter().any(|l| matches!(l, Light::Spot { .. })));
    ask(Features::DIRECTIONAL, scene.lights.iter().any(|l| matches!(l, Light::Directional { .. })));
    ask(Features::SPECULAR, lit && used(&|m| m.specular != Vec3::ZERO));
    ask(Features::CULLING, settings.culling);
    ask(Features::GRADIENT, matches!(scene.background, Background::Gradient { .. }));
    Features(bits)
}

fn is_transparent(m: &Material) -> bool {
    m.transmission != Vec3::ZERO
}

fn triangles(scene: &Scene, normalisation: &Normalisation, features: Features) -> Vec<Triangle> {
    let mesh = &scene.mesh;
    let clear: Vec<bool> = scene.materials.iter().map(is_transparent).collect();
    let records = mesh.triangles.iter().zip(&mesh.materials).zip(0..).map(|((corners, &material), primitive)| {
        let vertices = corners.map(|v| normalisation.place(mesh.positions[v as usize]));
        let passes = features.has(Features::REFRACTION) && clear[material as usize];
        Triangle::new(vertices, primitive, material, if passes { Triangle::TRANSPARENT } else { 0 })
    });
    records.collect()
}

fn normals(scene: &Scene) -> Vec<Normals> {
    let at = |v: u32| pack(flushed(scene.mesh.normals[v as usize]), 0);
    scene.mesh.triangles.iter().map(|&[a, b, c]| Normals { a: at(a), b: at(b), c: at(c) }).collect()
}

fn material(m: &Material, ambient: Vec3, scale: f64) -> MaterialRecord {
    let ior = if is_transparent(m) { m.ior } else { 0.0 };
    // Cells much larger than the scene are one cell, whatever their exact size.
    let cells = |size: f32| (1.0 / (f64::from(size) * scale)).clamp(1e-6, 1e30) as f32;
    let (checker, checker_ambient) = match m.checker {
        Some(c) => (colour(c.colour, cells(c.size).to_bits()), colour(c.ambient * ambient, 0)),
        None => (colour(Vec3::ZERO, 0), colour(Vec3::ZERO, 0)),
    };
    MaterialRecord {
        ambient: colour(m.ambient * ambient, 0),
        diffuse: colour(m.diffuse, 0),
        specular: colour(m.specular, flushed_number(m.shininess).to_bits()),
        reflection: colour(m.reflection, ior.to_bits()),
        transmission: colour(m.transmission, 0),
        checker,
        checker_ambient,
    }
}

fn light(light: &Light, index: usize, normalisation: &Normalisation) -> Result<LightRecord> {
    let far = || Error::new(format!("light {} is too far away: move it nearer to the scene", index + 1));
    let at = |p: Vec3| -> Result<Vec3> {
        let p = normalisation.place(p);
        if p.abs().max_element() < 1e18 { Ok(p) } else { Err(far()) }
    };
    let record = |position, kind, light: Vec3, axis: Vec3, (inner, outer): (f32, f32)| LightRecord {
        position: pack(position, kind),
        colour: colour(light, inner.to_bits()),
        axis: pack(axis, outer.to_bits()),
    };
    Ok(match *light {
        Light::Point { position, colour } => record(at(position)?, LightRecord::POINT, colour, Vec3::ZERO, (0.0, 0.0)),
        Light::Directional { direction, colour } => {
            record(unit(-direction), LightRecord::DIRECTIONAL, colour, Vec3::ZERO, (0.0, 0.0))
        }
        Light::Spot { position, target, colour, outer, inner } => {
            let cosine = |degrees: f32| flushed_number(math::cos(f64::from(degrees).to_radians()) as f32);
            let axis = unit_between(position, target);
            record(at(position)?, LightRecord::SPOT, colour, axis, (cosine(inner), cosine(outer)))
        }
    })
}

fn unit(v: Vec3) -> Vec3 {
    flushed(v.as_dvec3().normalize_or_zero().as_vec3())
}

fn unit_between(from: Vec3, to: Vec3) -> Vec3 {
    flushed((to.as_dvec3() - from.as_dvec3()).normalize_or_zero().as_vec3())
}

fn frame(
    scene: &Scene,
    camera: &Camera,
    settings: &Settings,
    lights: usize,
    normalisation: &Normalisation,
) -> Result<Frame> {
    let (width, height) = settings.size;
    let forward = (camera.target.as_dvec3() - camera.eye.as_dvec3()).normalize_or_zero();
    let right = forward.cross(camera.up.as_dvec3()).normalize_or_zero();
    if right == DVec3::ZERO {
        let message = format!("camera \"{}\" looks along its up vector or at itself", camera.name);
        return Err(Error::new(format!("{message}: move its target or turn its up")));
    }
    let half_height = math::tan(f64::from(camera.fov).to_radians() / 2.0);
    // A step is half a sample, so that a pixel's samples lie at odd steps from the centre.
    let step = half_height / f64::from(height * settings.samples);
    let vector = |v: DVec3, word| pack(flushed(v.as_vec3()), word);
    let (bottom, top) = match scene.background {
        Background::Colour(c) => (c, c),
        Background::Gradient { horizon, zenith } => (horizon, zenith),
    };
    let share = 1.0 / (f64::from(settings.samples) * f64::from(settings.samples));
    Ok(Frame {
        eye: pack(normalisation.place(camera.eye), width),
        right: vector(right * step, height),
        up: vector(right.cross(forward) * step, settings.samples),
        forward: vector(forward, 0),
        bottom: colour(bottom, settings.bounces),
        top: colour(top, lights as u32),
        region: glam::UVec4::ZERO,
        limits: glam::UVec4::new((share as f32).to_bits(), settings.min_contribution.to_bits(), 0, 0),
    })
}
