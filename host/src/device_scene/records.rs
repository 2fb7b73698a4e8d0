//! The records of a scene's parts.

use bytemuck::Zeroable;
use eyerays_shader::data::{
    Effects, Filling, Finish, FinishMaps, Finishes, Instance, Light as LightRecord, Material as MaterialRecord,
    Normals, Physical as PhysicalRecord, Primitive, pack,
};
use eyerays_shader::material::conductor_mean;
use eyerays_shader::real::SMALL;
use glam::{UVec4, Vec3};
use rayon::prelude::*;

use super::flags;
use super::normalisation::{Normalisation, flushed, flushed_number};
use super::spectra::Spectra;
use crate::error::{Error, Result};
use crate::math;
use crate::scene::{
    Absorption, Alpha, Background, Coat, Conductor, DiffuseTransmission, Falloff, Hair, Integrator, Light, Material,
    Matte, Physical, Scene, Settings, Sheen, ThinFilm, Visibility, Wall,
};

/// A colour and an integer.
pub(super) fn colour(c: Vec3, word: u32) -> UVec4 {
    pack(flushed(c), word)
}

/// The effects that a scene asks for, of those that it has, under some settings.
pub(super) fn asked(effects: Effects, settings: &Settings) -> Effects {
    let out = match settings.transport.integrator {
        Integrator::Whitted if settings.bounces > 0 => MICROFACETS | Effects::MANY_LIGHTS,
        Integrator::Whitted => Effects::REFLECTION | Effects::REFRACTION | MICROFACETS | Effects::MANY_LIGHTS,
        Integrator::Distributed if settings.bounces > 0 => 0,
        Integrator::Distributed => Effects::REFLECTION | Effects::REFRACTION | Effects::ABSORBING,
        Integrator::Ao => !(GEOMETRY | Effects::TRANSPARENT),
        // What is behind glass is lit through it, by light that is bent there, or not at all.
        Integrator::Path => Effects::TRANSPARENT | Effects::SPECULAR,
    };
    let culled = if settings.culling { Effects::CULLING } else { 0 };
    let asked = effects.0 & !out;
    let is_compensated = settings.compensation && asked & Effects::PHYSICAL != 0;
    Effects(asked | culled | if is_compensated { Effects::COMPENSATED } else { 0 })
}

/// What microfacets do.
const MICROFACETS: u32 =
    Effects::PHYSICAL | Effects::CONDUCTOR | Effects::THIN | Effects::ABSORBING | Effects::ANISOTROPIC;

/// What is of the surfaces alone.
const GEOMETRY: u32 = Effects::SMOOTH
    | Effects::SPHERE
    | Effects::DISK
    | Effects::GRADIENT
    | Effects::CUTOUT
    | Effects::TEXTURED
    | Effects::COLOURED
    | Effects::TANGENTS
    | Effects::ENVIRONMENT
    | Effects::HIDDEN
    | Effects::HOLDOUT
    | Effects::INSTANCED;

/// The effects that a scene has, if rays may bounce.
pub(super) fn effects(scene: &Scene) -> Effects {
    let used = |m: &dyn Fn(&Material) -> bool| scene.materials.iter().any(m);
    let lit = !scene.lights.is_empty();
    let mut bits = 0;
    let mut ask = |bit: u32, asked: bool| bits |= if asked { bit } else { 0 };
    ask(Effects::SMOOTH, !scene.mesh.normals.is_empty());
    ask(Effects::CHECKER, used(&|m| m.checker.is_some()));
    ask(Effects::REFLECTION, used(&|m| m.reflection != Vec3::ZERO || is_transparent(m)));
    ask(Effects::TRANSPARENT, used(&is_transparent));
    ask(Effects::REFRACTION, used(&is_transparent));
    let fades = |by: Falloff| scene.lights.iter().any(|l| matches!(l, Light::Spot { falloff, .. } if *falloff == by));
    ask(Effects::SPOT, fades(Falloff::Smooth));
    ask(Effects::RAMP, fades(Falloff::Gltf));
    ask(Effects::DIRECTIONAL, scene.lights.iter().any(|l| matches!(l, Light::Directional { .. })));
    ask(Effects::SPECULAR, lit && used(&|m| m.specular != Vec3::ZERO));
    ask(Effects::LIT, lit);
    ask(Effects::SPHERE, !scene.spheres.is_empty());
    ask(Effects::DISK, !scene.disks.is_empty());
    ask(Effects::EMISSIVE, used(&|m| m.emission != Vec3::ZERO));
    ask(Effects::GLOWING_COLOURS, used(&|m| m.emission_is_coloured) && !scene.mesh.colours.is_empty());
    ask(Effects::GRADIENT, matches!(scene.background, Background::Gradient { .. }));
    let physical = |m: &dyn Fn(&Physical) -> bool| scene.materials.iter().filter_map(|m| m.physical.as_ref()).any(m);
    ask(Effects::PHYSICAL, physical(&|_| true));
    ask(Effects::CONDUCTOR, physical(&|p| p.conductor.is_some()));
    ask(Effects::THIN, physical(&|p| p.is_transparent() && p.wall != Wall::Body));
    ask(Effects::ABSORBING, used(&|m| absorption(m).is_some()));
    ask(Effects::REFRACTION, physical(&|p| p.is_transparent() && p.wall == Wall::Body));
    ask(Effects::ANISOTROPIC, physical(&|p| p.anisotropy > 0.0));
    ask(Effects::TEXTURED, used(&|m| m.maps.all().next().is_some()));
    ask(Effects::COLOURED, !scene.mesh.colours.is_empty());
    ask(Effects::TANGENTS, used(&Material::has_axes));
    // Times of rays lie where copies of meshes are told.
    let lights_move = scene.motion.as_ref().is_some_and(|motion| !motion.lights.is_empty());
    ask(Effects::INSTANCED, !scene.instances.is_empty() || lights_move);
    ask(Effects::CUTOUT, used(&is_cutout));
    ask(Effects::ENVIRONMENT, scene.environment.is_some());
    let hides = |of: Visibility| Visibility { matte: Matte::Shown, ..of } != Visibility::default();
    ask(
        Effects::HIDDEN,
        flags::visibilities(scene).any(hides)
            || flags::mattes(scene).any(|matte| matte == Matte::Catcher)
            || used(&is_open),
    );
    ask(Effects::LINKED, used(&|m| m.lit_by.is_some()));
    ask(Effects::HOLDOUT, flags::mattes(scene).any(|matte| matte == Matte::Holdout));
    Effects(bits)
}

pub(super) fn is_transparent(m: &Material) -> bool {
    m.transmission != Vec3::ZERO || m.physical.is_some_and(|p| p.is_transparent())
}

pub(super) fn is_cutout(m: &Material) -> bool {
    // Any opacity is at least 0.
    !matches!(m.alpha, Alpha::Opaque | Alpha::Mask(0.0))
}

/// What a body takes of light on its way inside, unless that is a medium's.
fn absorption(m: &Material) -> Option<Absorption> {
    m.physical?.absorption.filter(|_| m.lets_light_in() && m.volume.is_none())
}

/// Its primitives: triangles, those of shared meshes each in its own cube and with its number there; spheres and disks.
pub(super) fn primitives(scene: &Scene, normalisation: &Normalisation, cubes: &[Normalisation]) -> Vec<Primitive> {
    let mesh = &scene.mesh;
    let flags = flags::by_primitive(scene);
    let of_material = flags::by_material(scene);
    let own = scene.own_triangles();
    // Kernels see nothing smaller: differences to a centre that are less count as zero.
    let length = |radius: f32| ((f64::from(radius) * normalisation.scale) as f32).max(SMALL);
    let mut records = Vec::with_capacity(mesh.triangles.len() + scene.spheres.len() + scene.disks.len());
    let triangle = |corners: [u32; 3], placed: &Normalisation, number: usize, material: u32, flags: u32| {
        let vertices = corners.map(|v| placed.place(mesh.positions[v as usize]));
        Primitive::triangle(vertices, number as u32, material, flags)
    };
    let triangles = mesh.triangles.par_iter().zip(&mesh.materials);
    records.par_extend(triangles.take(own).enumerate().map(|(number, (&corners, &material))| {
        triangle(corners, normalisation, number, material, flags(number, material))
    }));
    for (shared, cube) in scene.shared.iter().zip(cubes) {
        let range = shared.triangles.clone();
        let triangles = mesh.triangles[range.clone()].par_iter().zip(&mesh.materials[range]);
        records.par_extend(triangles.enumerate().map(|(number, (&corners, &material))| {
            triangle(corners, cube, number, material, of_material[material as usize])
        }));
    }
    let first = (own as u64 + scene.copied_triangles()) as usize;
    let number_of = |number: usize| (number as u64 % u64::from(Instance::NUMBERS)) as u32;
    records.par_extend(scene.spheres.par_iter().enumerate().map(|(number, sphere)| {
        let (centre, material, number) = (normalisation.place(sphere.center), sphere.material, first + number);
        Primitive::sphere(centre, length(sphere.radius), number_of(number), material, flags(number, material))
    }));
    let first = first + scene.spheres.len();
    records.par_extend(scene.disks.par_iter().enumerate().map(|(number, disk)| {
        let (centre, material) = (normalisation.place(disk.center), disk.material);
        let (normal, number) = (unit(disk.normal), first + number);
        Primitive::disk(centre, normal, length(disk.radius), number_of(number), material, flags(number, material))
    }));
    records
}

/// A record for each slot: of a triangle's number and corners, zeros for anything else.
pub(super) fn by_slot<T: Zeroable + Send>(
    scene: &Scene,
    order: &[u32],
    of: impl Fn(usize, [u32; 3]) -> T + Sync,
) -> Vec<T> {
    let record = |&primitive: &u32| match scene.mesh.triangles.get(primitive as usize) {
        Some(&corners) => of(primitive as usize, corners),
        None => T::zeroed(),
    };
    order.par_iter().map(record).collect()
}

/// Its vertex normals in the order of slots, each with a primitive; what is no triangle has none.
pub(super) fn normals(scene: &Scene, order: &[u32]) -> Vec<Normals> {
    let at = |v: u32| pack(flushed(scene.mesh.normals[v as usize]), 0);
    by_slot(scene, order, |_, [a, b, c]| Normals { a: at(a), b: at(b), c: at(c) })
}

/// Are its surfaces not there, but what is inside of them?
pub(super) fn is_open(m: &Material) -> bool {
    m.volume.as_ref().is_some_and(|volume| !volume.interface)
}

/// A material's record.
pub(super) fn material(m: &Material, filling: Filling, unlit: u32, (ambient, scale): (Vec3, f64)) -> MaterialRecord {
    let ior = if is_transparent(m) { m.ior } else { 0.0 };
    // Cells much larger than the scene are one cell, whatever their exact size.
    let cells = |size: f32| (1.0 / (f64::from(size) * scale)).clamp(1e-6, 1e30) as f32;
    let (checker, checker_ambient) = match m.checker {
        Some(c) => (colour(c.colour, cells(c.size).to_bits()), colour(c.ambient * ambient, 0)),
        None => (colour(Vec3::ZERO, 0), colour(Vec3::ZERO, 0)),
    };
    MaterialRecord {
        ambient: colour(m.ambient() * ambient, unlit),
        diffuse: colour(m.diffuse, 0),
        specular: colour(m.specular, flushed_number(m.shininess).to_bits()),
        reflection: colour(m.reflection, ior.to_bits()),
        transmission: colour(m.transmission, filling.0),
        checker,
        checker_ambient,
    }
}

/// A physical material's record; that of another says that it is none.
pub(super) fn physical(m: &Material, scale: f64, spectra: &Spectra) -> PhysicalRecord {
    let Some(p) = m.physical else { return PhysicalRecord::zeroed() };
    let flag = |flag: u32, holds: bool| if holds { flag } else { 0 };
    let flags = PhysicalRecord::IS_PHYSICAL
        | flag(PhysicalRecord::CONDUCTOR, p.conductor.is_some())
        | flag(PhysicalRecord::THIN, p.wall != Wall::Body)
        | flag(PhysicalRecord::TWO_FACES, p.wall == Wall::Pane);
    let turns = f64::from(p.anisotropy_rotation).to_radians();
    let turned = |number: f64| flushed_number(number as f32).to_bits();
    // A conductor's facets do not ask for its base, which is what it looks like.
    let base = p.conductor.map_or(p.base, |conductor| conductor.reflectance());
    let conductor = p.conductor.unwrap_or(Conductor { eta: Vec3::ZERO, k: Vec3::ZERO, metal: None });
    let absorption = absorption(m);
    let lengths = absorption.map_or(0.0, |a| (1.0 / (f64::from(a.distance) * scale)).clamp(1e-9, 1e9) as f32);
    PhysicalRecord {
        base: colour(base, flags),
        shape: colour(Vec3::new(p.roughness, p.metallic, p.anisotropy), p.ior.to_bits()),
        // A conductor has no dielectric part: the mean of what it reflects stands there.
        dielectric: colour(
            p.conductor.map_or(p.tinted(), |c| conductor_mean(c.eta, c.k)),
            flushed_number(p.specular_weight).to_bits(),
        ),
        transmission: colour(p.transmission, lengths.to_bits()),
        attenuation: colour(absorption.map_or(Vec3::ONE, |a| a.colour), spectra.metal(conductor.metal)),
        eta: colour(conductor.eta, turned(math::cos(turns))),
        k: colour(conductor.k, turned(math::sin(turns))),
    }
}

/// What kernels are compiled for that know what physical materials have beside base, facets and what passes.
pub(super) fn finish_bits(scene: &Scene) -> Finishes {
    let used = |has: &dyn Fn(&Physical) -> bool| scene.materials.iter().filter_map(|m| m.physical.as_ref()).any(has);
    let bit = |bit, holds| if holds { bit } else { 0 };
    let coated = used(&|p| p.coat.is_some_and(|coat| coat.weight > 0.0));
    let fibrous = used(&|p| p.sheen.is_some_and(|sheen| sheen.colour != Vec3::ZERO));
    Finishes(
        bit(Finishes::COATED, coated)
            | bit(Finishes::FIBROUS, fibrous)
            | bit(Finishes::TRANSLUCENT, used(&is_translucent))
            | bit(Finishes::FILMED, used(&|p| p.film.is_some_and(|film| film.weight > 0.0)))
            | bit(Finishes::DISPERSIVE, used(&|p| p.dispersion() > 0.0))
            | bit(Finishes::HAIR, used(&|p| p.hair.is_some())),
    )
}

/// Does the base send light to its far side?
fn is_translucent(p: &Physical) -> bool {
    p.conductor.is_none() && p.diffuse_transmission.is_some_and(|of| of.weight > 0.0)
}

/// What a material has beside base, facets and what passes, with the maps of that.
pub(super) fn finish(m: &Material, maps: FinishMaps, spectra: &Spectra) -> Finish {
    let Some(p) = m.physical else { return Finish::NONE };
    let coat = p.coat.unwrap_or(Coat { weight: 0.0, roughness: 0.0 });
    let sheen = p.sheen.unwrap_or(Sheen { colour: Vec3::ZERO, roughness: 0.0 });
    let film = p.film.unwrap_or(ThinFilm { weight: 0.0, ior: 1.0, thickness: [0.0; 2] });
    let beyond = p.diffuse_transmission.filter(|_| is_translucent(&p));
    let beyond = beyond.unwrap_or(DiffuseTransmission { weight: 0.0, colour: Vec3::ZERO });
    let [least, most] = film.thickness;
    Finish {
        coat: colour(Vec3::new(coat.weight, coat.roughness, film.weight), film.ior.to_bits()),
        sheen: colour(sheen.colour, flushed_number(sheen.roughness).to_bits()),
        beyond: colour(beyond.colour, flushed_number(beyond.weight).to_bits()),
        film: colour(Vec3::new(least, most, p.dispersion()), spectra.glass(p.glass)),
        hair: p.hair.map_or(UVec4::ZERO, hair),
        maps,
    }
}

/// What kernels know of hair, see [`Finish::hair`].
fn hair(of: Hair) -> UVec4 {
    let (over, scale) = (std::f64::consts::LN_2 / of.fit(), of.scale() / std::f64::consts::TAU);
    let lean = math::sin(f64::from(of.tilt).to_radians());
    let numbers = Vec3::new(over as f32, of.variance() as f32, scale as f32);
    pack(numbers, flushed_number(lean as f32).to_bits())
}

/// A light's record; `index` is for the message.
pub(super) fn light(light: &Light, index: usize, normalisation: &Normalisation) -> Result<LightRecord> {
    let far = || Error::new(format!("light {} is too far away: move it nearer to the scene", index + 1));
    let at = |p: Vec3| -> Result<Vec3> { normalisation.place_anywhere(p).ok_or_else(far) };
    let record = |position, kind, light: Vec3, axis: Vec3, (inner, outer): (f32, f32)| LightRecord {
        position: pack(position, kind),
        colour: colour(light, inner.to_bits()),
        axis: pack(axis, outer.to_bits()),
    };
    Ok(match *light {
        Light::Point { position, colour, .. } => {
            record(at(position)?, LightRecord::POINT, colour, Vec3::ZERO, (0.0, 0.0))
        }
        Light::Directional { direction, colour, .. } => {
            record(unit(-direction), LightRecord::DIRECTIONAL, colour, Vec3::ZERO, (0.0, 0.0))
        }
        Light::Spot { position, target, colour, outer, inner, falloff, .. } => {
            let cosine = |degrees: f32| flushed_number(math::cos(f64::from(degrees).to_radians()) as f32);
            let axis = unit_between(position, target);
            let (inner, outer) = (cosine(inner), cosine(outer));
            let (kind, inner) = match falloff {
                Falloff::Smooth => (LightRecord::SPOT, inner),
                // The extension's ramp is never narrower.
                Falloff::Gltf => (LightRecord::RAMP, inner.max(outer + 0.001)),
            };
            record(at(position)?, kind, colour, axis, (inner, outer))
        }
    })
}

fn unit(v: Vec3) -> Vec3 {
    flushed(v.as_dvec3().normalize_or_zero().as_vec3())
}

fn unit_between(from: Vec3, to: Vec3) -> Vec3 {
    flushed((to.as_dvec3() - from.as_dvec3()).normalize_or_zero().as_vec3())
}
