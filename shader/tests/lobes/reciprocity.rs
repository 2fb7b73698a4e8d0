//! Light that goes the other way is scattered as much.

use eyerays_shader::data::Effects;
use eyerays_shader::material::{Albedos, Coat, Ggx, Layers};
use glam::DVec3;
use proptest::prelude::*;

use super::surface::{Seen, V, albedos, direction, facets, glass, gold, leaf, pane, plastic};

/// What is scattered from one direction to the other, without the cosine.
fn between(layers: Layers<f64>, light: DVec3, viewer: DVec3) -> DVec3 {
    let value = Seen::from(layers, viewer).scattering(light).value;
    DVec3::new(value.x, value.y, value.z) / light.z.abs()
}

fn is_near(a: DVec3, b: DVec3) -> bool {
    (a - b).abs().max_element() <= 1e-5 * a.max(b).max_element().max(1e-3)
}

fn above() -> impl Strategy<Value = DVec3> {
    (0.0f64..1.55, 0.0f64..std::f64::consts::TAU).prop_map(|(polar, azimuth)| direction(polar, azimuth))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20_000, failure_persistence: None, ..Default::default() })]

    #[test]
    fn reflection_is_reciprocal(a in above(), b in above(), x in 0.05f64..1.0, y in 0.05f64..1.0) {
        for of in [facets, gold, plastic, pane, |x, y| glass(x, y, 1.0 / 1.5), |x, y| glass(x, y, 1.5)] {
            let (there, back) = (between(of(x, y), a, b), between(of(x, y), b, a));
            prop_assert!(is_near(there, back), "{there} and {back}");
        }
    }

    #[test]
    fn what_passes_a_pane_is_reciprocal(a in above(), b in above(), x in 0.05f64..1.0, y in 0.05f64..1.0) {
        let b = DVec3::new(b.x, b.y, -b.z);
        let (there, back) = (between(pane(x, y), a, b), between(pane(x, y), b, a));
        prop_assert!(is_near(there, back), "{there} and {back}");
    }

    #[test]
    fn what_passes_a_leaf_is_reciprocal(a in above(), b in above(), x in 0.05f64..1.0, y in 0.05f64..1.0) {
        let b = DVec3::new(b.x, b.y, -b.z);
        let (there, back) = (between(leaf(x, y), a, b), between(leaf(x, y), b, a));
        prop_assert!(is_near(there, back), "{there} and {back}");
    }

    /// By itself; what a coat leaves to the layers below depends on the viewer alone.
    #[test]
    fn a_coat_is_reciprocal(a in above(), b in above(), weight in 0.1f64..1.0, alpha in 0.05f64..1.0) {
        let of = |light: DVec3, viewer: DVec3| {
            let up = V::new(0.0, 0.0, 1.0);
            let viewer = V::new(viewer.x, viewer.y, viewer.z);
            let ggx = Ggx { x: alpha, y: alpha };
            let coat = Coat::new(Effects(u32::MAX), Albedos(albedos()), (up, -viewer), (weight, ggx));
            DVec3::splat(coat.scattering(V::new(light.x, light.y, light.z)).0 / light.z)
        };
        prop_assert!(is_near(of(a, b), of(b, a)), "{} and {}", of(a, b), of(b, a));
    }

    /// But for the compression of radiance, by the square of the index.
    #[test]
    fn refraction_is_reciprocal(a in above(), b in above(), x in 0.05f64..1.0, y in 0.05f64..1.0, ior in 1.1f64..2.5) {
        let b = DVec3::new(b.x, b.y, -b.z);
        let outside = between(glass(x, y, 1.0 / ior), b, a);
        let inside = between(glass(x, y, ior), a, b);
        prop_assert!(is_near(outside * ior * ior, inside), "{} and {inside}", outside * ior * ior);
    }
}
