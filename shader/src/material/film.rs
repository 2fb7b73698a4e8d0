//! Colours of a thin film (Belcour and Barla, A Practical Extension to Microfacet Theory for the Modeling of Varying Iridescence, 2017),
//! whose faces reflect as Fresnel's equations say of each polarisation.
//!
//! With the amplitudes a and b that its faces reflect and the phase p between them, Airy's sum is
//! `1 - (1 - a^2) (1 - b^2) / (1 + (a b)^2 + 2 a b cos p)`, whose series over the cosines of multiples of p is geometric:
//! `1 - (1 - a^2) (1 - b^2) / (1 - q^2) (1 + 2 sum (-q)^m cos m p)` with q = a b. The eye's mean of each cosine over wavelengths is that
//! of Gaussians over the wave number.

use super::optics::ratio;
use crate::data::Waves;
use crate::light::on_circle;
use crate::real::{FAINT, Real, SMALL, Scalar, V3};

/// Gaussians over the wave number, of Belcour and Barla's fit to the eye's matching functions: the middle of each in turns over a
/// nanometre of path, and how fast it fades with the square of the path, as a power of one half. The red function has two lobes.
const RED: (f32, f32) = (1.6810e-3, 4.3278e9 * FADES);
const PURPLE: (f32, f32) = (2.2399e-3, 4.5282e9 * FADES);
const GREEN: (f32, f32) = (1.7953e-3, 9.3046e9 * FADES);
const BLUE: (f32, f32) = (2.2084e-3, 6.6121e9 * FADES);
/// The share of the red function's greater lobe, which the heights and widths of the fit give.
const GREATER: f32 = 0.846_202;
/// `4e-18 pi^2 / ln 2`.
const FADES: f32 = 5.695_532e-17;

/// From the mean cosine of each matching function, times that of D65, to linear RGB (ITU-R BT.709): rows whose sum is 1, since light
/// of D65 is white.
const RGB: [(f32, f32, f32); 3] =
    [(3.079_954, -1.537_138, -0.542_816), (-0.921_258, 1.876_011, 0.045_247), (0.052_887, -0.204_026, 1.151_139)];

/// A longer path has no colours, in nanometres.
const LONGEST: f32 = 16_384.0;
/// That of a longer path of single wavelengths is not told.
const LONGEST_OF_BANDS: f32 = (1 << 20) as f32;

/// What a film of an index of refraction and a thickness in nanometres reflects under an angle of incidence by its cosine, of white light
/// in linear RGB in [0, 1], or of three wavelengths ([`Waves::SPECTRAL`]) by one over each in nanometres; below it is what reflects
/// `base` of light at normal incidence by itself, likewise.
// A function of its own, since few surfaces have one.
#[inline(never)]
pub fn film<R: Scalar>(light: (Waves, V3<R>), cosine: R, (ior, thickness): (R, R), base: V3<R>) -> V3<R> {
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    let sine = (one - cosine * cosine).max(zero).flush(SMALL);
    let bent = |n: R| {
        let over = n.reciprocal();
        (one - sine * (over * over)).max(zero).sqrt()
    };
    let inside = bent(ior);
    let path = ((ior + ior) * thickness * inside).flush(SMALL);
    let (index, light) = (base.map(index_of), Interference::new(light, path));
    let below = index.map(bent);
    let across = airy(ratio(cosine, ior * inside), below.times(index).map(|c| ratio(ior * inside, c)), &light);
    let along = V3::new(
        ratio(index.x * inside, ior * below.x),
        ratio(index.y * inside, ior * below.y),
        ratio(index.z * inside, ior * below.z),
    );
    let along = airy(ratio(ior * cosine, inside), along, &light);
    ((across + along) * R::splat(0.5)).map(|c| c.max(zero).min(one))
}

/// The index of refraction of what reflects a share of light at normal incidence.
#[inline(always)]
fn index_of<R: Scalar>(reflectance: R) -> R {
    /// That of an index of some 4000.
    const MOST: f32 = 0.999;
    let root = reflectance.max(R::splat(0.0)).min(R::splat(MOST)).flush(SMALL).sqrt();
    (R::splat(1.0) + root).over(R::splat(1.0) - root)
}

/// The eye's means of the cosines of a phase, of twice and of three times that, over wavelengths: the terms of the series that count.
/// The next is less than 1e-2 where q is less than 1/4.
///
/// Of single wavelengths the first term tells all.
struct Interference<R: Real> {
    waves: Waves,
    once: V3<R>,
    twice: V3<R>,
    thrice: V3<R>,
}

impl<R: Scalar> Interference<R> {
    /// Of the difference of two ways of light in nanometres.
    #[inline(always)]
    fn new((waves, per_nanometre): (Waves, V3<R>), path: R) -> Self {
        if waves.has(Waves::SPECTRAL) {
            let path = path.min(R::splat(LONGEST_OF_BANDS));
            let once = per_nanometre.map(|over| cosine_of_turns(path * over));
            return Interference { waves, once, twice: V3::zero(), thrice: V3::zero() };
        }
        let path = path.min(R::splat(LONGEST));
        Interference { waves, once: mean(path), twice: mean(path + path), thrice: mean(path + path + path) }
    }
}

/// The cosine of an angle in turns, at least 0.
#[inline(always)]
fn cosine_of_turns<R: Scalar>(turns: R) -> R {
    let within = (turns - R::splat(turns.floor_index() as f32)) * R::splat((1 << 23) as f32);
    on_circle::<R>((within.floor_index() as u32) << 9).0
}

/// The eye's mean of a cosine, linear RGB: 1 of a path without length.
// A function of its own on the GPU, so that a module holds it once.
#[cfg_attr(target_arch = "spirv", inline(never))]
#[cfg_attr(not(target_arch = "spirv"), inline(always))]
fn mean<R: Scalar>(path: R) -> V3<R> {
    let path = path.min(R::splat(LONGEST)).flush(SMALL);
    let of = |middle: f32, fades: f32| {
        let cosine = cosine_of_turns(path * R::splat(middle));
        cosine * R::splat(0.5).pow((path * path * R::splat(fades)).min(R::splat(127.0)))
    };
    let red = of(RED.0, RED.1) * R::splat(GREATER) + of(PURPLE.0, PURPLE.1) * R::splat(1.0 - GREATER);
    let (green, blue) = (of(GREEN.0, GREEN.1), of(BLUE.0, BLUE.1));
    let row = |(a, b, c): (f32, f32, f32)| (red * R::splat(a) + green * R::splat(b) + blue * R::splat(c)).flush(FAINT);
    V3::new(row(RGB[0]), row(RGB[1]), row(RGB[2]))
}

/// Airy's sum for the amplitudes that both faces reflect: for single wavelengths, or its series.
#[inline(always)]
fn airy<R: Scalar>(upper: R, lower: V3<R>, light: &Interference<R>) -> V3<R> {
    let Interference { waves, once, twice, thrice } = light;
    let (one, upper) = (R::splat(1.0), upper.flush(SMALL));
    let of = |lower: R, (a, b, c): (R, R, R)| {
        let (lower, left) = (lower.flush(SMALL), one - upper * upper);
        let q = (upper * lower).flush(SMALL);
        if waves.has(Waves::SPECTRAL) {
            let all = (one + q * q + (q + q) * a).max(R::splat(SMALL));
            return one - (left * (one - lower * lower)).over(all);
        }
        let passed = (left * (one - lower * lower)).over((one - q * q).max(R::splat(SMALL)));
        let sum = q * (b * q - a - c * (q * q).flush(SMALL));
        one - passed * (one + sum + sum)
    };
    let channel = |a, b, c| (a, b, c);
    V3::new(
        of(lower.x, channel(once.x, twice.x, thrice.x)),
        of(lower.y, channel(once.y, twice.y, thrice.y)),
        of(lower.z, channel(once.z, twice.z, thrice.z)),
    )
}
