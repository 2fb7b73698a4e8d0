//! Which light of all a vertex samples, and how likely that was for one that a ray found.

use super::tree::{Guide, STEPS, descend, descend_by, importance, intensity, probability};
use super::{Lighting, Viewpoint};
use crate::buffer::read;
use crate::data::{Effects, Emission, Emitter, LightNode, Primitive};
use crate::real::{FAINT, Scalar};
use crate::scene::LaunchContext;

/// An emitter by draws, with its probability, which is 0 if there is nothing to choose. Of many it is one of those that are far away,
/// or one that has a place.
#[inline(always)]
pub(super) fn picked<R: Scalar>(
    launch: &LaunchContext<'_>,
    lighting: &Lighting<'_>,
    view: &Viewpoint<R>,
    choice: u32,
    place: (u32, u32),
) -> (Emitter, R) {
    picked_by(launch, lighting, |node: &LightNode| importance(node, view), choice, place)
}

/// The same wherever its light goes.
#[inline(always)]
pub(super) fn picked_from_anywhere<R: Scalar>(
    launch: &LaunchContext<'_>,
    lighting: &Lighting<'_>,
    choice: u32,
    place: (u32, u32),
) -> (Emitter, R) {
    picked_by(launch, lighting, |node: &LightNode| intensity(node), choice, place)
}

#[inline(always)]
fn picked_by<R: Scalar>(
    launch: &LaunchContext<'_>,
    lighting: &Lighting<'_>,
    importance: impl Fn(&LightNode) -> R,
    choice: u32,
    place: (u32, u32),
) -> (Emitter, R) {
    let of_table = |count, draw| {
        let emitter = chosen(lighting.emitters, count, draw);
        (emitter, R::splat(f32::from_bits(emitter.choice.z)))
    };
    if !launch.spec.effects.has(Effects::MANY_LIGHTS) {
        return of_table(launch.frame.emitters, choice);
    }
    let steps = read(lighting.emitters, 0).steps();
    let mut guide = Guide::draw(choice, place);
    if !guide.is_second(steps) {
        let (emitter, own) = of_table(launch.frame.far, guide.word());
        return (emitter, (own * probability(steps)).flush(FAINT));
    }
    let found = descend_by(lighting.nodes, importance, probability(STEPS - steps), guide);
    (read(lighting.emitters, found.emitter), found.probability)
}

/// The emitter that a draw means: an entry of the table by its upper digits, that one or its alias by the digits below.
#[inline(always)]
fn chosen(emitters: &[Emitter], count: u32, drawn: u32) -> Emitter {
    let (entry, rest) = product(drawn, count);
    let emitter = read(emitters, entry);
    if rest < emitter.choice.x { emitter } else { read(emitters, emitter.choice.y) }
}

/// The upper and the lower word of a product.
#[inline(always)]
fn product(a: u32, b: u32) -> (u32, u32) {
    let (a1, a0, b1, b0) = (a >> 16, a & 0xffff, b >> 16, b & 0xffff);
    let low = a0.wrapping_mul(b0);
    let middle = a1.wrapping_mul(b0).wrapping_add(low >> 16);
    let other = a0.wrapping_mul(b1).wrapping_add(middle & 0xffff);
    let high = a1.wrapping_mul(b1).wrapping_add(middle >> 16).wrapping_add(other >> 16);
    (high, (other << 16) | (low & 0xffff))
}

/// The density over area with which a place on an emitter is chosen.
#[inline(always)]
pub(super) fn per_area<R: Scalar>(effects: Effects, emission: &Emission, emitter: &Emitter, probability: R) -> R {
    if effects.has(Effects::MANY_LIGHTS) {
        (probability * R::splat(emitter.per_area())).flush(FAINT)
    } else {
        R::splat(f32::from_bits(emission.radiance.w))
    }
}

/// The same for a place that a ray found.
#[inline(always)]
pub(super) fn per_area_of_hit<R: Scalar>(
    launch: &LaunchContext<'_>,
    lighting: &Lighting<'_>,
    (primitive, emission): (&Primitive, &Emission),
    view: &Viewpoint<R>,
) -> R {
    let effects = launch.spec.effects;
    if !effects.has(Effects::MANY_LIGHTS) {
        return R::splat(f32::from_bits(emission.radiance.w));
    }
    let emitter = of_primitive(lighting.emitters, launch.frame.emitters, primitive.number());
    if emitter.light.position.w != Emitter::PRIMITIVE || emitter.number() != primitive.number() {
        return R::splat(0.0);
    }
    let steps = emitter.steps();
    let found = descend(lighting.nodes, view, probability(STEPS - steps), Guide::trail(emitter.trail()));
    per_area(effects, emission, &emitter, found.probability)
}

/// The emitter of a primitive, if it is one: they are the last, by their numbers.
#[inline(always)]
fn of_primitive(emitters: &[Emitter], count: u32, number: u32) -> Emitter {
    let (mut low, mut high) = (0, count - 1);
    while low < high {
        let middle = (low + high) >> 1;
        let emitter = read(emitters, middle);
        if emitter.light.position.w != Emitter::PRIMITIVE || emitter.number() < number {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    read(emitters, low)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bytemuck::Zeroable;
    use glam::UVec4;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn products_have_two_words(a: u32, b: u32) {
            let (high, low) = product(a, b);
            prop_assert_eq!(u64::from(high) << 32 | u64::from(low), u64::from(a) * u64::from(b));
        }
    }

    /// A draw means the entry that it came to where it is below the threshold, which an entry of none never is.
    #[test]
    fn draws_mean_their_entry_or_its_alias() {
        let entry =
            |threshold, alias, own| Emitter { choice: UVec4::new(threshold, alias, own, 0), ..Zeroable::zeroed() };
        let table = [entry(0, 1, 10), entry(u32::MAX, 1, 11), entry(1 << 31, 0, 12), entry(1 << 30, 1, 13)];
        let share = |own| {
            let draws = (0..1u32 << 16).map(|i| i << 16);
            draws.filter(|&drawn| chosen(&table, 4, drawn).choice.z == own).count()
        };
        assert_eq!([10, 11, 12, 13].map(share), [1 << 13, (1 << 15) + 3 * (1 << 12), 1 << 13, 1 << 12]);
        assert_eq!(chosen(&table, 4, 0).choice.z, 11, "a rest of zero is not below a threshold of zero");
    }
}
