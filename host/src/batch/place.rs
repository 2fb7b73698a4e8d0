//! From rays in the scene's units to those that kernels take.

use std::ops::Range;

use eyerays_kernels_cpu::Isa;
use eyerays_shader::data::pack;
use eyerays_shader::real::{SimdIsa, TINY, Task};
use glam::{DVec3, UVec4, Vec3};

use super::{Measure, Ray};
use crate::device_scene::{Normalisation, flushed_number};
use crate::stream::StreamRay;

/// Rays that are placed together: their columns are in a core's nearest cache.
pub const BLOCK: usize = 64;

/// Rays of a block in columns, so that a core places several with each instruction.
pub struct RayBlock {
    /// See [`Ray::origin`], an axis a column.
    pub origins: [[f64; BLOCK]; 3],
    /// See [`Ray::direction`].
    pub directions: [[f64; BLOCK]; 3],
    /// See [`Ray::tmax`].
    pub tmax: [f64; BLOCK],
}

/// Rays by their numbers.
pub trait Rays: Sync {
    /// One of them.
    fn ray(&self, number: usize) -> Ray;

    /// Makes at most [`BLOCK`] neighbours, the first in the first row. What does that better than one by one should be `inline(always)`, to be
    /// compiled for what each processor has.
    #[inline(always)]
    fn fill(&self, range: Range<usize>, block: &mut RayBlock) {
        range.enumerate().for_each(|(row, number)| block.set(row, &self.ray(number)));
    }
}

impl<F: Fn(usize) -> Ray + Sync> Rays for F {
    #[inline(always)]
    fn ray(&self, number: usize) -> Ray {
        self(number)
    }
}

impl Default for RayBlock {
    fn default() -> Self {
        RayBlock { origins: [[0.0; BLOCK]; 3], directions: [[0.0; BLOCK]; 3], tmax: [0.0; BLOCK] }
    }
}

impl RayBlock {
    /// Makes the ray of a row.
    #[inline(always)]
    pub fn set(&mut self, row: usize, ray: &Ray) {
        for axis in 0..3 {
            self.origins[axis][row] = ray.origin[axis];
            self.directions[axis][row] = ray.direction[axis];
        }
        self.tmax[row] = ray.tmax;
    }

    /// The ray of a row.
    #[inline(always)]
    pub fn ray(&self, row: usize) -> Ray {
        let vector = |columns: &[[f64; BLOCK]; 3]| DVec3::new(columns[0][row], columns[1][row], columns[2][row]);
        Ray { origin: vector(&self.origins), direction: vector(&self.directions), tmax: self.tmax[row] }
    }
}

/// Room for rays as kernels read them, and for how distances along them are to be taken; all of one length.
pub(crate) struct Placed<'a> {
    pub firsts: &'a mut [UVec4],
    pub seconds: &'a mut [UVec4],
    pub measures: &'a mut [Measure],
}

/// Places as many of the rays as there is room for, and such that meet nothing in what is left.
pub(crate) fn place(normalisation: &Normalisation, rays: &impl Rays, range: Range<usize>, to: Placed<'_>) {
    place_by(Isa::best(), normalisation, rays, range, to);
}

fn place_by(isa: Isa, normalisation: &Normalisation, rays: &impl Rays, range: Range<usize>, to: Placed<'_>) {
    isa.run(Placing { normalisation, rays, range, to });
}

struct Placing<'a, R> {
    normalisation: &'a Normalisation,
    rays: &'a R,
    range: Range<usize>,
    to: Placed<'a>,
}

impl<R: Rays> Task<f32> for Placing<'_, R> {
    #[inline(always)]
    fn run<V: SimdIsa<f32>>(self) {
        let Placing { normalisation, rays, range, to } = self;
        let (mut block, mut columns) = (RayBlock::default(), Columns::NOTHING);
        let pieces = to.firsts.chunks_mut(BLOCK).zip(to.seconds.chunks_mut(BLOCK));
        for (number, ((firsts, seconds), measures)) in pieces.zip(to.measures.chunks_mut(BLOCK)).enumerate() {
            let start = range.end.min(range.start + BLOCK * number);
            let made = range.end.min(start + firsts.len()) - start;
            rays.fill(start..start + made, &mut block);
            columns.place(normalisation, &block);
            let rows = firsts.iter_mut().zip(seconds).zip(measures).enumerate();
            rows.for_each(|(row, ((first, second), measure))| {
                let (ray, own) = if row < made { columns.row(row) } else { (StreamRay::AWAY, Measure::default()) };
                *first = pack(ray.origin, ray.source_primitive);
                *second = pack(ray.direction, ray.limit.to_bits());
                *measure = own;
            });
        }
    }
}

/// What a block's rays have become.
struct Columns {
    origins: [[f32; BLOCK]; 3],
    directions: [[f32; BLOCK]; 3],
    limits: [f32; BLOCK],
    moved: [f64; BLOCK],
    units: [f64; BLOCK],
}

impl Columns {
    const NOTHING: Columns = Columns {
        origins: [[0.0; BLOCK]; 3],
        directions: [[0.0; BLOCK]; 3],
        limits: [0.0; BLOCK],
        moved: [0.0; BLOCK],
        units: [0.0; BLOCK],
    };

    #[inline(always)]
    fn place(&mut self, normalisation: &Normalisation, block: &RayBlock) {
        for row in 0..BLOCK {
            let (ray, measure) = placed(normalisation, &block.ray(row));
            for axis in 0..3 {
                self.origins[axis][row] = ray.origin[axis];
                self.directions[axis][row] = ray.direction[axis];
            }
            self.limits[row] = ray.limit;
            (self.moved[row], self.units[row]) = (measure.moved, measure.unit);
        }
    }

    #[inline(always)]
    fn row(&self, row: usize) -> (StreamRay, Measure) {
        let vector = |columns: &[[f32; BLOCK]; 3]| Vec3::new(columns[0][row], columns[1][row], columns[2][row]);
        let (origin, direction) = (vector(&self.origins), vector(&self.directions));
        let ray = StreamRay { origin, direction, limit: self.limits[row], source_primitive: StreamRay::NOWHERE };
        (ray, Measure { moved: self.moved[row], unit: self.units[row] })
    }
}

/// A ray in the normalised scene: one from outside starts where it comes to the scene's cube, before anything is rounded. Its direction is
/// multiplied by a power of two, which rounds nothing, so that its greatest component is at least 1 and below 2. Without a branch, so that
/// it is compiled for several rays at once.
#[inline(always)]
fn placed(normalisation: &Normalisation, ray: &Ray) -> (StreamRay, Measure) {
    let (direction, (binade, over)) = grown(ray.direction);
    let (scale, origin) = (normalisation.scale, normalisation.exactly(ray.origin));
    // The length in the scene's units first, which is the one that may be a number where others are not.
    let limit = ray.tmax * binade * scale;
    let (comes, enters) = entry(origin, direction);
    let comes = comes & (limit >= enters);
    let origin = origin + direction * enters;
    // What is at the end counts; and no limit is so small that a device takes it for zero.
    let limit = after((limit - enters).min(f64::from(f32::MAX)) as f32).clamp(TINY, f32::MAX);
    // What is too far for a number of double precision is at the farthest there is.
    let unit = (over / scale).min(f64::MAX);
    let away = StreamRay::AWAY;
    let either = |there: f64, away: f32| if comes { there as f32 } else { away };
    let origin = Vec3::new(
        flushed_number(either(origin.x, away.origin.x)),
        flushed_number(either(origin.y, away.origin.y)),
        flushed_number(either(origin.z, away.origin.z)),
    );
    let direction = Vec3::new(
        either(direction.x, away.direction.x),
        either(direction.y, away.direction.y),
        either(direction.z, away.direction.z),
    );
    let limit = if comes { limit } else { away.limit };
    let measure = Measure { moved: if comes { enters * unit } else { 0.0 }, unit: if comes { unit } else { 0.0 } };
    (StreamRay { origin, direction, limit, ..away }, measure)
}

/// The number after one that is not negative.
#[inline(always)]
fn after(x: f32) -> f32 {
    f32::from_bits(x.to_bits().wrapping_add(1))
}

/// A direction over a power of two, that, and one over it. What is no direction stays none.
#[inline(always)]
fn grown(direction: DVec3) -> (DVec3, (f64, f64)) {
    let size = direction.x.abs().max(direction.y.abs()).max(direction.z.abs());
    // The bits of its exponent: none below the least normal number, whose inverse is no infinity.
    let binade = f64::from_bits(size.to_bits() & f64::INFINITY.to_bits()).max(f64::MIN_POSITIVE);
    let over = 1.0 / binade;
    (direction * over, (binade, over))
}

/// Whether a ray comes to the cube around a normalised scene, and how far it is from there, zero in it. What is of no place or goes nowhere
/// never does.
#[inline(always)]
fn entry(origin: DVec3, direction: DVec3) -> (bool, f64) {
    /// A little more than the scene's, so that nothing on its faces is passed.
    const HALF: f64 = 1.0 + 1.0 / 64.0;
    let slab = |origin: f64, direction: f64| {
        // What goes along a pair of faces is between them all its way, or never; and no zero times infinity.
        let over = 1.0 / if direction == 0.0 { f64::MIN_POSITIVE } else { direction };
        let (one, other) = ((-HALF - origin) * over, (HALF - origin) * over);
        (one.min(other), one.max(other), origin.abs() <= HALF)
    };
    let (x, y, z) = (slab(origin.x, direction.x), slab(origin.y, direction.y), slab(origin.z, direction.z));
    let (enters, leaves) = (x.0.max(y.0).max(z.0).max(0.0), x.1.min(y.1).min(z.1));
    let is_inside = x.2 & y.2 & z.2;
    let is_finite = |x: f64| x.abs() < f64::INFINITY;
    let is_ray = is_finite(origin.x)
        & is_finite(origin.y)
        & is_finite(origin.z)
        & is_finite(direction.x)
        & is_finite(direction.y)
        & is_finite(direction.z)
        & ((direction.x != 0.0) | (direction.y != 0.0) | (direction.z != 0.0));
    (is_ray & (is_inside | (leaves >= enters)), if is_inside { 0.0 } else { enters })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Numbers of all kinds, many of which are no coordinates.
    fn number() -> impl Strategy<Value = f64> {
        prop_oneof![4 => -3f64..3.0, 1 => prop::num::f64::ANY, 1 => Just(0.0), 1 => Just(f64::INFINITY)]
    }

    fn ray() -> impl Strategy<Value = Ray> {
        let vector = || prop::array::uniform3(number()).prop_map(DVec3::from);
        let tmax = prop_oneof![Just(Ray::ENDLESS), number()];
        (vector(), vector(), tmax).prop_map(|(origin, direction, tmax)| Ray { origin, direction, tmax })
    }

    /// The bits of what a ray becomes, which no two NaN have to share: none is left.
    fn bits(first: UVec4, second: UVec4, Measure { moved, unit }: Measure) -> ([u32; 8], [u64; 2]) {
        assert!(!moved.is_nan() && !unit.is_nan());
        let [a, b, c, d] = first.to_array();
        let [e, f, g, h] = second.to_array();
        ([a, b, c, d, e, f, g, h], [moved.to_bits(), unit.to_bits()])
    }

    proptest! {
        /// In whole blocks and in parts of them; what is left of the room has rays that meet nothing.
        #[test]
        fn all_instructions_place_rays_as_one_by_one(rays in prop::collection::vec(ray(), 1..3 * BLOCK), room in 1..4 * BLOCK) {
            let normalisation = Normalisation { origin: Vec3::new(0.5, 0.0, -1.0), scale: 0.25 };
            for isa in Isa::here() {
                let (mut firsts, mut seconds) = (vec![UVec4::ZERO; room], vec![UVec4::ZERO; room]);
                let mut measures = vec![Measure::default(); room];
                let to = Placed { firsts: &mut firsts, seconds: &mut seconds, measures: &mut measures };
                place_by(isa, &normalisation, &|i: usize| rays[i - 5], 5..rays.len() + 5, to);
                for i in 0..room {
                    let away = || (StreamRay::AWAY, Measure::default());
                    let (ray, measure) = rays.get(i).map_or_else(away, |ray| placed(&normalisation, ray));
                    let expected = (pack(ray.origin, ray.source_primitive), pack(ray.direction, ray.limit.to_bits()));
                    let is_same = bits(firsts[i], seconds[i], measures[i]) == bits(expected.0, expected.1, measure);
                    prop_assert!(is_same, "{isa:?}: {:?}", rays.get(i));
                }
            }
        }

        /// Directions of all sizes that there are, but those below the least normal number.
        #[test]
        fn a_direction_grows_by_a_power_of_two(mantissa in prop::array::uniform3(-1f64..1.0), exponent in -1015i32..1023) {
            let direction = DVec3::from(mantissa) * 2f64.powi(exponent);
            prop_assume!(direction.abs().max_element() >= f64::MIN_POSITIVE);
            let (up, (binade, over)) = grown(direction);
            prop_assert!((1.0..2.0).contains(&up.abs().max_element()), "{direction}: {up}");
            prop_assert_eq!(up * binade, direction);
            prop_assert_eq!(over * binade, 1.0);
        }

        /// As far as the nearest and the farthest of three slabs, by definition.
        #[test]
        fn a_ray_enters_the_cube_where_it_comes_to_it(
            origin in prop::array::uniform3(-3f64..3.0), direction in prop::array::uniform3(-1f64..1.0),
        ) {
            let (origin, direction) = (DVec3::from(origin), DVec3::from(direction));
            let inside = |t: f64| (origin + direction * t).abs().max_element() <= 1.0 + 1.0 / 64.0 + 1e-9;
            match entry(origin, direction) {
                (true, enters) => {
                    prop_assert!(inside(enters));
                    prop_assert!(enters == 0.0 || !inside(enters - 1e-6));
                }
                (false, _) => prop_assert!((0..2000).all(|i| !inside(f64::from(i) * 5e-3 / direction.length() - 1e-12))),
            }
        }
    }
}
