//! Faces of many corners as triangles.

use std::sync::atomic::{AtomicU64, Ordering};

use earcut::Earcut;
use glam::DVec3;

use crate::scene::Unplaced;

/// How a face is cut into triangles of its corners.
#[derive(Debug, Clone, PartialEq)]
pub enum Cut {
    /// Every edge makes one with the first corner.
    Fan,
    /// These, by the numbers of their corners.
    Triangles(Vec<[u32; 3]>),
    /// No triangles fill what its outline encloses.
    Impossible,
}

/// What a corner may be off, of the face's extent: files have six digits or more.
const DIGITS: f64 = 1e-5;
/// What single precision may move a corner, of its largest coordinate.
const ROUNDING: f64 = 1.0 / (1 << 22) as f64;

/// What cutting the faces of a file may still take: the squares of the numbers of corners, of those that are no fans. An outline that
/// crosses itself takes 0.7 ns of each where its corners are drawn at random, and 3.9 ns where they lie near a circle, so some 8 s in
/// all (on a Xeon at 2.1 GHz); a comb or a star a tenth of the former.
pub struct Effort(AtomicU64);

impl Default for Effort {
    fn default() -> Self {
        Effort(AtomicU64::new(1 << 31))
    }
}

impl Effort {
    /// Cuts a face in its own plane, of the three or more `corners` in any unit. A fan that fits is preferred; a
    /// convex face has one. The same corners give the same triangles on every machine: no function is used that
    /// processors or systems compute differently. Where too much was cut already this is impossible, and
    /// [`check`](Effort::check) says so.
    pub fn cut(&self, corners: &[DVec3]) -> Cut {
        if corners.len() == 3 {
            return Cut::Fan;
        }
        let spokes: Vec<DVec3> = corners[1..].iter().map(|&corner| corner - corners[0]).collect();
        let largest = |vectors: &[DVec3]| vectors.iter().map(|v| v.abs().max_element()).fold(0.0, f64::max);
        let extent = largest(&spokes);
        let slack = (DIGITS * extent).max(ROUNDING * largest(corners));
        // Twice the area, along the face's normal.
        let area: DVec3 = spokes.windows(2).map(|pair| pair[0].cross(pair[1])).sum();
        let face = Face { spokes, normal: area.normalize_or_zero(), slack };
        if area.length() <= slack * extent {
            // A line is invisible however it is cut, but a face that folds back onto itself is not a line.
            return if face.is_line() { Cut::Fan } else { Cut::Impossible };
        }
        if face.is_fan() {
            Cut::Fan
        } else if self.spend(corners.len()) {
            face.ears(area.length(), slack * extent)
        } else {
            Cut::Impossible
        }
    }

    /// Refuses what was too much, whichever face was the last.
    ///
    /// # Errors
    /// Faces were left out.
    pub fn check(&self) -> Unplaced<()> {
        match self.0.load(Ordering::Relaxed) {
            0 => {
                Err("its faces have too many corners to be cut into triangles; split those that are not convex".into())
            }
            _ => Ok(()),
        }
    }

    /// Takes the effort of a face, if there is still so much.
    fn spend(&self, corners: usize) -> bool {
        let effort = (corners as u64).saturating_mul(corners as u64);
        let take = |left: u64| Some(left.saturating_sub(effort));
        self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, take).is_ok_and(|left| left > effort)
    }
}

struct Face {
    /// From the first corner to each of the others.
    spokes: Vec<DVec3>,
    /// Of length one, or zero where there is no area.
    normal: DVec3,
    /// A length that does not count.
    slack: f64,
}

impl Face {
    fn is_line(&self) -> bool {
        let longest = self.spokes.iter().copied().max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
        let along = longest.map_or(DVec3::ZERO, DVec3::normalize_or_zero);
        self.spokes.iter().all(|spoke| spoke.cross(along).length() <= self.slack)
    }

    /// Do the spokes turn one way, and by less than a whole turn?
    fn is_fan(&self) -> bool {
        let Some(first) = self.spokes.iter().find(|spoke| spoke.length() > self.slack) else {
            return true;
        };
        let mut beyond_half = false;
        self.spokes.windows(2).all(|pair| {
            let (from, to) = (pair[0], pair[1]);
            let turn = self.normal.dot(from.cross(to));
            let side = self.normal.dot(first.cross(to));
            let begun_again = beyond_half && side >= 0.0 && first.dot(to) > 0.0;
            beyond_half |= side < -self.slack * first.length().max(to.length());
            turn >= -self.slack * from.length().max(to.length()) && !begun_again
        })
    }

    /// The ears of the outline, if they fill its area (twice that is given) but for what does not count.
    fn ears(&self, area: f64, slack: f64) -> Cut {
        let (right, up) = self.normal.any_orthonormal_pair();
        let flat = |spoke: &DVec3| [right.dot(*spoke), up.dot(*spoke)];
        let points: Vec<[f64; 2]> = [DVec3::ZERO].iter().chain(&self.spokes).map(flat).collect();
        let mut numbers: Vec<u32> = Vec::new();
        Earcut::new().earcut_slice(&points, &[], &mut numbers);
        let (triangles, _) = numbers.as_chunks();
        let mut triangles = triangles.to_vec();
        let mut covered = 0.0;
        for triangle in &mut triangles {
            let [a, b, c] = triangle.map(|corner| points[corner as usize]);
            let twice = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
            if twice < 0.0 {
                triangle.swap(1, 2);
            }
            covered += twice.abs();
        }
        if (covered - area).abs() <= slack { Cut::Triangles(triangles) } else { Cut::Impossible }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn cut(corners: &[DVec3]) -> Cut {
        Effort::default().cut(corners)
    }

    fn flat(points: &[[f64; 2]]) -> Vec<DVec3> {
        points.iter().map(|&[x, y]| DVec3::new(x, y, 0.0)).collect()
    }

    fn regular(count: u32) -> Vec<DVec3> {
        let at = |i| f64::from(i) * std::f64::consts::TAU / f64::from(count);
        (0..count).map(|i| DVec3::new(at(i).cos(), at(i).sin(), 0.0)).collect()
    }

    /// Twice the area of an outline, along its normal.
    fn area(outline: &[DVec3]) -> DVec3 {
        let spokes = outline[1..].iter().map(|&corner| corner - outline[0]);
        spokes.clone().zip(spokes.skip(1)).map(|(a, b)| a.cross(b)).sum()
    }

    /// Asserts that the triangles face as the outline does and that their areas sum to its area.
    fn assert_filled(outline: &[DVec3]) {
        let last = outline.len() as u32 - 1;
        let triangles = match cut(outline) {
            Cut::Fan => (1..last).map(|i| [0, i, i + 1]).collect(),
            Cut::Triangles(triangles) => triangles,
            Cut::Impossible => panic!("not cut: {outline:?}"),
        };
        let whole = area(outline);
        let mut sum = 0.0;
        for triangle in triangles {
            let along = area(&triangle.map(|corner| outline[corner as usize])).dot(whole.normalize());
            assert!(along >= -1e-5 * whole.length(), "{triangle:?} is turned around");
            sum += along.abs();
        }
        assert!((sum - whole.length()).abs() < 1e-4 * whole.length(), "{sum} of {}", whole.length());
    }

    /// Out along one arm of a spiral and back along the other, `count` corners each.
    fn spiral(count: u32) -> Vec<DVec3> {
        let arm = |i: u32, width: f64| {
            let turn = f64::from(i) / f64::from(count) * 5.0 * std::f64::consts::TAU;
            DVec3::new(turn.cos(), turn.sin(), 0.0) * (turn + width)
        };
        (0..count).map(|i| arm(i, 1.0)).chain((0..count).rev().map(|i| arm(i, 3.0))).collect()
    }

    #[test]
    fn concave_faces_are_filled_and_their_gaps_are_not() {
        let u = flat(&[[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [2.0, 3.0], [2.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]]);
        let star: Vec<_> = regular(10).iter().enumerate().map(|(i, &p)| p * [1.0, 0.3][i % 2]).collect();
        for mut outline in [u, star, spiral(60)] {
            for _ in 0..outline.len() {
                assert_filled(&outline);
                outline.rotate_left(1);
            }
            outline.reverse();
            assert_filled(&outline);
        }
    }

    #[test]
    fn a_hole_at_the_end_of_a_slit_stays_open() {
        let outside = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [0.0, 0.0]];
        let hole = [[1.0, 1.0], [1.0, 3.0], [3.0, 3.0], [3.0, 1.0], [1.0, 1.0]];
        let outline = flat(&[outside, hole].concat());
        assert_eq!(area(&outline).z, 2.0 * (16.0 - 4.0));
        assert_filled(&outline);
    }

    #[test]
    fn a_convex_face_is_a_fan_whatever_the_plane_and_however_many_corners_lie_on_an_edge() {
        let square = [[0.0, 0.0], [0.3, 0.0], [1.0, 0.0], [1.0, 0.7], [1.0, 1.0], [0.5, 1.0], [0.0, 1.0], [0.0, 0.1]];
        for mut outline in [flat(&square), regular(5), regular(4), regular(999)] {
            for _ in 0..outline.len() {
                let slanted = outline.iter().map(|p| DVec3::new(p.x, p.y, 0.7 * p.x - 3.1 * p.y));
                // As a file of six digits has it.
                let written: Vec<_> = slanted.map(|p| (p * 1e6).round() / 1e6 + 100.0).collect();
                assert_eq!(cut(&outline), Cut::Fan);
                assert_eq!(cut(&written), Cut::Fan);
                outline.rotate_left(1);
            }
        }
    }

    #[test]
    fn a_bent_quad_is_a_fan_and_so_is_a_face_that_nobody_sees() {
        let bent = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.6), DVec3::Y];
        assert_eq!(cut(&bent), Cut::Fan);
        assert_eq!(cut(&[DVec3::X; 5]), Cut::Fan);
        assert_eq!(cut(&flat(&[[0.0, 0.0], [2.0, 2.0], [1.0, 1.0], [3.0, 3.0]])), Cut::Fan);
        assert_eq!(cut(&flat(&[[0.0, 0.0], [0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [1.0, 1.0]])), Cut::Fan);
    }

    #[test]
    fn an_outline_that_crosses_itself_is_not_cut() {
        let even = flat(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]);
        let odd = flat(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.4]]);
        let pentagram: Vec<_> = (0..5).map(|i| regular(5)[2 * i % 5]).collect();
        for outline in [even, odd, pentagram] {
            assert_eq!(cut(&outline), Cut::Impossible, "{outline:?}");
        }
    }

    /// Refused are more corners than take some seconds, in one face or in many, but those of convex ones count nothing.
    #[test]
    fn faces_of_very_many_corners_are_too_much_unless_they_are_convex() {
        let effort = Effort::default();
        assert_eq!(effort.cut(&regular(1 << 18)), Cut::Fan);
        assert!(matches!(effort.cut(&spiral(1 << 8)), Cut::Triangles(_)));
        assert_eq!(effort.check(), Ok(()));
        assert_eq!(effort.cut(&spiral(1 << 15)), Cut::Impossible);
        assert!(effort.check().is_err());
        assert_eq!(effort.cut(&spiral(1 << 8)), Cut::Impossible, "after that none is cut");
        let many = Effort(AtomicU64::new(512 * 512 * 3));
        let cut = (0..4).filter(|_| matches!(many.cut(&spiral(256)), Cut::Triangles(_))).count();
        assert_eq!((cut, many.check().is_err()), (2, true));
    }

    proptest! {
        #[test]
        fn the_triangles_of_any_simple_outline_have_its_area(
            radii in prop::collection::vec(0.05..1.0, 4..40),
            normal in prop::array::uniform3(-1.0..1.0),
            scale in prop::sample::select(vec![1e-3, 1.0, 1e4]),
            middle in prop::array::uniform3(-2.0..2.0),
        ) {
            let normal = DVec3::from(normal);
            prop_assume!(normal.length() > 0.1);
            let (right, up) = normal.normalize().any_orthonormal_pair();
            let corners = regular(radii.len() as u32).into_iter().zip(radii);
            let place = |(p, radius): (DVec3, f64)| (DVec3::from(middle) + (right * p.x + up * p.y) * radius) * scale;
            let outline: Vec<_> = corners.map(place).map(|p| p.as_vec3().as_dvec3()).collect();
            assert_filled(&outline);
        }
    }
}
