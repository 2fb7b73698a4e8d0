//! Every light that an integrator chooses from which samples one of them, and how likely each is.

use eyerays_shader::data::{Emission, Emitter, Light as LightRecord, LightNode, Opacity, Primitive, numbers, pack};
use glam::{DVec3, UVec4, Vec3};
use std::f64::consts::PI;

use super::alias::table;
use super::keys::Way;
use super::light_tree::{Bounded, Cone, LightTree};
use super::normalisation::Normalisation;
use super::records::colour;
use super::shining::Shining;
use super::spectra::Spectra;
use super::textures::Textures;
use crate::scene::{Light, LightGroups, Material};

/// What emits, as kernels read it.
#[derive(Debug, Clone, Default)]
pub struct Lighting {
    /// The scene's lights, then its primitives that emit, by their numbers, and the environment; what is far away first where there
    /// are nodes.
    pub emitters: Vec<Emitter>,
    /// The hierarchy of those that have a place; empty if they are one lamp.
    pub nodes: Vec<LightNode>,
    /// How many emitters are far away, where there are nodes.
    pub far: u32,
    /// By material; empty if none emits.
    pub emissions: Vec<Emission>,
    /// The probability that the environment is chosen of all.
    pub environment: f32,
}

/// The primitives that emit: what does not change with the lights beside them.
pub(super) struct Lamps {
    /// Each that has an area, by their numbers.
    lamps: Vec<Lamp>,
    /// Each material's emission, whose density is left open, and its power of a unit of area; none if there is no lamp.
    emissions: Vec<(Emission, f64)>,
    /// The least and the greatest corner around all of them, if there are any.
    pub bounds: Option<[Vec3; 2]>,
    /// Light from far away, over all directions, if there is an environment.
    far_light: Option<f64>,
}

impl Lamps {
    pub fn new(
        (materials, groups, spectra): (&[Material], &LightGroups, &Spectra),
        shining: &[Shining],
        (textures, far_light): (&Textures, Option<f64>),
    ) -> Self {
        if shining.is_empty() {
            return Lamps { lamps: Vec::new(), emissions: Vec::new(), bounds: None, far_light };
        }
        let flux = |(material, number)| flux(material, textures.emission(number).1);
        let fluxes: Vec<f64> = materials.iter().zip(0..).map(flux).collect();
        let flux = |shining: &Shining| fluxes[shining.primitive.material() as usize];
        let shining = shining.iter().filter(|shining| area(&shining.primitive) * flux(shining) > 0.0);
        let lamp = |shining: &Shining| {
            Lamp::new(shining, (flux(shining), materials[shining.primitive.material() as usize].two_sided))
        };
        let lamps: Vec<Lamp> = shining.clone().map(lamp).collect();
        let boxes = shining.map(|shining| shining.bounds);
        let bounds = boxes.reduce(|[a, b], [least, greatest]| [a.min(least), b.max(greatest)]);
        let emission = |(material, number): (&Material, usize)| {
            let (map, opacity) = (textures.emission(number).0, textures.opacity(number));
            let bit = |bit: u32, is_set: bool| if is_set { bit } else { 0 };
            let bits =
                bit(Emission::TWO_SIDED, material.two_sided) | bit(Emission::COLOURED, material.emission_is_coloured);
            let illuminant = spectra.light(material.illuminant) << Emission::ILLUMINANT;
            let bits = bits | illuminant | groups.number(&material.group) << Emission::FLAGS;
            let sides = UVec4::new(bits, map, opacity.mask.z, opacity_of(&opacity).to_bits());
            (Emission { radiance: colour(material.emission, 0), sides }, fluxes[number])
        };
        let emissions = if lamps.is_empty() { Vec::new() } else { materials.iter().zip(0..).map(emission).collect() };
        Lamps { lamps, emissions, bounds, far_light }
    }

    /// Is there none? Pictures may take all light away that materials emit.
    pub fn is_empty(&self) -> bool {
        self.lamps.is_empty()
    }

    /// Are they one lamp, whose parts are all as near to whatever they light: a primitive, or a rectangle of two triangles?
    fn are_one(&self) -> bool {
        match &self.lamps[..] {
            [] | [_] => true,
            [a, b] => a.is_triangle && b.is_triangle && a.is_beside(b),
            _ => false,
        }
    }
}

/// A primitive that emits.
struct Lamp {
    number: u32,
    /// Its place in leaf order; of a split one the first.
    index: u32,
    /// The first key of the copy that it is in, or [`Hit::NOTHING`](eyerays_shader::ray::Hit::NOTHING).
    instance: u32,
    area: f64,
    power: f64,
    is_triangle: bool,
    bounded: Bounded,
}

impl Lamp {
    /// Of a material that sends a flux from a unit of area.
    fn new(shining: &Shining, (flux, is_two_sided): (f64, bool)) -> Self {
        let Shining { primitive, index, instance, bounds: [least, greatest], cone } = shining;
        let area = area(primitive);
        let (number, power) = (primitive.number(), area * flux);
        let sides = if is_two_sided { 2.0 } else { 1.0 };
        let intensity = power / (PI * sides) / if primitive.is_sphere() { 4.0 } else { 1.0 };
        let bounded = Bounded { least: least.as_dvec3(), greatest: greatest.as_dvec3(), intensity, cone: *cone };
        let (index, instance) = (*index, *instance);
        Lamp { number, index, instance, area, power, is_triangle: primitive.is_triangle(), bounded }
    }

    /// As an emitter's, but for its trail.
    fn record(&self) -> LightRecord {
        let per_area = (1.0 / self.area).min(f64::from(f32::MAX)) as f32;
        LightRecord {
            position: UVec4::new(self.number, 0, self.instance, Emitter::PRIMITIVE),
            colour: UVec4::new(per_area.to_bits(), 0, 0, 0),
            axis: pack(Vec3::ZERO, self.index),
        }
    }

    /// Do both lie in a plane and in a box of the size of either?
    fn is_beside(&self, other: &Lamp) -> bool {
        let (a, b) = (&self.bounded, &other.bounded);
        let size = |of: &Bounded| of.greatest - of.least;
        let all = a.greatest.max(b.greatest) - a.least.min(b.least);
        let flat = a.cone.axis.dot(b.cone.axis) > 1.0 - 1e-6;
        flat && (size(a) - all).length() <= 1e-3 * all.length() && (size(b) - all).length() <= 1e-3 * all.length()
    }
}

/// The normal of a flat primitive's front.
pub(super) fn normal(primitive: &Primitive) -> DVec3 {
    if primitive.is_disk() {
        return primitive.normal().as_dvec3();
    }
    let [a, b, c] = primitive.vertices().map(|v| v.as_dvec3());
    (b - a).cross(c - a).normalize_or_zero()
}

impl Lighting {
    /// Of lights with their records, and lamps. Each is as likely as its power is, in the normalised scene; or, of many that have a
    /// place, as its light may arrive.
    pub(super) fn new(
        lights: (&[Light], &[LightRecord], &[Way]),
        lamps: &Lamps,
        groups: (&LightGroups, u32),
        normalisation: &Normalisation,
    ) -> Self {
        let choices = choices(lights, lamps, groups, normalisation);
        let total: f64 = choices.iter().map(|choice| choice.power).sum();
        let with_density = |&(emission, flux): &(Emission, f64)| {
            let density = if total > 0.0 { (flux / total) as f32 } else { 0.0 };
            Emission { radiance: UVec4 { w: density.to_bits(), ..emission.radiance }, ..emission }
        };
        let emissions = lamps.emissions.iter().map(with_density).collect();
        let near = choices.iter().filter(|choice| choice.bounded.is_some()).count();
        let are_one = near <= 1 || near == lamps.lamps.len() && lamps.are_one();
        let chosen = if are_one { Lighting::by_power(&choices) } else { Lighting::by_place(choices) };
        Lighting { emissions, ..chosen }
    }

    /// Each as often as its power says.
    fn by_power(choices: &[Choice]) -> Self {
        let powers: Vec<f64> = choices.iter().map(|choice| choice.power).collect();
        let emitter = |(choice, drawn): (&Choice, UVec4)| Emitter {
            light: choice.record,
            choice: UVec4 { w: choice.group << Emitter::STEPS, ..drawn },
        };
        let emitters = choices.iter().zip(table(&powers)).map(emitter).collect();
        Lighting { emitters, environment: environment_share(choices), ..Lighting::default() }
    }

    /// By the hierarchy, and what is far away beside it.
    fn by_place(mut choices: Vec<Choice>) -> Self {
        choices.sort_by_key(|choice| choice.bounded.is_some());
        let far = choices.iter().filter(|choice| choice.bounded.is_none()).count();
        let steps = far_steps(&choices);
        let bounded: Vec<Bounded> = choices.iter().filter_map(|choice| choice.bounded).collect();
        let tree = LightTree::new(&bounded, far as u32);
        let Lighting { mut emitters, environment, .. } = Lighting::by_power(&choices[..far]);
        emitters.iter_mut().for_each(|emitter| emitter.choice.w |= steps);
        let near = choices[far..].iter().zip(&tree.trails).map(|(choice, &trail)| {
            let mut light = choice.record;
            if light.position.w == Emitter::PRIMITIVE {
                light.position.y = trail;
            }
            Emitter { light, choice: UVec4::new(0, 0, 0, steps | choice.group << Emitter::STEPS) }
        });
        emitters.extend(near);
        let environment = environment * (steps as f32 / LightNode::STEPS as f32);
        Lighting { emitters, nodes: tree.nodes, far: far as u32, environment, emissions: Vec::new() }
    }
}

/// What may be chosen.
struct Choice {
    power: f64,
    record: LightRecord,
    /// Where it is, unless it is far away.
    bounded: Option<Bounded>,
    /// The group of a light without extent, or of the environment.
    group: u32,
}

/// All of a scene: its lights, its lamps, and its environment, which is in the group `background`.
fn choices(
    (lights, records, ways): (&[Light], &[LightRecord], &[Way]),
    lamps: &Lamps,
    (groups, background): (&LightGroups, u32),
    normalisation: &Normalisation,
) -> Vec<Choice> {
    let of_light = |(number, (light, record)): (usize, (&Light, &LightRecord))| {
        let way = ways.iter().find(|way| way.light == number);
        let (record, group) = (scaled(light, record, normalisation), groups.number(light.group()));
        Choice { power: power(light, normalisation.scale), bounded: bounded(light, &record, way), record, group }
    };
    let of_lamp =
        |lamp: &Lamp| Choice { power: lamp.power, record: lamp.record(), bounded: Some(lamp.bounded), group: 0 };
    // A black environment is chosen where there is nothing else: kernels that know one choose something.
    let is_only = lights.is_empty() && lamps.is_empty();
    let far_light = lamps.far_light.filter(|&light| light > 0.0 || is_only);
    // That on a scene within a sphere of radius 1.
    let far =
        far_light.map(|light| Choice { power: PI * light, record: of_environment(), bounded: None, group: background });
    lights.iter().zip(records).enumerate().map(of_light).chain(lamps.lamps.iter().map(of_lamp)).chain(far).collect()
}

/// The probability of the environment, if it is among some choices.
fn environment_share(choices: &[Choice]) -> f32 {
    let total: f64 = choices.iter().map(|choice| choice.power).sum();
    let environment = choices.iter().find(|choice| choice.record.position.w == Emitter::ENVIRONMENT);
    environment.map_or(0.0, |choice| if total > 0.0 { (choice.power / total) as f32 } else { 1.0 })
}

/// How likely something far away is chosen, in steps: as its power says, but neither it nor what is near is left with less than a
/// quarter, since power tells little of what arrives from near.
fn far_steps(choices: &[Choice]) -> u32 {
    let sum = |is_far: bool| -> f64 {
        choices.iter().filter(|choice| choice.bounded.is_none() == is_far).map(|choice| choice.power).sum()
    };
    let (far, near) = (sum(true), sum(false));
    if far == 0.0 {
        return 0;
    }
    let share = if near == 0.0 { 1.0 } else { (far / (far + near)).clamp(0.25, 0.75) };
    (share * f64::from(LightNode::STEPS)) as u32
}

/// A light without extent as the hierarchy takes it, if it has a place.
fn bounded(light: &Light, record: &LightRecord, way: Option<&Way>) -> Option<Bounded> {
    let cone = match *light {
        Light::Directional { .. } => return None,
        Light::Point { .. } => Cone::all(),
        Light::Spot { outer, .. } => {
            let opening = f64::from(outer).to_radians();
            let opening = if way.is_some() { PI } else { opening };
            Cone { axis: numbers(record.axis).as_dvec3(), opening, is_spread: false, is_two_sided: false }
        }
    };
    let (place, intensity) = (numbers(record.position), brightness(numbers(record.colour)));
    let [least, greatest] = way.map_or([place; 2], |way| way.bounds).map(Vec3::as_dvec3);
    Some(Bounded { least, greatest, intensity, cone })
}

/// The mean of the channels.
fn brightness(colour: Vec3) -> f64 {
    colour.as_dvec3().dot(DVec3::ONE) / 3.0
}

/// Power of a light without extent. That of a directional one is what reaches a scene within a sphere of radius 1.
fn power(light: &Light, scale: f64) -> f64 {
    match *light {
        Light::Point { colour, .. } => 4.0 * PI * brightness(colour) * scale * scale,
        Light::Directional { colour, .. } => PI * brightness(colour),
        Light::Spot { colour, outer, .. } => {
            let cap = 1.0 - crate::math::cos(f64::from(outer).to_radians());
            2.0 * PI * cap * brightness(colour) * scale * scale
        }
    }
}

/// Power of a unit of area that is covered with a texture of some mean.
fn flux(material: &Material, covered: Vec3) -> f64 {
    PI * brightness(material.emission * covered) * if material.two_sided { 2.0 } else { 1.0 }
}

/// The opacity of an [`Emission`], in one number.
fn opacity_of(opacity: &Opacity) -> f32 {
    let (factor, least) = (f32::from_bits(opacity.mask.x), f32::from_bits(opacity.mask.y));
    // A mask of factor 0 is nowhere.
    if least > 0.0 { -(least / factor).min(f32::MAX) } else { factor }
}

/// The area of a primitive as rays meet it.
fn area(primitive: &Primitive) -> f64 {
    let radius = f64::from(primitive.radius());
    if primitive.is_sphere() {
        4.0 * PI * radius * radius
    } else if primitive.is_disk() {
        PI * radius * radius
    } else {
        let [a, b, c] = primitive.vertices().map(|v| v.as_dvec3());
        (b - a).cross(c - a).length() / 2.0
    }
}

/// A light whose falloff is of distances in the normalised scene.
fn scaled(light: &Light, record: &LightRecord, normalisation: &Normalisation) -> LightRecord {
    match *light {
        Light::Directional { .. } => *record,
        Light::Point { colour: own, .. } | Light::Spot { colour: own, .. } => {
            let intensity = (own.as_dvec3() * normalisation.scale * normalisation.scale).as_vec3();
            LightRecord { colour: colour(intensity, record.colour.w), ..*record }
        }
    }
}

fn of_environment() -> LightRecord {
    let nothing = pack(Vec3::ZERO, 0);
    LightRecord { position: pack(Vec3::ZERO, Emitter::ENVIRONMENT), colour: nothing, axis: nothing }
}
