//! The hierarchy of lights as kernels go through it.

use eyerays_shader::data::LightNode;
use eyerays_shader::light::{Guide, Viewpoint, descend};
use eyerays_shader::real::V3;
use glam::{DVec3, Vec3};
use proptest::prelude::*;

use super::*;

/// Lights of all kinds; of a surface, its normal is the axis.
fn light() -> impl Strategy<Value = Bounded> {
    let place = || (-1f64..1.0, -1f64..1.0, -1f64..1.0).prop_map(DVec3::from);
    (place(), place(), 0.0..0.2f64, -12f64..2.0, 0..4u32, 0.05..1.5f64).prop_map(
        |(middle, axis, size, power, kind, opening)| {
            let axis = axis.try_normalize().unwrap_or(DVec3::X);
            let cone = match kind {
                0 => Cone::all(),
                1 => Cone::flat(axis, false),
                2 => Cone::flat(axis, true),
                _ => Cone { axis, opening, is_spread: false, is_two_sided: false },
            };
            let half = if kind == 3 { DVec3::ZERO } else { DVec3::new(size, size / 2.0, 0.0) };
            let intensity = crate::math::exp2(power);
            Bounded { least: middle - half, greatest: middle + half, intensity, cone }
        },
    )
}

fn view() -> impl Strategy<Value = Viewpoint<f32>> {
    let place = || (-1.5f32..1.5, -1.5f32..1.5, -1.5f32..1.5).prop_map(Vec3::from);
    (place(), place(), any::<bool>()).prop_map(|(origin, normal, passes)| {
        let normal = normal.try_normalize().unwrap_or(Vec3::Z);
        Viewpoint::new(V3::splat(origin), V3::splat(normal), passes)
    })
}

fn likely(tree: &LightTree, view: &Viewpoint<f32>, light: usize) -> f32 {
    let found = descend(&tree.nodes, view, 1.0, Guide::trail(tree.trails[light]));
    assert!(found.probability == 0.0 || found.emitter == light as u32, "a trail leads elsewhere");
    found.probability
}

/// May some of its light arrive? A place of its box sends there, by angles of its own.
fn arrives(light: &Bounded, origin: DVec3, share: DVec3) -> bool {
    let from = light.least + (light.greatest - light.least) * share;
    let Some(direction) = (origin - from).try_normalize() else { return true };
    let cosine = light.cone.axis.dot(direction);
    let cosine = if light.cone.is_two_sided { cosine.abs() } else { cosine };
    let spread = if light.cone.is_spread { std::f64::consts::FRAC_PI_2 } else { 0.0 };
    crate::math::acos(cosine.clamp(-1.0, 1.0)) < light.cone.opening + spread
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..Default::default() })]

    /// From anywhere, unless none of them shines there.
    #[test]
    fn the_probabilities_of_all_lights_are_one(lights in prop::collection::vec(light(), 2..60), view in view()) {
        let tree = LightTree::new(&lights, 0);
        prop_assert_eq!(tree.nodes.len(), 2 * lights.len() - 1);
        let sum: f64 = (0..lights.len()).map(|i| f64::from(likely(&tree, &view, i))).sum();
        // A branch that turns out to be dark below takes its share away.
        prop_assert!(sum < 1.0 + 1e-5, "{}", sum);
        let all = lights.iter().all(|light| light.cone.opening > 3.0);
        prop_assert!(!all || sum > 1.0 - 1e-5, "{}", sum);
    }

    /// What is drawn has the bits of the probability that its trail gives.
    #[test]
    fn a_draw_and_a_trail_give_the_same_bits(
        lights in prop::collection::vec(light(), 2..60), view in view(), draw: u32, other: (u32, u32),
    ) {
        let tree = LightTree::new(&lights, 0);
        let found = descend(&tree.nodes, &view, 0.75, Guide::draw(draw, other));
        if found.probability > 0.0 {
            let trail = tree.trails[found.emitter as usize];
            let again = descend(&tree.nodes, &view, 0.75, Guide::trail(trail));
            prop_assert_eq!((again.emitter, again.probability.to_bits()), (found.emitter, found.probability.to_bits()));
        }
    }

    /// A light of which a place shines at the viewer may be chosen.
    #[test]
    fn what_is_never_chosen_sends_nothing(
        lights in prop::collection::vec(light(), 2..40), view in view(),
        share in (0f64..1.0, 0f64..1.0, 0f64..1.0).prop_map(DVec3::from),
    ) {
        let tree = LightTree::new(&lights, 0);
        let origin = DVec3::new(view.origin.x.into(), view.origin.y.into(), view.origin.z.into());
        for (i, light) in lights.iter().enumerate() {
            if likely(&tree, &view, i) == 0.0 {
                prop_assert!(!arrives(light, origin, share), "{light:?}");
            }
        }
    }

    /// Each node's box holds the lights below, and its intensity is theirs.
    #[test]
    fn a_node_bounds_what_is_below(lights in prop::collection::vec(light(), 2..60)) {
        let tree = LightTree::new(&lights, 0);
        let total: f64 = lights.iter().map(|light| light.intensity).sum();
        for (i, light) in lights.iter().enumerate() {
            let (mut at, mut trail) = (0, tree.trails[i]);
            while !tree.nodes[at].has(LightNode::LEAF) {
                let node = &tree.nodes[at];
                let middle = eyerays_shader::data::numbers(node.middle).as_dvec3();
                let half = eyerays_shader::data::numbers(node.half).as_dvec3() + DVec3::splat(1e-6);
                prop_assert!((light.least - middle).abs().cmple(half).all());
                prop_assert!((light.greatest - middle).abs().cmple(half).all());
                prop_assert!(f64::from(f32::from_bits(node.middle.w)) >= light.intensity / total * (1.0 - 1e-6));
                at = if trail & 1 == 0 { at + 1 } else { node.number() as usize };
                trail >>= 1;
            }
            prop_assert_eq!(tree.nodes[at].number(), i as u32);
        }
    }
}

/// By a chi-square test of 2^16 draws.
#[test]
fn lights_are_drawn_as_often_as_their_trails_say() {
    let lights: Vec<Bounded> = (0..40u32)
        .map(|i| {
            let middle = DVec3::new(f64::from(i * 7 % 40) / 20.0 - 1.0, f64::from(i % 5) / 5.0, f64::from(i % 3));
            Bounded { least: middle, greatest: middle + 0.01, intensity: f64::from(1 + i % 4), cone: Cone::all() }
        })
        .collect();
    let tree = LightTree::new(&lights, 0);
    let view = Viewpoint::<f32>::new(V3::new(0.1, 0.2, 0.3), V3::new(0.0, 0.0, 1.0), false);
    let mut counts = [0u32; 40];
    const DRAWS: u32 = 1 << 16;
    for i in 0..DRAWS {
        let other = i.wrapping_mul(0x9e37_79b9);
        counts[descend(&tree.nodes, &view, 1.0, Guide::draw(i << 16, (other, !other))).emitter as usize] += 1;
    }
    for (i, &count) in counts.iter().enumerate() {
        let wanted = f64::from(likely(&tree, &view, i)) * f64::from(DRAWS);
        // The draws are even, so that counts are nearer than those of chance.
        assert!((f64::from(count) - wanted).abs() < 4.0 * wanted.sqrt() + 4.0, "{i}: {count}, {wanted}");
    }
}

/// Where no cut parts them, and where each cut takes one off: no way is longer than a word.
#[test]
fn ways_are_short_whatever_the_lights_are() {
    let at = |middle: DVec3| Bounded { least: middle, greatest: middle, intensity: 1.0, cone: Cone::all() };
    let same: Vec<Bounded> = (0..1000).map(|_| at(DVec3::ONE)).collect();
    let halved: Vec<Bounded> = (0..1000).map(|i| at(DVec3::X * crate::math::exp2(-f64::from(i)))).collect();
    for lights in [same, halved] {
        let tree = LightTree::new(&lights, 5);
        let view = Viewpoint::<f32>::new(V3::zero(), V3::zero(), true);
        for (i, &trail) in tree.trails.iter().enumerate() {
            let found = descend(&tree.nodes, &view, 1.0, Guide::trail(trail));
            assert!(found.probability == 0.0 || found.emitter == i as u32 + 5);
        }
    }
}
