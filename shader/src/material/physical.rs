//! From a physical material's record to its closure.

use super::bend::bent;
use super::bsdf::Bsdf;
use super::finish::{Channels, above, finished};
use super::fresnel::Reflectance;
use super::layers::{Layers, Way};
use super::{Coat, Coated, Ggx, Hair, Seen, Sheen, Surface, axes};
use crate::buffer::read;
use crate::data::{Effects, Finish, Finishes, Media, Physical, Waves, numbers};
use crate::geometry::SurfaceInteraction;
use crate::integrator::ScatterContext;
use crate::light::Lighting;
use crate::real::{Real, Scalar, TINY, V3};
use crate::scene::LaunchContext;
use crate::texture::Covering;

/// What a physical material says at a place, as textures may change it there.
#[derive(Clone, Copy)]
pub struct Parameters<R: Real> {
    /// Linear RGB in [0, 1].
    pub base: V3<R>,
    /// In [0, 1].
    pub roughness: R,
    /// In [0, 1].
    pub metalness: R,
    /// Linear RGB in [0, 1].
    pub transmission: V3<R>,
    /// Index of refraction.
    pub ior: R,
    /// What the dielectric part reflects at normal incidence, linear RGB in [0, 1].
    pub normal: V3<R>,
    /// The same at grazing angles.
    pub grazing: R,
    /// Strength of anisotropy in [0, 1].
    pub anisotropy: R,
    /// Cosine and sine of the angle of the axis of anisotropy, along which highlights are stretched.
    pub axis: (R, R),
}

impl<R: Scalar> Parameters<R> {
    /// What the record says, as textures change it.
    #[inline(always)]
    pub fn new(launch: &LaunchContext<'_>, material: &Physical, covering: &Covering<R>) -> Self {
        let colour = |record| V3::<R>::splat(numbers(record));
        let number = |bits| R::splat(f32::from_bits(bits));
        let shape = colour(material.shape);
        let axis = (number(material.eta.w), number(material.k.w));
        // Angles add: that of the material and that of the map.
        let (cosine, sine) = covering.axis;
        let turned = (axis.0 * cosine - axis.1 * sine, axis.1 * cosine + axis.0 * sine);
        let strength = (cosine * cosine + sine * sine).sqrt();
        let dielectric = colour(material.dielectric).times(covering.specular_tint);
        let grazing = number(material.dielectric.w) * covering.specular_weight;
        Parameters {
            base: launch.banded(colour(material.base).times(covering.base)),
            roughness: shape.x * covering.roughness,
            metalness: shape.y * covering.metalness,
            transmission: launch.banded(colour(material.transmission) * covering.transmission),
            ior: number(material.shape.w),
            normal: launch.banded(dielectric.map(|c| c.min(R::splat(1.0))) * grazing),
            grazing,
            anisotropy: shape.z * strength,
            axis: turned,
        }
    }

    /// The axes of a surface's frame, turned to the axis of anisotropy.
    #[inline(always)]
    fn turned(&self, [x, y, z]: [V3<R>; 3]) -> [V3<R>; 3] {
        let (cosine, sine) = self.axis;
        let none = cosine.eq(R::splat(0.0)) && sine.eq(R::splat(0.0));
        let across = |a: V3<R>, b: V3<R>| (a + b).map(|c| c.flush(TINY));
        let (cosine, sine) = (R::select(none, R::splat(1.0), cosine), sine);
        let along = across(x * cosine, y * sine).direction_and_length().0;
        [along, across(y * cosine, x * -sine).direction_and_length().0, z]
    }
}

/// The closure of a surface that is seen along a unit direction.
#[inline(always)]
pub fn closure<'a, R: Scalar>(
    launch: &LaunchContext<'_>,
    context: &ScatterContext<'a>,
    (seen, surface): (&Seen<R>, &Surface<R>),
    covering: &Covering<R>,
    channels: Channels<R>,
) -> Coated<'a, R> {
    let (effects, finishes) = (launch.spec.effects, launch.spec.finishes);
    let Seen { interaction, direction, .. } = *seen;
    let material = read(context.physicals, seen.material());
    let leans = effects.has(Effects::SMOOTH) || (effects.has(Effects::TANGENTS) && effects.has(Effects::TEXTURED));
    let normal = if leans { bent(&interaction, surface.normal, direction) } else { surface.normal };
    let frame = axes(launch, &context.shading, seen, normal);
    let at = Parameters::new(launch, &material, covering);
    let at =
        if launch.spec.media.has(Media::NESTED) { Parameters { ior: at.ior.div(surface.around), ..at } } else { at };
    let is_physical = material.has(Physical::IS_PHYSICAL);
    let frame = if effects.has(Effects::ANISOTROPIC) && is_physical { at.turned(frame) } else { frame };
    let layers = if is_physical {
        physical(launch, &context.lighting, &material, (&at, &interaction))
    } else {
        whitted(effects, surface, &interaction)
    };
    // One way for all, since a closure with tables must not be chosen between two.
    let has_finish = finishes.any() && is_physical;
    let finish = if has_finish { read(context.finishes, seen.material()) } else { Finish::NONE };
    let layers = if has_finish {
        let cosine = -direction.dot(frame[2]);
        let body = (&interaction, surface.around, &channels);
        finished(launch, &context.lighting, &finish, (&at, &covering.finish), body, (layers, cosine))
    } else {
        layers
    };
    let base = Bsdf::new((effects, finishes), context.albedos, frame, direction, layers);
    let on = if has_finish {
        above(launch, context, &finish, (seen, surface), covering, (base.viewer, layers.way))
    } else {
        (Coat::none(), Sheen::none())
    };
    let is_hair = finishes.has(Finishes::HAIR) && finish.is_hair();
    let hair = if is_hair { Hair::new(&finish, base.viewer, at.base, at.ior) } else { Hair::none() };
    Coated::new(finishes, base, on).or_hair(hair)
}

/// glTF 2.0, appendix B, with KHR_materials_ior, specular, transmission, volume and anisotropy; or a conductor.
#[inline(always)]
fn physical<R: Scalar>(
    launch: &LaunchContext<'_>,
    lighting: &Lighting<'_>,
    material: &Physical,
    (at, interaction): (&Parameters<R>, &SurfaceInteraction<R>),
) -> Layers<R> {
    let effects = launch.spec.effects;
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    let anisotropy = if effects.has(Effects::ANISOTROPIC) { at.anisotropy } else { zero };
    let ggx = rough(at.roughness, anisotropy);
    let (eta, k) = complex_index(launch, lighting, material);
    let none = Layers {
        diffuse: V3::zero(),
        beyond: V3::zero(),
        through: V3::zero(),
        reflectance: Reflectance {
            normal: eta,
            grazing: k,
            is_conductor: true,
            mean_colour: launch.banded(V3::splat(numbers(material.dielectric))),
            glass: zero,
            eta: one,
            has_two_faces: false,
        },
        is_coated: true,
        way: Way::OPAQUE,
        ggx,
    };
    if effects.has(Effects::CONDUCTOR) && material.has(Physical::CONDUCTOR) {
        return none;
    }
    let (metal, rest) = (at.metalness, one - at.metalness);
    let transmission = at.transmission;
    let (base, white) = (at.base * rest, V3::new(one, one, one));
    let passes = zero.lt(transmission.greatest()) && zero.lt(rest);
    let way = if !passes {
        Way::OPAQUE
    } else if material.has(Physical::THIN) {
        Way::THIN
    } else {
        Way::BODY
    };
    let is_body = effects.has(Effects::REFRACTION) && way == Way::BODY;
    let is_thin = effects.has(Effects::THIN) && way == Way::THIN;
    let is_glass = is_body || is_thin;
    let ior = at.ior;
    let dielectric = if is_glass { zero } else { rest };
    let grazing = at.grazing * dielectric + metal;
    Layers {
        diffuse: base.times(white - transmission),
        through: if passes { base.times(transmission) } else { V3::zero() },
        reflectance: Reflectance {
            normal: at.normal * dielectric + at.base * metal,
            grazing: V3::new(grazing, grazing, grazing),
            is_conductor: false,
            mean_colour: V3::zero(),
            glass: if is_glass { at.grazing * rest } else { zero },
            eta: if is_body {
                interaction.relative_ior(ior)
            } else if is_thin {
                one.div(ior)
            } else {
                one
            },
            has_two_faces: material.has(Physical::TWO_FACES),
        },
        way,
        // Facets of glass that hardly bends light have directions that rounding loses.
        ggx: if is_body && (ior - one).abs().lt(R::splat(LEAST_BEND)) { smooth() } else { ggx },
        ..none
    }
}

/// The complex index of refraction of a conductor.
#[inline(always)]
fn complex_index<R: Scalar>(
    launch: &LaunchContext<'_>,
    lighting: &Lighting<'_>,
    material: &Physical,
) -> (V3<R>, V3<R>) {
    let (row, waves) = (material.attenuation.w, launch.spec.waves);
    if waves.has(Waves::SPECTRAL) && waves.has(Waves::MEASURED) && row != 0 {
        return (launch.bands.row(lighting.spectra, row), launch.bands.row(lighting.spectra, row + 1));
    }
    (launch.banded(V3::splat(numbers(material.eta))), launch.banded(V3::splat(numbers(material.k))))
}

/// The least that an index of refraction is above 1 where facets may be rough.
const LEAST_BEND: f32 = 1.0 / 256.0;

/// A surface of the thesis' model: Lambert, with a mirror or glass beside it.
#[inline(always)]
fn whitted<R: Scalar>(effects: Effects, surface: &Surface<R>, interaction: &SurfaceInteraction<R>) -> Layers<R> {
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    let is_lens = effects.has(Effects::REFRACTION) && !surface.ior.eq(zero);
    let mirror = if is_lens { V3::zero() } else { surface.reflection };
    Layers {
        diffuse: surface.diffuse,
        beyond: V3::zero(),
        through: if is_lens { surface.transmission } else { V3::zero() },
        reflectance: Reflectance {
            normal: mirror,
            grazing: mirror,
            is_conductor: false,
            mean_colour: V3::zero(),
            glass: if is_lens { one } else { zero },
            eta: if is_lens { interaction.relative_ior(surface.ior) } else { one },
            has_two_faces: false,
        },
        is_coated: false,
        way: if is_lens { Way::BODY } else { Way::OPAQUE },
        ggx: smooth(),
    }
}

#[inline(always)]
fn smooth<R: Scalar>() -> Ggx<R> {
    Ggx { x: R::splat(0.0), y: R::splat(0.0) }
}

/// Facets by perceived roughness, whose square they have, and more along the axis of anisotropy, by its strength
/// (KHR_materials_anisotropy): highlights are stretched along it.
#[inline(always)]
pub(super) fn rough<R: Scalar>(roughness: R, strength: R) -> Ggx<R> {
    let (least, one) = (R::splat(Ggx::<R>::LEAST), R::splat(1.0));
    let alpha = (roughness * roughness).min(one);
    let along = alpha + (one - alpha) * (strength * strength);
    if along.lt(least) { smooth() } else { Ggx { x: along, y: alpha.max(least) } }
}

/// What is left of light that has gone a distance inside of a body, linear RGB or at each of a sample's wavelengths.
#[inline(always)]
pub fn transmittance<R: Scalar>(launch: &LaunchContext<'_>, material: &Physical, distance: R) -> V3<R> {
    let lengths = distance * R::splat(f32::from_bits(material.transmission.w));
    launch.banded(V3::<R>::splat(numbers(material.attenuation))).map(|colour| colour.pow(lengths))
}
