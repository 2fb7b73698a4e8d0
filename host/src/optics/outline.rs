//! The outline of a lens, as a polygon whose corners make triangles of equal area with its middle: so places on it are drawn evenly.

use std::f64::consts::{PI, TAU};

use eyerays_shader::camera::MOST_CORNERS;

use crate::math;
use crate::scene::Lens;

/// What the outline depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Outline {
    blades: u32,
    rotation: f32,
    roundness: f32,
}

impl Outline {
    /// That of a lens. One that is round has neither blades nor corners.
    pub fn of(lens: &Lens) -> Outline {
        if lens.blades == 0 || lens.roundness >= 1.0 {
            return Outline { blades: 0, rotation: 0.0, roundness: 1.0 };
        }
        Outline { blades: lens.blades, rotation: lens.rotation, roundness: lens.roundness }
    }

    /// How many corners it has: as many along each blade.
    pub fn corners(&self) -> u32 {
        self.blades.max(1) * self.along_a_blade()
    }

    fn along_a_blade(&self) -> u32 {
        MOST_CORNERS / self.blades.max(1)
    }

    /// Its corners as shares of the radius to the right and up, the first once more at the end.
    pub fn points(&self) -> impl Iterator<Item = [f32; 2]> {
        let (count, along) = (self.corners(), self.along_a_blade());
        // A corner of the diaphragm points up.
        let start = PI / 2.0 + f64::from(self.rotation).to_radians();
        let shares = self.blade();
        let blade = TAU / f64::from(self.blades.max(1));
        let outline = *self;
        (0..=count).map(move |corner| {
            let corner = corner % count;
            let within = shares[(corner % along) as usize];
            let angle = start + blade * (f64::from(corner / along) + within);
            let (sin, cos) = math::sin_cos(angle);
            [cos, sin].map(|share| (share * outline.distance(within)) as f32)
        })
    }

    /// How far the outline is from the middle, at a share of a blade's angle.
    fn distance(&self, share: f64) -> f64 {
        if self.blades == 0 {
            return 1.0;
        }
        let half = PI / f64::from(self.blades);
        let edge = math::cos(half) / math::cos(half * (2.0 * share - 1.0));
        edge + (1.0 - edge) * f64::from(self.roundness)
    }

    /// Where corners are along a blade, as shares of its angle: so that what is between them has equal areas.
    fn blade(&self) -> Vec<f64> {
        let along = self.along_a_blade();
        if self.blades == 0 {
            return (0..along).map(|corner| f64::from(corner) / f64::from(along)).collect();
        }
        /// Parts of a blade that are taken for triangles.
        const PARTS: usize = 1 << 14;
        let mut areas = vec![0.0];
        for part in 0..PARTS {
            let distance = self.distance((part as f64 + 0.5) / PARTS as f64);
            areas.push(areas[part] + distance * distance);
        }
        let mut part = 0;
        let at = |corner: u32| {
            let wanted = areas[PARTS] * f64::from(corner) / f64::from(along);
            while areas[part + 1] < wanted {
                part += 1;
            }
            (part as f64 + (wanted - areas[part]) / (areas[part + 1] - areas[part])) / PARTS as f64
        };
        (0..along).map(at).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(blades: u32, rotation: f32, roundness: f32) -> Vec<[f64; 2]> {
        let lens = Lens { blades, rotation, roundness, ..Lens::round(1.0) };
        Outline::of(&lens).points().map(|point| point.map(f64::from)).collect()
    }

    fn areas(points: &[[f64; 2]]) -> Vec<f64> {
        points.windows(2).map(|pair| (pair[0][0] * pair[1][1] - pair[0][1] * pair[1][0]) / 2.0).collect()
    }

    /// The area of a regular polygon is known, and that of the circle.
    #[test]
    fn triangles_have_equal_areas_and_together_the_outlines() {
        for (blades, rotation, roundness, exactness) in [
            (0, 0.0, 0.0, 1e-5),
            (3, 0.0, 0.0, 1e-5),
            (6, 15.0, 0.0, 1e-5),
            (32, 1.0, 0.0, 1e-5),
            (5, 0.0, 0.5, 2e-3),
            (7, 0.0, 1.0, 1e-5),
        ] {
            let points = points(blades, rotation, roundness);
            assert!(points.len() <= 256 && points.first() == points.last());
            let (areas, count) = (areas(&points), points.len() as f64 - 1.0);
            let sum: f64 = areas.iter().sum();
            let uneven = areas.iter().map(|area| (area * count / sum - 1.0).abs()).fold(0.0, f64::max);
            assert!(uneven < exactness, "{blades} {roundness}: {uneven}");
            let corners = f64::from(if blades == 0 || roundness == 1.0 { 255 } else { blades });
            let whole = corners / 2.0 * (TAU / corners).sin();
            assert!(roundness == 0.5 || (sum / whole - 1.0).abs() < 1e-5, "{blades}: {sum} {whole}");
        }
    }

    #[test]
    fn blades_are_the_corners_and_turn() {
        let square = points(4, 0.0, 0.0);
        let of =
            |wanted: [f64; 2]| square.iter().any(|at| (at[0] - wanted[0]).abs() + (at[1] - wanted[1]).abs() < 1e-6);
        assert!([[0.0, 1.0], [-1.0, 0.0], [0.0, -1.0], [1.0, 0.0]].into_iter().all(of));
        assert!(square.iter().all(|at| (at[0].abs() + at[1].abs() - 1.0).abs() < 1e-6), "edges are straight");
        let turned = points(4, 45.0, 0.0);
        assert!(turned.iter().all(|at| (at[0].abs().max(at[1].abs()) - 0.5f64.sqrt()).abs() < 1e-6));
    }
}
