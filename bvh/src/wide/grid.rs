//! A node's grid, on which its children's boxes lie.
//!
//! Why double precision decides exactly whether a plane is far enough out: an origin is a multiple of
//! 2^-30 below 4, a step is a power of two from 2^-30 to 2^0 and a plane at most 255 of them from the
//! origin, and the margin is 2^-19 and 2^-6 of a step. So a plane's place with its margin is a multiple of
//! 2^-36 below 2^9: 45 bits, which double precision adds up without rounding. The coordinate that it is
//! compared with is a single, which converts exactly.

use eyerays_shader::data::CwbvhNode;

use crate::bounds::Bounds;

/// The numbers of a box's planes, least and greatest, for each axis.
pub(crate) type Planes = [[u8; 3]; 2];

/// Where planes 0 to 255 lie, on each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Grid {
    /// Plane 0, a multiple of [`FINEST`].
    pub origin: [f32; 3],
    /// The step is 2 to this power.
    pub exponent: [i32; 3],
}

/// The exponent of the finest step.
pub(crate) const LEAST_EXPONENT: i32 = -30;
/// The exponent of the coarsest step. The scene takes 2^-6.
pub(crate) const GREATEST_EXPONENT: i32 = 0;
/// The farthest an origin lies from 0.
pub(crate) const FARTHEST: f32 = 2.0;

const FINEST: f64 = 1.0 / (1u64 << -LEAST_EXPONENT) as f64;
const MARGIN: f64 = CwbvhNode::MARGIN as f64;
const SLACK: f64 = CwbvhNode::SLACK as f64;
const PLANES: f64 = u8::MAX as f64;

impl Grid {
    /// The finest grid around a box in the normalised scene.
    pub fn around(bounds: Bounds) -> Self {
        let low = |axis: usize, e: i32| origin(below(bounds.min[axis]) - SLACK * step(e));
        let fits = |axis: usize, e: i32| {
            let high = above(bounds.max[axis]) + SLACK * step(e);
            PLANES * step(e) >= high - f64::from(low(axis, e))
        };
        let exponent: [i32; 3] = std::array::from_fn(|axis| {
            // No smaller step has planes enough; 0.99 leaves room for rounding.
            let first = exponent(bounds.extent()[axis] / PLANES as f32 * 0.99).clamp(LEAST_EXPONENT, GREATEST_EXPONENT);
            (first..GREATEST_EXPONENT).find(|&e| fits(axis, e)).unwrap_or(GREATEST_EXPONENT)
        });
        Grid { origin: std::array::from_fn(|axis| low(axis, exponent[axis])), exponent }
    }

    /// The planes closest around a box inside the grid that keep the margin.
    pub fn planes(&self, bounds: Bounds) -> Planes {
        // Exact up to the conversion, which takes whole numbers from 0 to 255.
        let steps = |place: f64, axis: usize| (place - f64::from(self.origin[axis])) / step(self.exponent[axis]);
        [
            std::array::from_fn(|axis| (steps(below(bounds.min[axis]), axis) - SLACK).floor() as u8),
            std::array::from_fn(|axis| (steps(above(bounds.max[axis]), axis) + SLACK).ceil() as u8),
        ]
    }

    /// Do the planes enclose a box, with the margin? Exact if the grid [`Grid::is_sound`].
    pub fn contains(&self, planes: Planes, bounds: Bounds) -> bool {
        let place = |side: usize, axis: usize| {
            f64::from(self.origin[axis]) + f64::from(planes[side][axis]) * step(self.exponent[axis])
        };
        (0..3).all(|axis| {
            let margin = MARGIN + SLACK * step(self.exponent[axis]);
            place(0, axis) + margin <= f64::from(bounds.min[axis])
                && place(1, axis) - margin >= f64::from(bounds.max[axis])
        })
    }

    /// The box between planes, approximately.
    pub fn bounds(&self, planes: Planes) -> Bounds {
        let place = |side: usize, axis: usize| {
            (f64::from(self.origin[axis]) + f64::from(planes[side][axis]) * step(self.exponent[axis])) as f32
        };
        Bounds::new([0, 1, 2].map(|axis| place(0, axis)), [0, 1, 2].map(|axis| place(1, axis)))
    }

    /// Are origin and steps as the module's proof assumes?
    pub fn is_sound(&self) -> bool {
        let origin = |o: &f32| o.abs() <= FARTHEST && (f64::from(*o) / FINEST).fract() == 0.0;
        let exponent = |e: &i32| (LEAST_EXPONENT..=GREATEST_EXPONENT).contains(e);
        self.origin.iter().all(origin) && self.exponent.iter().all(exponent)
    }
}

/// The greatest power of two up to a positive number; less than any that counts for 0.
fn exponent(number: f32) -> i32 {
    (number.to_bits() >> 23) as i32 - 127
}

/// 2 to a power that double precision holds.
fn step(exponent: i32) -> f64 {
    f64::from_bits(((1023 + i64::from(exponent)) as u64) << 52)
}

/// The greatest multiple of [`FINEST`] that lies the margin below a coordinate.
fn below(coordinate: f32) -> f64 {
    (f64::from(coordinate) / FINEST).floor() * FINEST - MARGIN
}

/// The least multiple of [`FINEST`] that lies the margin above a coordinate.
fn above(coordinate: f32) -> f64 {
    (f64::from(coordinate) / FINEST).ceil() * FINEST + MARGIN
}

/// The greatest single at or below a coordinate that is a multiple of [`FINEST`]: one below 2^-6 holds every such
/// multiple as it is, and larger ones are spaced by [`FINEST`] or more.
fn origin(place: f64) -> f32 {
    let place = (place / FINEST).floor() * FINEST;
    let nearest = place as f32;
    if f64::from(nearest) > place { nearest.next_down() } else { nearest }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn coordinate() -> impl Strategy<Value = f32> {
        prop_oneof![
            -1.0f32..=1.0,
            -1e-5f32..=1e-5,
            (0i32..120, any::<bool>())
                .prop_map(|(k, negative)| { if negative { -0.5f32.powi(k) } else { 0.5f32.powi(k) } })
        ]
    }

    fn bounds() -> impl Strategy<Value = Bounds> {
        let corner = || [coordinate(), coordinate(), coordinate()];
        (corner(), corner()).prop_map(|(a, b)| Bounds::new(a, a).union(Bounds::new(b, b)))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn planes_keep_the_margin_and_are_the_closest(a in bounds(), b in bounds()) {
            let grid = Grid::around(a.union(b));
            prop_assert!(grid.is_sound());
            for child in [a, b] {
                let planes = grid.planes(child);
                prop_assert!(grid.contains(planes, child));
                for (side, axis) in (0..6).map(|i| (i / 3, i % 3)) {
                    let mut closer = planes;
                    let Some(plane) = (if side == 0 { planes[0][axis].checked_add(1) } else { planes[1][axis].checked_sub(1) })
                    else { continue };
                    closer[side][axis] = plane;
                    let lattice = child.min.to_array().iter().chain(&child.max.to_array()).all(|c| (f64::from(*c) / FINEST).fract() == 0.0);
                    prop_assert!(!lattice || !grid.contains(closer, child));
                }
            }
        }

        #[test]
        fn no_finer_step_would_do(a in bounds()) {
            let grid = Grid::around(a);
            for axis in 0..3 {
                let extent = f64::from(a.max[axis]) - f64::from(a.min[axis]) + 2.0 * MARGIN;
                let e = grid.exponent[axis];
                let slack = 2.0 * SLACK * step(e - 1);
                prop_assert!(e == LEAST_EXPONENT || PLANES * step(e - 1) < extent + slack + 4.0 * FINEST + 2f64.powi(-22));
            }
        }
    }

    #[test]
    fn the_scene_and_a_point() {
        let whole = Bounds::new([-1.0; 3], [1.0; 3]);
        assert_eq!(Grid::around(whole).exponent, [-6; 3]);
        let point = Bounds::new([1.0; 3], [1.0; 3]);
        let grid = Grid::around(point);
        assert_eq!(grid.exponent, [-25; 3]);
        assert_eq!(grid.origin, [(1.0 - CwbvhNode::MARGIN).next_down(); 3]);
    }

    #[test]
    fn grids_that_the_proof_does_not_cover_are_unsound() {
        let sound = Grid { origin: [1.0; 3], exponent: [-6; 3] };
        assert!(sound.is_sound());
        for origin in [f32::NAN, 2.5, -3.0, 1e-30, 0.5f32.powi(31)] {
            assert!(!Grid { origin: [0.0, origin, 0.0], ..sound }.is_sound());
        }
        for exponent in [-31, 1, 128] {
            assert!(!Grid { exponent: [-6, -6, exponent], ..sound }.is_sound());
        }
    }
}
