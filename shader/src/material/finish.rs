//! What a record of finishes changes of a surface, and what it lays on it.

use super::bend::bent;
use super::film::film;
use super::fresnel::{Reflectance, schlick};
use super::layers::{Layers, Way};
use super::physical::{Parameters, rough};
use super::{Coat, Seen, Sheen, Surface, mapped};
use crate::data::{Effects, Finish, Finishes, SpectrumRow, Waves, numbers};
use crate::geometry::SurfaceInteraction;
use crate::integrator::ScatterContext;
use crate::light::Lighting;
use crate::real::{FAINT, Scalar, V3};
use crate::scene::LaunchContext;
use crate::texture::{Covering, FinishCovering};

fn number<R: Scalar>(bits: u32) -> R {
    R::splat(f32::from_bits(bits))
}

/// Light whose channels may be told apart: what of a path counts, linear RGB, and a number of which the last nine bits are drawn.
#[derive(Clone, Copy)]
pub struct Channels<R: Scalar> {
    /// Linear RGB.
    pub weight: V3<R>,
    /// Its last nine bits choose.
    pub draw: u32,
}

impl<R: Scalar> Channels<R> {
    /// One of the channels that count, by its number, and a colour of that one alone: one over its probability.
    #[inline(always)]
    fn chosen(&self) -> (u32, V3<R>) {
        /// All values of the bits that choose.
        const ALL: u32 = 512;
        let (zero, V3 { x, y, z }) = (R::splat(0.0), self.weight);
        let counts = |c: R| if zero.lt(c) { 1 } else { 0 };
        let (red, green, blue) = (counts(x), counts(y), counts(z));
        // A third of them for each of three, of which the last has one less.
        let of = match red + green + blue {
            3 => 171,
            2 => 256,
            _ => ALL,
        };
        let (first, second) = (red * of, (red + green) * of);
        let step = self.draw % ALL;
        let over = |steps: u32| R::splat(ALL as f32).over(R::splat(steps as f32));
        if step < first {
            (0, V3::new(over(of), zero, zero))
        } else if step < second {
            (1, V3::new(zero, over(of), zero))
        } else {
            (2, V3::new(zero, zero, over((ALL - second).max(1))))
        }
    }
}

/// How much more a body bends light of a channel than yellow light, over half of what it bends blue light more than red.
#[inline(always)]
fn bends<R: Scalar>(launch: &LaunchContext<'_>, lighting: &Lighting<'_>, finish: &Finish, channel: u32) -> R {
    let waves = launch.spec.waves;
    if !waves.has(Waves::SPECTRAL) {
        return R::splat(channel as f32) - R::splat(1.0);
    }
    let own = if waves.has(Waves::MEASURED) { finish.film.w } else { 0 };
    let row = if own == 0 { SpectrumRow::CAUCHY } else { own };
    let V3 { x, y, z } = launch.bands.row::<R>(lighting.spectra, row);
    R::select(channel == 0, x, R::select(channel == 1, y, z))
}

/// Of what light a film tells: of white, or of a sample's wavelengths by one over each in nanometres.
#[inline(always)]
fn light_of_film<R: Scalar>(launch: &LaunchContext<'_>, lighting: &Lighting<'_>) -> (Waves, V3<R>) {
    let waves = launch.spec.waves;
    let is_spectral = waves.has(Waves::SPECTRAL);
    let row = if is_spectral { launch.bands.row(lighting.spectra, SpectrumRow::PER_NANOMETRE) } else { V3::zero() };
    (waves, row)
}

/// What is below a finish: a base that sends light to its far side, facets with a film, a body that bends each channel by itself.
#[inline(always)]
pub fn finished<R: Scalar>(
    launch: &LaunchContext<'_>,
    lighting: &Lighting<'_>,
    finish: &Finish,
    (at, covering): (&Parameters<R>, &FinishCovering<R>),
    (interaction, around, channels): (&SurfaceInteraction<R>, R, &Channels<R>),
    (layers, cosine): (Layers<R>, R),
) -> Layers<R> {
    let (mut layers, finishes) = (layers, launch.spec.finishes);
    if finishes.has(Finishes::TRANSLUCENT) && !layers.reflectance.is_conductor {
        let (one, weight) = (R::splat(1.0), number::<R>(finish.beyond.w) * covering.beyond);
        let colour = launch.banded(V3::splat(numbers(finish.beyond)).times(covering.beyond_colour));
        let left = at.transmission.map(|passed| (one - passed) * (one - at.metalness) * weight);
        layers.beyond = colour.times(left).map(|c| c.flush(FAINT));
        layers.diffuse = (layers.diffuse * (one - weight)).map(|c| c.flush(FAINT));
    }
    let is_inside = layers.way == Way::BODY && !interaction.front;
    if finishes.has(Finishes::DISPERSIVE) && layers.way == Way::BODY {
        let spread = number::<R>(finish.film.z);
        if R::splat(0.0).lt(spread) {
            let (channel, colour) = channels.chosen();
            let side: R = bends(launch, lighting, finish, channel);
            layers.reflectance.eta = interaction.relative_ior(at.ior + (side * spread).div(around));
            layers.through = layers.through.times(colour);
        }
    }
    if finishes.has(Finishes::FILMED) && !layers.reflectance.is_conductor && !is_inside {
        let weight = number::<R>(finish.coat.z) * covering.film;
        if R::splat(0.0).lt(weight) {
            let (least, most) = (number::<R>(finish.film.x), number::<R>(finish.film.y));
            let thickness = least + (most - least) * covering.film_thickness;
            let of = (number(finish.coat.w), thickness);
            layers.reflectance = below_film(&layers.reflectance, cosine, light_of_film(launch, lighting), of, weight);
        }
    }
    layers
}

/// What facets below a film reflect that is on a share of them: as seen along the surface's normal, what Schlick's approximation tells
/// of the film there, as Khronos' own renderer has it.
#[inline(always)]
fn below_film<R: Scalar>(
    of: &Reflectance<R>,
    cosine: R,
    light: (Waves, V3<R>),
    (ior, thickness): (R, R),
    weight: R,
) -> Reflectance<R> {
    /// So near to grazing, all is reflected whatever there is.
    const MOST: f32 = 0.999;
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    let root = (one - of.eta).over(one + of.eta);
    let exact = of.glass * (root * root).flush(FAINT);
    let (normal, grazing) =
        (of.normal + V3::new(exact, exact, exact), of.grazing + V3::new(of.glass, of.glass, of.glass));
    let most = grazing.greatest();
    let base = (normal * R::select(zero.lt(most), most, one).reciprocal()).map(|c| c.max(zero).min(one));
    let (seen, share) = (film(light, cosine, (ior, thickness), base), schlick(cosine).min(R::splat(MOST)));
    let over = (one - share).reciprocal();
    let own = seen.map(|c| ((c - share) * over).max(zero).min(one)).times(grazing);
    let rest = one - weight;
    let mixed = |a: V3<R>, b: V3<R>| (a * rest + b * weight).map(|c| c.flush(FAINT));
    Reflectance { normal: mixed(of.normal, own), grazing: mixed(of.grazing, grazing), glass: of.glass * rest, ..*of }
}

/// What lies on a surface whose viewer is given in its frame; nothing on the inside of a body.
#[inline(always)]
pub fn above<R: Scalar>(
    launch: &LaunchContext<'_>,
    context: &ScatterContext<'_>,
    finish: &Finish,
    (seen, surface): (&Seen<R>, &Surface<R>),
    covering: &Covering<R>,
    (viewer, way): (V3<R>, Way),
) -> (Coat<R>, Sheen<R>) {
    let finishes = launch.spec.finishes;
    let (mut coat, mut sheen) = (Coat::none(), Sheen::none());
    if way == Way::BODY && !seen.interaction.front {
        return (coat, sheen);
    }
    if finishes.has(Finishes::COATED) {
        let weight = number::<R>(finish.coat.x) * covering.finish.coat;
        if R::splat(0.0).lt(weight) {
            let ggx = rough(number::<R>(finish.coat.y) * covering.finish.coat_roughness, R::splat(0.0));
            let normal = coat_normal(launch, context, (seen, surface), covering);
            let (effects, albedos) = (launch.spec.effects, context.albedos);
            coat = Coat::new(effects, albedos, (normal, seen.direction), (weight.flush(FAINT), ggx));
        }
    }
    if finishes.has(Finishes::FIBROUS) {
        let colour =
            launch.banded(V3::splat(numbers(finish.sheen)).times(covering.finish.sheen)).map(|c| c.flush(FAINT));
        sheen = Sheen::new(viewer, colour, number::<R>(finish.sheen.w) * covering.finish.sheen_roughness);
    }
    (coat, sheen)
}

/// The normal of a coat: that of the mesh, or what the coat's own map says.
#[inline(always)]
fn coat_normal<R: Scalar>(
    launch: &LaunchContext<'_>,
    context: &ScatterContext<'_>,
    (seen, surface): (&Seen<R>, &Surface<R>),
    covering: &Covering<R>,
) -> V3<R> {
    let effects = launch.spec.effects;
    let is_mapped = effects.has(Effects::TANGENTS) && effects.has(Effects::TEXTURED);
    let normal = if is_mapped {
        mapped(launch, &context.shading, seen, (surface.even_normal, covering.finish.coat_normal))
    } else {
        surface.even_normal
    };
    if is_mapped || effects.has(Effects::SMOOTH) { bent(&seen.interaction, normal, seen.direction) } else { normal }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chosen(weight: [f64; 3], draw: u32) -> V3<f64> {
        Channels { weight: V3::new(weight[0], weight[1], weight[2]), draw }.chosen().1
    }

    #[test]
    fn channels_that_count_are_chosen_alike_and_weighted_by_their_probability() {
        for weight in [[1.0, 1.0, 1.0], [0.5, 0.0, 2.0], [0.0, 0.0, 3.0], [0.0, 0.1, 0.0], [0.2, 0.3, 0.0]] {
            let mut sum = V3::zero();
            for draw in 0..512 {
                sum = sum + chosen(weight, draw | 0xabcd_e000);
            }
            for (sum, weight) in [sum.x, sum.y, sum.z].into_iter().zip(weight) {
                let want = if weight > 0.0 { 512.0 } else { 0.0 };
                assert!((sum - want).abs() < 1e-9, "{weight}: {sum}");
            }
        }
    }
}
