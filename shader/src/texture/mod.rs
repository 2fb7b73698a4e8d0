//! Textures on surfaces, by arithmetic of our own on one buffer of texels: no device filters them by itself, so that pictures have
//! the same bits on all.

mod cone;
mod covering;
mod filter;
mod finish;

pub use cone::Cone;
pub use covering::Covering;
pub(crate) use filter::beyond;
pub use filter::{Texel, opacity, sample};
pub use finish::FinishCovering;

use crate::buffer::read;
use crate::data::{Colours, Effects, Launch, TexCoords, TextureMap};
use crate::real::{SMALL, Scalar, V3};
use glam::UVec4;

/// What textures are made of.
#[derive(Clone, Copy, Default)]
pub struct Textures<'a> {
    /// Every texture that some material takes.
    pub textures: &'a [TextureMap],
    /// The table of sRGB, and the texels of all.
    pub texels: &'a [u32],
    /// In leaf order; the second set, where there is one, behind the first.
    pub coordinates: &'a [TexCoords],
    /// Vertex colours in leaf order ([`Effects::COLOURED`]).
    pub colours: &'a [Colours],
}

impl Textures<'_> {
    /// The value of a map at a place: an index into all, plus one. `footprint` is that of [`Cone::footprint`].
    #[inline(always)]
    pub fn at<R: Scalar>(&self, launch: Launch, map: u32, place: &Place<R>, footprint: R) -> (TextureMap, Texel<R>) {
        let map = read(self.textures, map - 1);
        let corners = place.corners(self, &map);
        let covered = if launch.has(Launch::MIPMAPPED) { covered(&corners, &map) } else { R::splat(0.0) };
        (map, sample(launch, self, &map, place.coordinates(&corners, &map), footprint * covered))
    }
}

/// A place on a triangle.
#[derive(Clone, Copy)]
pub struct Place<R> {
    /// Its index in leaf order.
    pub index: u32,
    /// The weights of its second and third vertex.
    pub weights: (R, R),
    /// Primitives in leaf order, by which a second set of coordinates is found.
    pub count: u32,
}

impl<R: Scalar> Place<R> {
    /// A value at the place, of its values at the vertices.
    #[inline(always)]
    fn weighted(&self, a: R, b: R, c: R) -> R {
        let (u, v) = self.weights;
        a * (R::splat(1.0) - u - v) + b * u + c * v
    }

    /// The texture coordinates of the set that a map takes, of the triangle's vertices.
    #[inline(always)]
    pub fn corners(&self, textures: &Textures<'_>, map: &TextureMap) -> TexCoords {
        let set = if map.place.w & TextureMap::SECOND_SET != 0 { self.count } else { 0 };
        read(textures.coordinates, set + self.index)
    }

    /// The texture coordinates of a map there.
    #[inline(always)]
    pub fn coordinates(&self, &TexCoords { ab, c }: &TexCoords, map: &TextureMap) -> (R, R) {
        let number = |bits: u32| R::splat(f32::from_bits(bits));
        let u = self.weighted(number(ab.x), number(ab.z), number(c.x));
        let v = self.weighted(number(ab.y), number(ab.w), number(c.y));
        let of = |row: UVec4| number(row.x) * u + number(row.y) * v + number(row.z);
        (of(map.u), of(map.v))
    }

    /// The vertices' opacity there.
    #[inline(always)]
    pub fn opacity(&self, effects: Effects, textures: &Textures<'_>) -> R {
        if !effects.has(Effects::COLOURED) {
            return R::splat(1.0);
        }
        let Colours { a, b, c } = read(textures.colours, self.index);
        let number = |bits: u32| R::splat(f32::from_bits(bits));
        self.weighted(number(a.w), number(b.w), number(c.w))
    }

    /// The vertices' colour there.
    #[inline(always)]
    pub fn colour(&self, effects: Effects, textures: &Textures<'_>) -> V3<R> {
        if !effects.has(Effects::COLOURED) {
            let one = R::splat(1.0);
            return V3::new(one, one, one);
        }
        let Colours { a, b, c } = read(textures.colours, self.index);
        let number = |bits: u32| R::splat(f32::from_bits(bits));
        let channel = |a, b, c| self.weighted(number(a), number(b), number(c));
        V3::new(channel(a.x, b.x, c.x), channel(a.y, b.y, c.y), channel(a.z, b.z, c.z))
    }
}

/// What a triangle covers of a map, as it lies there: twice the area, in units of the whole texture.
#[inline(always)]
fn covered<R: Scalar>(&TexCoords { ab, c }: &TexCoords, map: &TextureMap) -> R {
    let number = |bits: u32| R::splat(f32::from_bits(bits));
    let cross = |(a, b): (R, R), (c, d): (R, R)| (a * d - b * c).abs().flush(SMALL);
    let row = |of: UVec4| (number(of.x), number(of.y));
    let (u, v) = (number(ab.x), number(ab.y));
    let edges = cross((number(ab.z) - u, number(ab.w) - v), (number(c.x) - u, number(c.y) - v));
    (edges * cross(row(map.u), row(map.v))).flush(SMALL)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bytemuck::Zeroable;

    #[test]
    fn a_triangle_covers_what_its_coordinates_and_the_map_say() {
        let bits = |x: f32| x.to_bits();
        let corners = TexCoords { ab: UVec4::new(0, 0, bits(2.0), 0), c: UVec4::new(bits(7.0), bits(0.5), 0, 0) };
        let map = |scale: f32, turned: f32| TextureMap {
            u: UVec4::new(bits(scale * turned), bits(scale), 0, 1),
            v: UVec4::new(bits(-scale), bits(scale * turned), bits(9.0), 0),
            ..Zeroable::zeroed()
        };
        assert_eq!(covered::<f64>(&corners, &map(1.0, 0.0)), 1.0);
        assert_eq!(covered::<f64>(&corners, &map(0.25, 0.0)), 0.0625);
        assert_eq!(covered::<f64>(&corners, &map(8.0, 0.0)), 64.0);
        assert_eq!(covered::<f64>(&corners, &map(1.0, 1.0)), 2.0);
    }
}
