//! From world units to the numbers of the kernels, which lie in [-1, 1].

use eyerays_shader::real::TINY;
use glam::{DAffine3, DVec3, Vec3};

use crate::math;

/// The farthest that anything is from a scene, in its half extents: squares of it are finite.
const FARTHEST: f32 = 1e18;

/// How much larger a scene must become for it to be moved.
const WORTH_MOVING: f64 = 8.0;

/// Moves a scene that lies far from the world's origin and multiplies it by a power of two, so that every vertex, sphere
/// and disk comes into [-1, 1] and no bit of a vertex's or a center's coordinates is lost. Cameras and lights may lie
/// outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Normalisation {
    /// The place that becomes zero, in world units.
    pub origin: Vec3,
    /// What world units are then multiplied by, a power of two.
    pub scale: f64,
}

impl Normalisation {
    /// For a scene's extremes ([`crate::scene::Scene::extremes`]), of which at least one is finite; whoever packs the others refuses them by their number, so they change
    /// nothing here. `movable` unless something counts from the world's origin.
    pub fn of(points: impl Iterator<Item = Vec3>, movable: bool) -> Self {
        let nowhere = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let finite = points.filter(|p| p.is_finite());
        let (least, greatest) = finite.fold(nowhere, |(least, greatest), p| (least.min(p), greatest.max(p)));
        let around = |origin| Normalisation { origin, scale: scale(least, greatest, origin) };
        let (here, moved) = (around(Vec3::ZERO), around(middle(least, greatest)));
        if movable && moved.scale >= WORTH_MOVING * here.scale { moved } else { here }
    }

    /// A place in the normalised scene, which for a vertex or a center is exact.
    #[inline(always)]
    pub fn exactly(&self, p: DVec3) -> DVec3 {
        (p - self.origin.as_dvec3()) * self.scale
    }

    /// A place that may lie outside the scene, such as a camera's or a light's, as a kernel takes it; none if it is too
    /// far away for the kernel's numbers.
    pub fn place_anywhere(&self, p: Vec3) -> Option<Vec3> {
        let placed = self.place(p);
        placed.to_array().iter().all(|x| x.abs() < FARTHEST).then_some(placed)
    }

    /// A place of the normalised scene, in world units.
    pub fn in_world(&self, p: Vec3) -> Vec3 {
        (p.as_dvec3() / self.scale + self.origin.as_dvec3()).as_vec3()
    }

    /// Takes places of the normalised scene to world units.
    pub fn inverse(&self) -> DAffine3 {
        DAffine3::from_translation(self.origin.as_dvec3()) * DAffine3::from_scale(DVec3::splat(1.0 / self.scale))
    }

    /// A place as a kernel takes it; coordinates below 2^-60 are zero (no subnormals).
    pub fn place(&self, p: Vec3) -> Vec3 {
        flushed(self.exactly(p.as_dvec3()).as_vec3())
    }
}

/// On each axis the middle, from which all differences are exact, or zero if that can't be promised.
///
/// Sterbenz: numbers of one sign, none more than twice another, have exact differences. This holds for the centers of
/// spheres and disks too, although only the corners around them were asked: a center lies between its corners. What these
/// were rounded outward by is more room, never less.
fn middle(least: Vec3, greatest: Vec3) -> Vec3 {
    let axis = |low: f32, high: f32| {
        let (near, far) = if low > 0.0 { (low, high) } else { (-high, -low) };
        let apart = near > 0.0 && f64::from(far) <= 2.0 * f64::from(near);
        if apart { ((f64::from(low) + f64::from(high)) / 2.0) as f32 } else { 0.0 }
    };
    Vec3::new(axis(least.x, greatest.x), axis(least.y, greatest.y), axis(least.z, greatest.z))
}

fn scale(least: Vec3, greatest: Vec3, origin: Vec3) -> f64 {
    let [least, greatest] = [least, greatest].map(|p| (p.as_dvec3() - origin.as_dvec3()).abs().max_element());
    let extent = least.max(greatest);
    if extent == 0.0 {
        return 1.0;
    }
    let below = math::power_of_two_below(extent);
    1.0 / if below == extent { extent } else { 2.0 * below }
}

/// Without what a device may take for zero.
pub(crate) fn flushed(v: Vec3) -> Vec3 {
    Vec3::from_array(v.to_array().map(flushed_number))
}

#[inline(always)]
pub(crate) fn flushed_number(x: f32) -> f32 {
    if x.abs() < TINY { 0.0 } else { x }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Disk, Sphere};
    use proptest::prelude::*;

    fn of(points: &[Vec3]) -> Normalisation {
        Normalisation::of(points.iter().copied(), true)
    }

    #[test]
    fn a_scene_around_the_origin_is_only_scaled() {
        for points in [&[Vec3::ZERO][..], &[Vec3::NEG_ONE, Vec3::splat(3.0)], &[Vec3::ONE, Vec3::splat(555.0)]] {
            assert_eq!(of(points).origin, Vec3::ZERO);
        }
        assert_eq!(of(&[Vec3::ZERO, Vec3::splat(-555.0)]).scale, 1.0 / 1024.0);
        assert_eq!(of(&[Vec3::ZERO]).scale, 1.0);
        for power in [1.0, 1024.0, 2f32.powi(-40), 2f32.powi(127)] {
            let scale = |x: f32| of(&[Vec3::ZERO, Vec3::splat(-x)]).scale * f64::from(power);
            assert_eq!([power, power.next_up(), power.next_down()].map(scale), [1.0, 0.5, 1.0]);
        }
    }

    #[test]
    fn a_scene_far_away_is_moved_unless_that_is_forbidden() {
        let points = [Vec3::new(148_374.0, -1.0, -223_425.0), Vec3::new(148_378.0, 1.0, -223_421.0)];
        assert_eq!(of(&points), Normalisation { origin: Vec3::new(148_376.0, 0.0, -223_423.0), scale: 0.5 });
        let held = Normalisation::of(points.into_iter(), false);
        assert_eq!(held, Normalisation { origin: Vec3::ZERO, scale: 0.5f64.powi(18) });
    }

    #[test]
    fn a_point_alone_far_away_becomes_zero() {
        assert_eq!(of(&[Vec3::splat(1e30)]).place(Vec3::splat(1e30)), Vec3::ZERO);
    }

    proptest! {
        /// As `no_bit_is_lost`, of centers, and all of each sphere and disk lies in [-1, 1].
        #[test]
        fn no_bit_of_a_center_is_lost_and_nothing_round_sticks_out(
            middle in prop::array::uniform3(-1e7f32..1e7), size in -8f32..8.0, flat in 0usize..4,
            round in prop::collection::vec((prop::array::uniform4(-1f32..1.0), prop::array::uniform3(-1f32..1.0)), 1..20),
        ) {
            let mut middle = Vec3::from(middle);
            if flat < 3 { middle[flat] = 0.0 }
            let rounds = round.iter().map(|&([x, y, z, radius], normal)| {
                let center = middle + Vec3::new(x, y, z) * size.exp2();
                let normal = Vec3::from(normal).try_normalize().unwrap_or(Vec3::Y);
                (center, (radius.abs() * size.exp2()).max(1e-3), normal)
            });
            let rounds: Vec<(Vec3, f32, Vec3)> = rounds.collect();
            let spheres = rounds.iter().map(|&(center, radius, _)| Sphere { center, radius, material: 0 }.bounds());
            let disk = |&(center, radius, normal): &(Vec3, f32, Vec3)| Disk { center, normal, radius, material: 0 };
            let disks = rounds.iter().map(|round| disk(round).bounds());
            let corners: [Vec<Vec3>; 2] = [spheres.flatten().collect(), disks.flatten().collect()];
            for (corners, is_disk) in corners.iter().zip([false, true]) {
                let normalisation = of(corners);
                for &(center, radius, normal) in &rounds {
                    let (exact, got) = (normalisation.exactly(center.as_dvec3()), normalisation.place(center));
                    prop_assert_eq!(got.as_dvec3(), exact);
                    let sine = |n: f32| if is_disk { (1.0 - f64::from(n).powi(2)).max(0.0).sqrt() } else { 1.0 };
                    let reach = normal.to_array().map(|n| sine(n) * f64::from(radius) * normalisation.scale);
                    for (x, reach) in exact.to_array().into_iter().zip(reach) {
                        // Only a normal's own rounding is allowed for.
                        let most = if is_disk { 1.0 + 1e-6 } else { 1.0 };
                        prop_assert!(x.abs() + reach <= most, "{x} {reach}");
                    }
                }
            }
        }

        /// Every point lies in [-1, 1], not all within half of that, and none has lost a bit.
        #[test]
        fn no_bit_is_lost(
            centre in prop::array::uniform3(-1e7f32..1e7), size in -8f32..8.0,
            offsets in prop::collection::vec(prop::array::uniform3(-1f32..1.0), 1..20), flat in 0usize..4,
        ) {
            let points: Vec<Vec3> = offsets.iter().map(|o| {
                let mut p = Vec3::from(centre) + Vec3::from(*o) * size.exp2();
                if flat < 3 { p[flat] = 0.0 }
                p
            }).collect();
            let normalisation = of(&points);
            let mut extent = 0f32;
            for p in points {
                let (exact, got) = (normalisation.exactly(p.as_dvec3()), normalisation.place(p));
                prop_assert_eq!(got.as_dvec3(), exact);
                extent = extent.max(got.abs().max_element());
            }
            prop_assert!(extent <= 1.0 && (extent > 0.5 || extent == 0.0), "{extent}");
        }
    }
}
