//! Hierarchies that were kept: what was built passes, and what was changed is refused.

mod common;

use common::*;
use eyerays_bvh::{BuildError, Bvh, Quality, build, split};
use eyerays_shader::data::Primitive;

fn built(primitives: &[Primitive], budget: f32, quality: Quality) -> Bvh {
    build(&split(primitives, budget).unwrap(), quality).unwrap()
}

#[test]
fn what_was_built_passes() {
    let meshes =
        [duplicates(40), fan(60), nested(30), collinear(50), grid(12), slivers(200), scattered(500, 3), mixed()];
    for primitives in meshes.iter().chain([&scattered(1, 1), &scattered(2, 1)]) {
        for (budget, quality) in [(0.0, Quality::Fast), (0.3, Quality::Medium), (2.0, Quality::High)] {
            let bvh = built(primitives, budget, quality);
            assert_eq!(bvh.check(primitives), Ok(()), "{} primitives, budget {budget}", primitives.len());
        }
    }
}

/// What a check says after a change to a hierarchy with split triangles.
fn after(change: impl FnOnce(&mut Bvh, &mut Vec<Primitive>)) -> BuildError {
    let mut primitives = slivers(200);
    let mut bvh = built(&primitives, 0.3, Quality::Medium);
    assert!(bvh.order.len() > primitives.len());
    change(&mut bvh, &mut primitives);
    bvh.check(&primitives).expect_err("another hierarchy")
}

#[test]
fn what_was_changed_is_refused() {
    assert_eq!(after(|_, primitives| primitives.clear()), BuildError::NoPrimitives);
    let slots = after(|bvh, _| bvh.bounds.truncate(5));
    assert!(matches!(slots, BuildError::Slots { bounds: 5, .. }), "{slots}");
    let lost = after(|_, primitives| primitives.push(primitives[0]));
    assert_eq!(lost, BuildError::PrimitiveLost { primitive: 200 });
    let out_of_range = after(|bvh, _| bvh.order[3] = u32::MAX);
    assert_eq!(out_of_range, BuildError::BoxElsewhere { slot: 3 });
    assert_eq!(after(|bvh, _| bvh.bounds[7].least.x = f32::NAN.to_bits()), BuildError::BoxElsewhere { slot: 7 });
    assert_eq!(after(|bvh, _| bvh.bounds[7].greatest.y = 2f32.to_bits()), BuildError::BoxElsewhere { slot: 7 });
    let inverted = after(|bvh, _| {
        let own = &mut bvh.bounds[7];
        std::mem::swap(&mut own.least, &mut own.greatest);
    });
    assert_eq!(inverted, BuildError::BoxElsewhere { slot: 7 });
    assert!(matches!(after(|_, primitives| primitives.reverse()), BuildError::BoxElsewhere { .. }));
    let smaller = after(|bvh, _| bvh.bounds[7].least = bvh.bounds[7].greatest);
    assert!(matches!(smaller, BuildError::PrimitiveLost { .. }), "{smaller}");
    assert_eq!(after(|bvh, _| bvh.nodes[0].left_max.x = 2f32.to_bits()), BuildError::BoxTooLarge { pair: 0 });
    assert_eq!(after(|bvh, _| bvh.nodes[0].left_max.x = bvh.nodes[0].left_min.x), BuildError::BoxTooSmall { pair: 0 });
    assert_eq!(after(|bvh, _| bvh.widen().unwrap()), BuildError::SlotOrder);
}
