//! Every light that an integrator chooses from which samples one of them, and how likely each is.

use eyerays_shader::data::{Emission, Emitter, Light as LightRecord, Opacity, Primitive, pack};
use glam::{DVec3, UVec4, Vec3};
use std::f64::consts::PI;

use super::normalisation::Normalisation;
use super::records::colour;
use super::textures::Textures;
use crate::scene::{Light, Material};

/// What emits, as kernels read it.
#[derive(Debug, Clone, Default)]
pub struct Lighting {
    /// The scene's lights, then its primitives that emit, by their numbers.
    pub emitters: Vec<Emitter>,
    /// By material; empty if none emits.
    pub emissions: Vec<Emission>,
    /// The probability that the environment is chosen of all.
    pub environment: f32,
}

/// The primitives that emit: what does not change with the lights beside them.
pub(super) struct Lamps {
    /// The place in leaf order and the power of each that has an area, by their numbers; of a split one the first place.
    powers: Vec<(u32, f64)>,
    /// Each material's emission, whose density is left open, and its power of a unit of area; none if there is no lamp.
    emissions: Vec<(Emission, f64)>,
    /// The least and the greatest corner around all of them, if there are any.
    pub bounds: Option<[Vec3; 2]>,
    /// Light from far away, over all directions, if there is an environment.
    far_light: Option<f64>,
}

impl Lamps {
    pub fn new(
        materials: &[Material],
        primitives: &[Primitive],
        (textures, far_light): (&Textures, Option<f64>),
    ) -> Self {
        if materials.iter().all(|material| material.emission == Vec3::ZERO) {
            return Lamps { powers: Vec::new(), emissions: Vec::new(), bounds: None, far_light };
        }
        let flux = |(material, number)| flux(material, textures.emission(number).1);
        let fluxes: Vec<f64> = materials.iter().zip(0..).map(flux).collect();
        let power = |primitive: &Primitive| area(primitive) * fluxes[primitive.material() as usize];
        let powers = primitives.iter().zip(0..).map(|(primitive, index)| (primitive.number(), index, power(primitive)));
        let mut powers: Vec<(u32, u32, f64)> = powers.filter(|&(.., power)| power > 0.0).collect();
        powers.sort_unstable_by_key(|&(number, index, _)| (number, index));
        powers.dedup_by_key(|&mut (number, ..)| number);
        let boxes = powers.iter().map(|&(_, index, _)| primitives[index as usize].bounds());
        let boxes = boxes.map(|(least, greatest)| [least, greatest]);
        let bounds = boxes.reduce(|[a, b], [least, greatest]| [a.min(least), b.max(greatest)]);
        let emission = |(material, number): (&Material, usize)| {
            let (map, opacity) = (textures.emission(number).0, textures.opacity(number));
            let bit = |bit: u32, is_set: bool| if is_set { bit } else { 0 };
            let bits =
                bit(Emission::TWO_SIDED, material.two_sided) | bit(Emission::COLOURED, material.emission_is_coloured);
            let sides = UVec4::new(bits, map, opacity.mask.z, opacity_of(&opacity).to_bits());
            (Emission { radiance: colour(material.emission, 0), sides }, fluxes[number])
        };
        let emissions = if powers.is_empty() { Vec::new() } else { materials.iter().zip(0..).map(emission).collect() };
        Lamps {
            powers: powers.into_iter().map(|(_, index, power)| (index, power)).collect(),
            emissions,
            bounds,
            far_light,
        }
    }

    /// Is there none? Pictures may take all light away that materials emit.
    pub fn is_empty(&self) -> bool {
        self.powers.is_empty()
    }
}

impl Lighting {
    /// Of lights with their records, and lamps. Each is as likely as its power is, in the normalised scene.
    pub(super) fn new(lights: (&[Light], &[LightRecord]), lamps: &Lamps, normalisation: &Normalisation) -> Self {
        let of_lights = lights.0.iter().map(|light| power(light, normalisation.scale));
        // A black environment is chosen where there is nothing else: kernels that know one choose something.
        let is_only = lights.0.is_empty() && lamps.is_empty();
        let far_light = lamps.far_light.filter(|&light| light > 0.0 || is_only);
        // That on a scene within a sphere of radius 1.
        let far = far_light.map(|light| PI * light);
        let powers: Vec<f64> = of_lights.chain(lamps.powers.iter().map(|&(_, power)| power)).chain(far).collect();
        let total: f64 = powers.iter().sum();
        let records = lights.0.iter().zip(lights.1).map(|(light, record)| scaled(light, record, normalisation));
        let records = records.chain(lamps.powers.iter().map(|&(index, _)| of_primitive(index)));
        let records = records.chain(far.map(|_| of_environment()));
        let emitters = records.zip(table(&powers)).map(|(light, choice)| Emitter { light, choice }).collect();
        let with_density = |&(emission, flux): &(Emission, f64)| {
            let density = if total > 0.0 { (flux / total) as f32 } else { 0.0 };
            Emission { radiance: UVec4 { w: density.to_bits(), ..emission.radiance }, ..emission }
        };
        let environment = far.map_or(0.0, |power| if total > 0.0 { (power / total) as f32 } else { 1.0 });
        Lighting { emitters, environment, emissions: lamps.emissions.iter().map(with_density).collect() }
    }
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

fn of_primitive(index: u32) -> LightRecord {
    LightRecord {
        position: pack(Vec3::ZERO, Emitter::PRIMITIVE),
        colour: pack(Vec3::ZERO, 0),
        axis: pack(Vec3::ZERO, index),
    }
}

/// The alias table of some powers (Vose, A Linear Algorithm for Generating Random Numbers with a Given Distribution, 1991): for
/// each its threshold, its alias and the bits of its probability. All are as likely if all are black.
fn table(powers: &[f64]) -> Vec<UVec4> {
    let total: f64 = powers.iter().sum();
    let share = |power: f64| if total > 0.0 { power / total } else { 1.0 / powers.len() as f64 };
    let mut left: Vec<f64> = powers.iter().map(|&power| share(power) * powers.len() as f64).collect();
    let (mut less, mut more): (Vec<usize>, Vec<usize>) = (0..powers.len()).partition(|&i| left[i] < 1.0);
    let mut table: Vec<UVec4> =
        powers.iter().zip(0..).map(|(&power, i)| UVec4::new(u32::MAX, i, (share(power) as f32).to_bits(), 0)).collect();
    while let (Some(&small), Some(&large)) = (less.last(), more.last()) {
        less.pop();
        table[small].x = (left[small] * 4_294_967_296.0) as u32;
        table[small].y = large as u32;
        left[large] -= 1.0 - left[small];
        if left[large] < 1.0 {
            more.pop();
            less.push(large);
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How often a table chooses each, by its thresholds.
    fn shares(table: &[UVec4]) -> Vec<f64> {
        let mut shares = vec![0.0; table.len()];
        for (i, entry) in table.iter().enumerate() {
            let own = f64::from(entry.x) / f64::from(u32::MAX);
            shares[i] += own / table.len() as f64;
            shares[entry.y as usize] += (1.0 - own) / table.len() as f64;
        }
        shares
    }

    #[test]
    fn each_light_is_chosen_as_often_as_its_power_says() {
        let many: Vec<f64> = (0..1000).map(|i| f64::from((i * 7919) % 1000)).collect();
        for powers in [&[1.0][..], &[1.0, 1.0], &[3.0, 0.0, 1.0], &[1e-9, 1.0, 1e9], &many] {
            let (table, total) = (table(powers), powers.iter().sum::<f64>());
            for ((share, power), entry) in shares(&table).into_iter().zip(powers).zip(&table) {
                assert!((share - power / total).abs() < 1e-8, "{powers:?}: {share}");
                assert_eq!(f32::from_bits(entry.z), (power / total) as f32);
            }
        }
        assert!(table(&[]).is_empty());
        assert_eq!(shares(&table(&[0.0, 0.0])), [0.5, 0.5]);
    }
}
