//! The width of a ray: how coarse a texture it sees (Akenine-Moeller and others, Improved Shader and Texture Level of Detail Using
//! Ray Cones, 2021).

use super::{Place, Textures};
use crate::buffer::read;
use crate::data::{Launch, Primitive, TexCoords};
use crate::real::{FAINT, Real, SMALL, Scalar, V3};

/// How wide a ray is where it starts, and how much wider it becomes on a unit of its way.
#[derive(Clone, Copy)]
pub struct Cone<R: Real> {
    /// In the normalised scene.
    pub width: R,
    /// An angle in radians, if it is small.
    pub spread: R,
}

impl<R: Scalar> Cone<R> {
    /// Where it has gone so far; as it was where no texture asks for that.
    #[inline(always)]
    pub fn after(self, launch: Launch, distance: R) -> Self {
        if !launch.has(Launch::MIPMAPPED) {
            return self;
        }
        Cone { width: (self.width + self.spread * distance).flush(SMALL), spread: self.spread }
    }

    /// Where it is scattered, with a density over solid angle, 0 by a mirror or a lens: it becomes as wide as half the cone in
    /// which directions are as likely.
    #[inline(always)]
    pub fn scattered(self, density: R) -> Self {
        let (zero, one, half) = (R::splat(0.0), R::splat(1.0), R::splat(0.5));
        let is_rough = zero.lt(density);
        let density = R::select(is_rough, density, one).max(one);
        let wide = R::select(is_rough, one.div(density).sqrt() * half, zero);
        Cone { width: self.width, spread: self.spread.max(wide) }
    }

    /// The square of its width on a triangle that it meets along a unit direction, in units of the triangle's first texture
    /// coordinates. A texture's transform is taken to keep areas.
    #[inline(always)]
    pub fn footprint(
        self,
        textures: &Textures<'_>,
        place: &Place<R>,
        primitive: &Primitive,
        (normal, direction): (V3<R>, V3<R>),
    ) -> R {
        /// A ray that grazes a surface sees no coarser texels than one that meets it at this cosine.
        const GRAZING: f32 = 1.0 / 16.0;
        let [a, b, c] = primitive.vertices();
        let (a, b, c) = (V3::<R>::splat(a), V3::splat(b), V3::splat(c));
        let edge = |to: V3<R>| (to - a).map(|c| c.flush(SMALL));
        let cross = edge(b).cross(edge(c)).map(|c| c.flush(SMALL));
        let area = cross.dot(cross).flush(FAINT).sqrt();
        let TexCoords { ab, c } = read(textures.coordinates, place.index);
        let number = |bits: u32| R::splat(f32::from_bits(bits));
        let (u, v) = (number(ab.x), number(ab.y));
        let (x, y) = ((number(ab.z) - u, number(ab.w) - v), (number(c.x) - u, number(c.y) - v));
        let covered = (x.0 * y.1 - x.1 * y.0).abs().flush(SMALL);
        let cosine = normal.dot(direction).abs().max(R::splat(GRAZING));
        let wide = self.width.div(cosine).flush(SMALL);
        let none = area.eq(R::splat(0.0));
        (wide * wide * covered).flush(FAINT).div(R::select(none, R::splat(1.0), area))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{UVec4, Vec3};

    /// A unit square's half, covered by a texture of so many repetitions.
    fn seen(repeats: f32, width: f64, direction: V3<f64>) -> f64 {
        let bits = |x: f32| (x * repeats).to_bits();
        let coordinates = TexCoords {
            ab: UVec4::new(bits(0.0), bits(0.0), bits(1.0), bits(0.0)),
            c: UVec4::new(bits(0.0), bits(1.0), 0, 0),
        };
        let textures = Textures { textures: &[], texels: &[], coordinates: &[coordinates], colours: &[] };
        let place = Place { index: 0, weights: (0.25, 0.25), count: 1 };
        let triangle = Primitive::triangle([Vec3::ZERO, Vec3::X, Vec3::Y], 0, 0, 0);
        let normal = V3::splat(Vec3::Z);
        Cone { width, spread: 0.0 }.footprint(&textures, &place, &triangle, (normal, direction))
    }

    #[test]
    fn a_footprint_is_the_rays_width_in_texture_coordinates() {
        let (down, aslant) = (V3::new(0.0, 0.0, -1.0), V3::new(0.8, 0.0, -0.6));
        assert!((seen(1.0, 0.01, down) - 1e-4).abs() < 1e-9);
        assert!((seen(8.0, 0.01, down) - 64e-4).abs() < 1e-7);
        assert!((seen(1.0, 0.006, aslant) - 1e-4).abs() < 1e-9);
    }

    #[test]
    fn rays_widen_on_their_way_and_where_they_are_scattered() {
        let cone = Cone { width: 0.0, spread: 0.001f64 }.after(Launch(Launch::MIPMAPPED), 2.0);
        assert!((cone.width - 0.002).abs() < 1e-12);
        assert_eq!(cone.scattered(0.0).spread, 0.001, "a mirror keeps it");
        assert_eq!(cone.scattered(100.0).spread, 0.05);
        assert_eq!(cone.scattered(0.3).spread, 0.5, "at most by as much");
    }
}
