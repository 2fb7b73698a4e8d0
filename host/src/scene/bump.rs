//! Pictures of heights as normal maps.

use rayon::prelude::*;

use super::displace::Heights;
use super::{Placement, Texels, Texture, Wrap};

/// The slopes of a picture of heights along the texture coordinates of a surface, as a normal map.
///
/// Its texels are floats, which are within 2^-24 of the steepest slope. Bytes would be within 1/255, and none of them is 0: what is flat
/// would lean, and a slope of 1 elsewhere in the picture would turn what it mirrors by 0.45 degrees.
#[derive(Debug, Clone, PartialEq)]
pub struct Slopes {
    /// Slopes as shares of the steepest: white stands for it, and black for as steep a one the other way.
    pub texture: Texture,
    /// The steepest, which the strength of the map is multiplied with: how many heights of white over black a surface rises along
    /// one unit of its texture coordinates.
    pub steepest: f64,
}

/// What of a placement changes the slopes of a picture, but for a factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Lay {
    wrap: [Wrap; 2],
    /// Bits of the placement's linear part, whose greatest number is 1 or -1.
    linear: [[u32; 2]; 2],
}

impl Lay {
    /// That of a placement, and the factor.
    pub fn of(placement: &Placement) -> (Lay, f64) {
        let linear = placement.transform.map(|[across, down, _]| [across, down]);
        let greatest = linear.as_flattened().iter().fold(0.0, |most: f32, number| most.max(number.abs()));
        // Zeros have one sign, so that equal placements have equal bits.
        let bits = |number: f32| if greatest > 0.0 { (number / greatest + 0.0).to_bits() } else { 0 };
        (Lay { wrap: placement.wrap, linear: linear.map(|row| row.map(bits)) }, greatest.into())
    }

    /// The size of the normal map of a picture of this size. A mirrored picture has its mirror image beside it: kernels mirror
    /// where a normal is, but not the normal.
    pub fn size(&self, width: u32, height: u32) -> (u32, u32) {
        let side = |side: u32, wrap| if wrap == Wrap::Mirror { side.saturating_mul(2) } else { side };
        (side(width, self.wrap[0]), side(height, self.wrap[1]))
    }

    /// Where the normal map lies instead of the picture.
    pub fn placed(placement: Placement) -> Placement {
        let mut placed = placement;
        for (row, wrap) in placed.transform.iter_mut().zip(&mut placed.wrap) {
            if *wrap == Wrap::Mirror {
                *wrap = Wrap::Repeat;
                *row = row.map(|number| number / 2.0);
            }
        }
        placed
    }

    /// The slopes of a picture by central differences.
    pub fn slopes(&self, name: &str, heights: &Heights) -> Slopes {
        let (width, height) = self.size(heights.width, heights.height);
        let [[a, b], [c, d]] = self.linear.map(|row| row.map(|bits| f64::from(f32::from_bits(bits))));
        let at = |x: i64, y: i64| {
            let column = within(x, heights.width, self.wrap[0]);
            let row = within(y, heights.height, self.wrap[1]);
            f64::from(heights.values[row * heights.width as usize + column])
        };
        let [across, down] = [heights.width, heights.height].map(|side| f64::from(side) / 2.0);
        let slope = |x: u32, y: u32| {
            let (x, y) = (i64::from(x), i64::from(y));
            let right = (at(x + 1, y) - at(x - 1, y)) * across;
            let below = (at(x, y + 1) - at(x, y - 1)) * down;
            [right * a + below * c, right * b + below * d]
        };
        let greatest =
            |y: u32| (0..width).flat_map(|x| slope(x, y)).fold(0.0, |most: f64, slope| most.max(slope.abs()));
        let steepest = (0..height).into_par_iter().map(greatest).reduce(|| 0.0, f64::max);
        let share = |slope: f64| if steepest > 0.0 { 0.5 + 0.5 * (slope / steepest) } else { 0.5 };
        let mut texels = vec![[0.0; 4]; width as usize * height as usize];
        texels.par_chunks_mut(width as usize).zip(0..height).for_each(|(row, y)| {
            for (texel, x) in row.iter_mut().zip(0..width) {
                let [u, v] = slope(x, y);
                // A normal leans away from what rises. Normal maps have their second axis up, texture coordinates down.
                *texel = [share(-u) as f32, share(v) as f32, 1.0, 1.0];
            }
        });
        Slopes { texture: Texture { name: name.to_owned(), width, height, texels: Texels::Floats(texels) }, steepest }
    }
}

/// The texel that an index stands for, which is beyond a picture that is not mirrored by one texel at most.
fn within(index: i64, side: u32, wrap: Wrap) -> usize {
    let side = i64::from(side);
    let index = match wrap {
        Wrap::Repeat => index.rem_euclid(side),
        Wrap::Clamp => index.clamp(0, side - 1),
        Wrap::Mirror => {
            let index = index.rem_euclid(2 * side);
            index.min(2 * side - 1 - index)
        }
    };
    index as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec2, DVec3, Vec2};

    fn heights(width: u32, height: u32, value: impl Fn(f64, f64) -> f64) -> Heights {
        let middle = |texel: u32, side: u32| (f64::from(texel) + 0.5) / f64::from(side);
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let values = places.map(|(x, y)| value(middle(x, width), middle(y, height)) as f32).collect();
        Heights { width, height, values }
    }

    fn slopes(heights: &Heights, placement: &Placement) -> Slopes {
        Lay::of(placement).0.slopes("test", heights)
    }

    /// The normal of a texel as kernels take it, where white is `height` above black, and a unit of coordinates `length` long.
    fn normal(slopes: &Slopes, factor: f64, (x, y): (u32, u32)) -> DVec3 {
        let Texels::Floats(texels) = &slopes.texture.texels else { panic!("no floats") };
        let [r, g, b, _] = texels[(y * slopes.texture.width + x) as usize].map(f64::from);
        let scale = slopes.steepest * factor;
        DVec3::new((2.0 * r - 1.0) * scale, (2.0 * g - 1.0) * scale, 2.0 * b - 1.0).normalize()
    }

    #[test]
    fn a_flat_picture_leaves_normals_as_they_are() {
        for value in [0.0, 0.3, 1.0] {
            let flat = slopes(&heights(5, 3, |_, _| value), &Placement::default());
            assert_eq!(flat.steepest, 0.0);
            assert!((0..15).all(|texel| normal(&flat, 1e6, (texel % 5, texel / 5)) == DVec3::Z), "{value}");
        }
        // Beside what is steep, too.
        let step = slopes(&heights(64, 1, |u, _| if u < 0.5 { 0.0 } else { 1.0 }), &Placement::default());
        assert_eq!(normal(&step, 10.0, (10, 0)), DVec3::Z);
        assert_ne!(normal(&step, 10.0, (31, 0)), DVec3::Z);
    }

    /// Up to the texels whose neighbours the edges change.
    #[test]
    fn a_plane_has_the_normal_of_its_slopes() {
        let plane = slopes(&heights(16, 8, |u, v| 0.5 * u - 0.25 * v), &Placement::default());
        let wanted = DVec3::new(-0.5 * 3.0, -0.25 * 3.0, 1.0).normalize();
        for (x, y) in (1..15).flat_map(|x| (1..7).map(move |y| (x, y))) {
            assert!(normal(&plane, 3.0, (x, y)).abs_diff_eq(wanted, 1e-6), "{x} {y}");
        }
    }

    /// The normals of a sphere are its radii; central differences of circles err by the third derivative.
    #[test]
    fn the_cap_of_a_sphere_has_the_normals_of_a_sphere() {
        const SIDE: u32 = 256;
        let radius: f64 = 1.0;
        let above = |u: f64, v: f64| (radius * radius - (u - 0.5).powi(2) - (v - 0.5).powi(2)).sqrt();
        let cap = slopes(&heights(SIDE, SIDE, above), &Placement::default());
        for (x, y) in (1..SIDE - 1).flat_map(|x| (1..SIDE - 1).map(move |y| (x, y))) {
            let middle = |texel: u32| (f64::from(texel) + 0.5) / f64::from(SIDE);
            let (u, v) = (middle(x), middle(y));
            let wanted = DVec3::new(u - 0.5, 0.5 - v, above(u, v)) / radius;
            let found = normal(&cap, 1.0, (x, y));
            assert!(found.abs_diff_eq(wanted, 1e-4), "{x} {y}: {found}, not {wanted}");
        }
    }

    #[test]
    fn beyond_an_edge_is_what_the_wrap_says() {
        let ramp = heights(4, 1, |u, _| u);
        let along = |wrap: Wrap| {
            let slopes = slopes(&ramp, &Placement { wrap: [wrap; 2], ..Placement::default() });
            let slope = |x| {
                let normal = normal(&slopes, 1.0, (x, 0));
                -normal.x / normal.z
            };
            (0..slopes.texture.width).map(|x| (slope(x) * 1024.0).round() / 1024.0).collect::<Vec<_>>()
        };
        // Over the edge of a picture that repeats it falls by what it rose.
        assert_eq!(along(Wrap::Repeat), [-1.0, 1.0, 1.0, -1.0]);
        assert_eq!(along(Wrap::Clamp), [0.5, 1.0, 1.0, 0.5]);
        assert_eq!(along(Wrap::Mirror), [0.5, 1.0, 1.0, 0.5, -0.5, -1.0, -1.0, -0.5]);
    }

    /// What a placement does to heights is what it does to slopes: those of the surface itself, by differences over a texel.
    #[test]
    fn slopes_are_those_of_the_surface_wherever_the_picture_lies() {
        let waves = |u: f64, v: f64| (0.3 * (7.0 * u).sin() + 0.2 * (5.0 * v + 3.0 * u).cos()) / 4.0;
        let picture = heights(64, 32, waves);
        for (scale, rotation) in [((1.0, 1.0), 0.0), ((2.0, 2.0), 0.0), ((1.0, 3.0), 30.0), ((-0.5, 2.0), 200.0)] {
            let scale = Vec2::new(scale.0, scale.1);
            let placement = Placement::default().transformed(scale, rotation, Vec2::new(0.1, 0.7));
            let ((lay, factor), rows) = (Lay::of(&placement), placement.transform);
            let slopes = lay.slopes("test", &picture);
            for texel in [(5, 7), (20, 20), (60, 3)] {
                let at = DVec2::new((f64::from(texel.0) + 0.5) / 64.0, (f64::from(texel.1) + 0.5) / 32.0);
                // A small step on the surface is one of the picture's coordinates by the linear part.
                let height = |step: DVec2| {
                    let moved = rows.map(|[a, b, _]| f64::from(a) * step.x + f64::from(b) * step.y);
                    waves(at.x + moved[0], at.y + moved[1])
                };
                let rise = |step: DVec2| (height(step) - height(-step)) / 2e-4;
                let wanted = DVec3::new(-rise(DVec2::X * 1e-4), rise(DVec2::Y * 1e-4), 1.0).normalize();
                let found = normal(&slopes, factor, texel);
                assert!(found.abs_diff_eq(wanted, 0.02), "{scale} {rotation} {texel:?}: {found}, not {wanted}");
            }
        }
    }

    #[test]
    fn placements_that_differ_by_a_factor_share_their_slopes_and_mirrors_become_twice_as_wide() {
        let of = |scale: f32| Placement::default().transformed(Vec2::splat(scale), 0.0, Vec2::new(scale, 0.0));
        assert_eq!((Lay::of(&of(1.0)), Lay::of(&of(7.0)).1), ((Lay::of(&of(7.0)).0, 1.0), 7.0));
        let mirrored = Placement { wrap: [Wrap::Mirror, Wrap::Clamp], ..of(3.0) };
        assert_eq!(Lay::of(&mirrored).0.size(5, 5), (10, 5));
        let placed = Lay::placed(mirrored);
        assert_eq!(placed.transform, [[1.5, 0.0, 1.5], [0.0, 3.0, 0.0]]);
        assert_eq!(placed.wrap, [Wrap::Repeat, Wrap::Clamp]);
    }

    #[test]
    fn heights_of_any_size_have_shares_and_a_finite_slope() {
        let values = vec![f32::MAX, -f32::MAX, 0.0, 1e-45];
        let slopes = slopes(&Heights { width: 4, height: 1, values }, &Placement::default());
        assert!(slopes.steepest.is_finite() && slopes.texture.check().is_ok());
    }
}
