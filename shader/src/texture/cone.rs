//! The width of a ray: how coarse a texture it sees (Akenine-Moeller and others, Improved Shader and Texture Level of Detail Using
//! Ray Cones, 2021).

use crate::data::{Launch, Primitive};
use crate::real::{FAINT, Real, SMALL, Scalar, V3};
use crate::scene::LaunchContext;

/// How wide a ray is.
#[derive(Clone, Copy)]
pub struct Cone<R: Real> {
    /// In the normalised scene.
    pub width: R,
}

impl<R: Scalar> Cone<R> {
    /// That of a ray that no texture asks for, and of one as it leaves a pinhole.
    #[inline(always)]
    pub fn none() -> Self {
        Cone { width: R::splat(0.0) }
    }

    /// That of the camera's ray where it has gone so far, by what a lens makes of a place that is not in focus: a circle of confusion,
    /// which all samples of a pixel share. At any other vertex none.
    #[inline(always)]
    pub fn confused(launch: &LaunchContext<'_>, distance: R, sample: u32) -> Self {
        if !launch.spec.launch.has(Launch::LENS) || !launch.spec.launch.has(Launch::MIPMAPPED) {
            return Cone::none();
        }
        let over_focus = R::splat(f32::from_bits(launch.frame.camera.across.w));
        let from_focus = (distance * over_focus - R::splat(1.0)).abs().flush(SMALL);
        let width = R::splat(launch.frame.aperture) * from_focus * share_of_pixel(sample);
        Cone { width: width.flush(SMALL) }
    }

    /// Where it has gone so far, wider by its share of a pixel there, or as wide as that where rays are parallel; as it was where no
    /// texture asks for that. The pixel's sample of that number is its ray.
    #[inline(always)]
    pub fn after(self, launch: &LaunchContext<'_>, distance: R, sample: u32) -> Self {
        if !launch.spec.launch.has(Launch::MIPMAPPED) {
            return self;
        }
        let spread = R::splat(launch.frame.spread) * share_of_pixel(sample);
        if launch.frame.camera.is_parallel(launch.spec.launch) {
            return Cone { width: self.width.max(spread) };
        }
        Cone { width: (self.width + spread * distance).flush(SMALL) }
    }

    /// The square of its width on a triangle that it meets along a unit direction, over twice the triangle's area.
    #[inline(always)]
    pub fn footprint(self, primitive: &Primitive, (normal, direction): (V3<R>, V3<R>)) -> R {
        /// A ray that grazes a surface sees no coarser texels than one that meets it at this cosine.
        const GRAZING: f32 = 1.0 / 16.0;
        let [a, b, c] = primitive.vertices();
        let (a, b, c) = (V3::<R>::splat(a), V3::splat(b), V3::splat(c));
        let edge = |to: V3<R>| (to - a).map(|c| c.flush(SMALL));
        let cross = edge(b).cross(edge(c)).map(|c| c.flush(SMALL));
        let area = cross.dot(cross).flush(FAINT).sqrt();
        let cosine = normal.dot(direction).abs().max(R::splat(GRAZING));
        let wide = self.width.over(cosine).flush(SMALL);
        let none = area.eq(R::splat(0.0));
        (wide * wide).flush(FAINT).div(R::select(none, R::splat(1.0), area))
    }
}

/// The share of a pixel's edge that a sample of it sees: the first sees all, and so many samples side by side share it. By the
/// sample's number alone, so that samples added later change none before; and not for ever less, since levels of textures are for
/// texels that lie apart in memory.
#[inline(always)]
fn share_of_pixel<R: Scalar>(sample: u32) -> R {
    const LEAST: f32 = 1.0 / 8.0;
    // Exact in single precision: a pixel has at most 2^24 samples.
    R::splat(sample.wrapping_add(1) as f32).sqrt().reciprocal().max(R::splat(LEAST))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{Frame, Specialisation};
    use glam::Vec3;

    /// On half of a square of some edge.
    fn seen(edge: f32, width: f64, direction: V3<f64>) -> f64 {
        let triangle = Primitive::triangle([Vec3::ZERO, Vec3::X * edge, Vec3::Y * edge], 0, 0, 0);
        Cone { width }.footprint(&triangle, (V3::splat(Vec3::Z), direction))
    }

    #[test]
    fn a_footprint_is_the_rays_width_on_a_triangle() {
        let (down, aslant) = (V3::new(0.0, 0.0, -1.0), V3::new(0.8, 0.0, -0.6));
        assert!((seen(1.0, 0.01, down) - 1e-4).abs() < 1e-9);
        assert!((seen(0.125, 0.01, down) - 64e-4).abs() < 1e-7);
        assert!((seen(1.0, 0.006, aslant) - 1e-4).abs() < 1e-9);
    }

    #[test]
    fn rays_widen_on_their_way() {
        let frame = Frame { spread: 0.125, ..Frame::default() };
        let width = |launch, sample| {
            let spec = Specialisation::default().with_launch(launch);
            Cone::<f64> { width: 1.0 }.after(&LaunchContext::new(&frame, spec, &[], &[]), 2.0, sample).width
        };
        assert_eq!((width(Launch::MIPMAPPED, 0), width(0, 0)), (1.25, 1.0));
        assert_eq!(
            [3, 15, 63, 10_000].map(|sample| width(Launch::MIPMAPPED, sample)),
            [1.125, 1.0625, 1.03125, 1.03125]
        );
    }
}
