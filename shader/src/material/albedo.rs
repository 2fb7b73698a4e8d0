//! How much of the light that comes from a direction facets send back, once: tables over the facets' roughness and the cosine.
//!
//! The facets' own integrals (`shader/tests/lobes/tables.rs` makes the tables and compares them), in words of two fractions of 2^16.
//! Between entries they are linear, and a mean is that of what lies between entries. Interpolated, reflecting facets are within
//! 2e-3 of their integral, glass and brushed metal within 1e-2.

use super::Ggx;
use crate::buffer::read;
use crate::data::Effects;
use crate::real::{Real, SMALL, Scalar, V3};

/// The tables, made by the build's tests.
#[cfg(not(target_arch = "spirv"))]
pub const ALBEDOS: &[u8] = include_bytes!("albedo.bin");

/// The tables' words.
#[derive(Clone, Copy)]
pub struct Albedos<'a>(pub &'a [u32]);

/// Entries over the root of the roughness of equally rough facets, and over the cosine.
pub const EVEN: [u32; 2] = [64, 128];
/// Over the index, the root of the roughness and the cosine, of glass seen from outside, then from inside.
pub const GLASS: [u32; 3] = [12, 12, 24];
/// Over the root of the greater roughness, the root of the lesser over the greater, the cosine of the azimuth from the rougher axis,
/// and the cosine.
pub const BRUSHED: [u32; 4] = [12, 6, 8, 20];
/// Where each table starts, and where the last ends.
pub const STARTS: [u32; 8] = {
    let lengths = [
        EVEN[0] * EVEN[1],
        EVEN[0],
        2 * GLASS[0] * GLASS[1] * GLASS[2],
        2 * GLASS[0] * GLASS[1],
        GLASS[0],
        BRUSHED[0] * BRUSHED[1] * BRUSHED[2] * BRUSHED[3],
        BRUSHED[0] * BRUSHED[1],
    ];
    let mut starts = [0; 8];
    let mut i = 0;
    while i < 7 {
        starts[i + 1] = starts[i] + lengths[i];
        i += 1;
    }
    starts
};
/// The greatest (n - 1) / (n + 1) of an index of refraction n that glass is tabulated for: n is 3. Beyond, it is taken for that.
pub const MOST_BEND: f32 = 0.5;

/// A cell of a table's axis, and the place in it.
#[derive(Clone, Copy)]
struct Axis<R: Real> {
    first: u32,
    place: R,
}

impl<R: Scalar> Axis<R> {
    /// At a coordinate in [0, 1] over so many entries.
    // A clamp holds a panic, which a kernel can't have.
    #[allow(clippy::manual_clamp)]
    #[inline(always)]
    fn new(at: R, entries: u32) -> Self {
        let scaled = at * R::splat((entries - 1) as f32);
        let first = scaled.floor_index().max(0).min(entries as i32 - 2);
        Axis { first: first as u32, place: (scaled - R::splat(first as f32)).max(R::splat(0.0)).min(R::splat(1.0)) }
    }

    /// A pair of numbers between those of two entries.
    #[inline(always)]
    fn between(self, of: impl Fn(u32) -> (R, R)) -> (R, R) {
        let (a, b) = (of(self.first), of(self.first + 1));
        let place = self.place.flush(SMALL);
        (a.0 + (b.0 - a.0) * place, a.1 + (b.1 - a.1) * place)
    }
}

/// The coordinate of a cosine, which has as many entries where facets as rough begin to shadow each other as elsewhere.
#[inline(always)]
pub fn cosine_coordinate<R: Scalar>(cosine: R, roughness: R) -> R {
    let (one, cosine) = (R::splat(1.0), cosine.max(R::splat(SMALL)).min(R::splat(1.0)));
    let near = cosine * (one + roughness).over(cosine + roughness);
    cosine.sqrt() * R::splat(0.6) + near * R::splat(0.4)
}

impl Albedos<'_> {
    #[inline(always)]
    fn entry<R: Scalar>(self, index: u32) -> (R, R) {
        const STEP: f32 = 1.0 / 65_536.0;
        let word = read(self.0, index);
        let of = |half: u32| R::splat(half as f32) * R::splat(STEP);
        (of(word & 0xffff), of(word >> 16))
    }
}

/// Facets whose albedos are looked up: their place in the tables.
// No tables in here: a structure with a pointer must not be chosen between two ways through a kernel.
#[derive(Clone, Copy)]
pub struct FacetAlbedo<R: Real> {
    is_brushed: bool,
    /// Roughness that a cosine is compared with.
    rough: R,
    even: Axis<R>,
    brushed: (Axis<R>, Axis<R>),
    /// Is the first axis the rougher one?
    along_first: bool,
}

impl<R: Scalar> FacetAlbedo<R> {
    /// Of facets that are not smooth.
    #[inline(always)]
    pub fn new(effects: Effects, ggx: Ggx<R>) -> Self {
        let is_brushed = effects.has(Effects::ANISOTROPIC) && !ggx.x.eq(ggx.y);
        let (rough, fine) = (ggx.x.max(ggx.y), ggx.x.min(ggx.y));
        let root = rough.sqrt();
        let even = Axis::new(root, EVEN[0]);
        let brushed = if effects.has(Effects::ANISOTROPIC) {
            (Axis::new(root, BRUSHED[0]), Axis::new(fine.over(rough).sqrt(), BRUSHED[1]))
        } else {
            (even, even)
        };
        FacetAlbedo { is_brushed, rough, even, brushed, along_first: ggx.y.le(ggx.x) }
    }

    /// Of a unit direction on the facets' side: what they reflect that reflect all light at normal incidence and none at grazing
    /// angles by Schlick's approximation, and what those reflect that do the contrary; the sum is that of mirrors.
    #[inline(always)]
    pub fn reflected(&self, albedos: Albedos<'_>, w: V3<R>) -> (R, R) {
        let coordinate = cosine_coordinate(w.z, self.rough);
        if self.is_brushed {
            return self.of_brushed(albedos, w, coordinate);
        }
        let cosine = Axis::new(coordinate, EVEN[1]);
        self.even.between(|row| cosine.between(|i| albedos.entry(STARTS[0] + row * EVEN[1] + i)))
    }

    #[inline(always)]
    fn of_brushed(&self, albedos: Albedos<'_>, w: V3<R>, coordinate: R) -> (R, R) {
        let along = if self.along_first { w.x } else { w.y };
        let square = (w.x * w.x + w.y * w.y).flush(SMALL);
        let none = square.eq(R::splat(0.0));
        let length = R::select(none, R::splat(1.0), square).sqrt();
        let azimuth = Axis::new(along.abs().over(length), BRUSHED[2]);
        let cosine = Axis::new(coordinate, BRUSHED[3]);
        let (rough, ratio) = self.brushed;
        rough.between(|i| {
            ratio.between(|j| {
                azimuth.between(|k| {
                    let row = (i * BRUSHED[1] + j) * BRUSHED[2] + k;
                    cosine.between(|l| albedos.entry(STARTS[5] + row * BRUSHED[3] + l))
                })
            })
        })
    }

    /// The mean of [`reflected`](Self::reflected) over all directions by their cosine.
    #[inline(always)]
    pub fn mean(&self, albedos: Albedos<'_>) -> (R, R) {
        if self.is_brushed {
            let (rough, ratio) = self.brushed;
            return rough.between(|i| ratio.between(|j| albedos.entry(STARTS[6] + i * BRUSHED[1] + j)));
        }
        self.even.between(|row| albedos.entry(STARTS[1] + row))
    }

    /// The same of glass, whose facets refract too.
    #[inline(always)]
    pub fn glass(&self, eta: R) -> GlassAlbedo<R> {
        const OVER: f32 = 1.0 / MOST_BEND;
        let one = R::splat(1.0);
        let bend = (one - eta).abs().over(one + eta) * R::splat(OVER);
        GlassAlbedo {
            own: self.rough,
            bend: Axis::new(bend, GLASS[0]),
            rough: Axis::new(self.rough.sqrt(), GLASS[1]),
            is_inside: one.lt(eta),
        }
    }
}

/// The place of rough glass in the tables.
#[derive(Clone, Copy)]
pub struct GlassAlbedo<R: Real> {
    /// Roughness that a cosine is compared with.
    own: R,
    bend: Axis<R>,
    rough: Axis<R>,
    is_inside: bool,
}

impl<R: Scalar> GlassAlbedo<R> {
    /// What is reflected of light from the cosine of a direction, and what passes; seen from the near side or the far one.
    #[inline(always)]
    pub fn shares(&self, albedos: Albedos<'_>, cosine: R, is_far: bool) -> (R, R) {
        let axis = Axis::new(cosine_coordinate(cosine, self.own), GLASS[2]);
        let side = if self.is_inside != is_far { GLASS[0] } else { 0 };
        self.bend.between(|i| {
            self.rough.between(|j| {
                let row = (side + i) * GLASS[1] + j;
                axis.between(|k| albedos.entry(STARTS[2] + row * GLASS[2] + k))
            })
        })
    }

    /// The mean over all directions.
    #[inline(always)]
    pub fn mean(&self, albedos: Albedos<'_>, is_far: bool) -> (R, R) {
        let side = if self.is_inside != is_far { GLASS[0] } else { 0 };
        let entry = |i, j| albedos.entry(STARTS[3] + (side + i) * GLASS[1] + j);
        self.bend.between(|i| self.rough.between(|j| entry(i, j)))
    }

    /// The mean share of light that a smooth interface lets pass from outside.
    #[inline(always)]
    pub fn passed(&self, albedos: Albedos<'_>) -> R {
        self.bend.between(|i| albedos.entry(STARTS[4] + i)).0
    }
}
