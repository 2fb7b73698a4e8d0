//! Shading normals by which facets mirror the viewer's ray out of the surface, not into it.

use crate::geometry::SurfaceInteraction;
use crate::real::{SMALL, Scalar, V3};

/// The least cosine, to the surface itself, of the ray that a shading normal mirrors.
const LEAST: f32 = 1.0 / 128.0;

/// A unit shading normal, bent towards the surface's own until the viewer's ray along the unit `direction`, mirrored by it, leaves
/// the surface. (Cycles does the same; Schuessler and others, Microfacet-Based Normal Mapping for Robust Monte Carlo Path Tracing,
/// 2017, tell what a mirror loses else.)
#[inline(always)]
pub fn bent<R: Scalar>(interaction: &SurfaceInteraction<R>, normal: V3<R>, direction: V3<R>) -> V3<R> {
    let (zero, one, own) = (R::splat(0.0), R::splat(1.0), interaction.normal);
    let viewer = -direction;
    let height = viewer.dot(own).max(zero);
    let least = (height * R::splat(0.875)).min(R::splat(LEAST));
    let cosine = normal.dot(viewer);
    let mirrored = (cosine + cosine) * normal.dot(own) - height;
    if least.le(mirrored) {
        return normal;
    }
    // In the plane of both normals the bent one is (x, z), by the axis across the surface's own and that.
    let (across, size) = (normal - own * normal.dot(own)).map(|c| c.flush(SMALL)).direction_and_length();
    let x = viewer.dot(across).flush(SMALL);
    let square = (x * x + height * height).flush(SMALL);
    if size.eq(zero) || square.eq(zero) {
        return own;
    }
    // Of a + b + c = 0 for z squared: its mirrored ray has the least height.
    let b = square + height * least;
    let c = (least + height) * (least + height) * R::splat(0.25);
    let root = (b * b - square * c * R::splat(4.0)).max(zero).sqrt();
    let sum = R::select(x.lt(zero), b + root, b - root);
    let z = (sum * R::splat(0.5)).over(square).max(zero).min(one);
    let (x, z) = ((one - z).sqrt(), z.sqrt());
    (across * x.flush(SMALL) + own * z.flush(SMALL)).map(|c| c.flush(SMALL)).renormalised()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::reflect;
    use glam::Vec3;
    use proptest::prelude::*;

    fn plane() -> SurfaceInteraction<f64> {
        SurfaceInteraction {
            position: V3::zero(),
            error_offset: 0.0,
            normal: V3::splat(Vec3::Z),
            front: true,
            coordinates: (0.0, 0.0),
            number: 0,
            is_curved: false,
            radius: 0.0,
            is_lifted: false,
            lift: 0.0,
        }
    }

    fn unit(polar: f64, azimuth: f64) -> V3<f64> {
        V3::new(polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos())
    }

    proptest! {
        #![proptest_config(ProptestConfig {
            cases: 20_000,
            max_global_rejects: 20_000,
            failure_persistence: None,
            ..Default::default()
        })]

        #[test]
        fn what_bent_normals_mirror_leaves_the_surface(
            viewer in (0.0f64..1.57, 0.0f64..6.2),
            normal in (0.0f64..1.5, 0.0f64..6.2),
        ) {
            let (viewer, normal) = (unit(viewer.0, viewer.1), unit(normal.0, normal.1));
            prop_assume!(normal.dot(viewer) > 0.0);
            let bent = bent(&plane(), normal, -viewer);
            let mirrored = reflect(-viewer, bent);
            let least = (0.875 * viewer.z).min(f64::from(LEAST));
            prop_assert!(mirrored.z > 0.99 * least, "{mirrored:?} by {bent:?}, from {normal:?}");
            prop_assert!((bent.dot(bent) - 1.0).abs() < 1e-6);
            prop_assert!(bent.z >= normal.z - 1e-6, "it leans no more than before");
            let before = reflect(-viewer, normal);
            prop_assert!(before.z < least || bent == normal, "one that mirrors out of the surface stays as it is");
        }
    }
}
