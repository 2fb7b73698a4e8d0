//! A picture of light from far away, by the angles of a sphere, and which of its directions a vertex samples (Pharr, Jakob and
//! Humphreys, Physically Based Rendering, 4th edition, 12.5).
//!
//! A row is chosen by its power and a column by the power of its texel, from tables of whole numbers, so that a direction is as
//! likely as its density says to the last bit; within the texel every direction is as likely. No function of an angle is as
//! inexact near the poles as its texels are small there: a row's height is counted from the nearer pole.

use super::emitter::{Density, EmitterSample, on_circle};
use crate::buffer::read;
use crate::real::{FAINT, Real, SMALL, Scalar, TINY, V3, turns};
use crate::texture::beyond;

/// An environment in device memory: a header, linear RGB of each texel in single precision, row by row from the top; for each row
/// the last draw that means it; for each texel the last draw that means it in its row; and one less the cosine of the polar angle
/// of each edge between rows, down to the middle.
#[derive(Clone, Copy)]
pub struct Environment<'a> {
    words: &'a [u32],
    width: u32,
    height: u32,
}

/// The words of the header: width and height in texels, the bits of the cosine and of the sine of the angle by which the picture is
/// turned around the second axis, 1 if the camera sees it, and zeros.
pub const HEADER: u32 = 8;

impl<'a> Environment<'a> {
    /// By its words.
    #[inline(always)]
    pub fn new(words: &'a [u32]) -> Self {
        Environment { words, width: read(words, 0), height: read(words, 1) }
    }

    /// Does the camera see it?
    #[inline(always)]
    pub fn is_visible(&self) -> bool {
        read(self.words, 4) != 0
    }

    #[inline(always)]
    fn number<R: Real>(&self, word: u32) -> R {
        R::splat(f32::from_bits(read(self.words, word)))
    }

    #[inline(always)]
    fn texel<R: Real>(&self, column: u32, row: u32) -> V3<R> {
        let word = HEADER + 3 * (row * self.width + column);
        V3::new(self.number(word), self.number(word + 1), self.number(word + 2))
    }

    #[inline(always)]
    fn rows(&self) -> u32 {
        HEADER + 3 * self.width * self.height
    }

    #[inline(always)]
    fn columns(&self, row: u32) -> u32 {
        self.rows() + self.height + row * self.width
    }

    /// One less the cosine of the polar angle of the edge above a row, from the nearer pole.
    #[inline(always)]
    fn edge<R: Real>(&self, edge: u32) -> R {
        self.number(self.columns(self.height) + edge)
    }

    /// The first of `count` numbers from `first` on that a draw is not above, with the numbers before it and its own.
    #[inline(always)]
    fn drawn(&self, first: u32, count: u32, drawn: u32) -> Drawn {
        let (mut low, mut high) = (0, count - 1);
        while low < high {
            let middle = (low + high) >> 1;
            if read(self.words, first + middle) < drawn {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        self.entry(first, low, drawn)
    }

    /// An entry of a table, with a draw that means it.
    #[inline(always)]
    fn entry(&self, first: u32, index: u32, drawn: u32) -> Drawn {
        let before = if index == 0 { 0 } else { read(self.words, first + index - 1).wrapping_add(1) };
        Drawn { index, over: drawn.wrapping_sub(before), steps: read(self.words, first + index).wrapping_sub(before) }
    }

    /// A direction of the world in the picture's frame, or with a sine of the other sign back.
    #[inline(always)]
    fn turned<R: Scalar>(&self, v: V3<R>, back: bool) -> V3<R> {
        let (cosine, sine): (R, R) = (self.number(2), self.number(3));
        let sine = if back { -sine } else { sine };
        let turned = |a: R, b: R| ((a * cosine).flush(TINY) + (b * sine).flush(TINY)).flush(TINY);
        V3::new(turned(v.x, v.z), v.y, turned(v.z, -v.x))
    }

    /// Where a unit direction lies, in texels from the left and the upper edge. The middle of the picture is seen along the first
    /// axis, what is right of it along the third, its upper half along the second.
    #[inline(always)]
    fn place<R: Scalar>(&self, direction: V3<R>) -> (R, R) {
        let d = self.turned(direction, false).map(|c| c.flush(SMALL));
        let across = (d.x * d.x + d.z * d.z).sqrt();
        let azimuth = turns::atan2(d.z.to_f32(), d.x.to_f32()) + 0.5;
        let polar = turns::atan2(across.to_f32(), d.y.to_f32());
        (R::splat(azimuth * self.width as f32), R::splat((polar + polar) * self.height as f32))
    }

    /// Radiance from a unit direction, linear RGB: of the four texels around.
    #[inline(always)]
    pub fn radiance<R: Scalar>(&self, direction: V3<R>) -> V3<R> {
        let (x, y) = self.place(direction);
        let half = R::splat(0.5);
        let (x, y) = (x - half, y - half);
        let (column, row) = (x.floor_index(), y.floor_index());
        let (right, down) = (beyond(x, column), beyond(y, row));
        let (left, beside) = (around(column, self.width), around(column + 1, self.width));
        let (upper, lower) = (within(row, self.height), within(row + 1, self.height));
        let above = self.texel::<R>(left, upper).mix(self.texel(beside, upper), right);
        let below = self.texel::<R>(left, lower).mix(self.texel(beside, lower), right);
        above.mix(below, down).map(|c| c.flush(FAINT))
    }

    /// The solid angle of a texel of a row.
    #[inline(always)]
    fn solid_angle<R: Scalar>(&self, row: u32) -> R {
        let (upper, _) = self.beside_pole(row);
        let height: R = self.edge::<R>(upper + 1) - self.edge(upper);
        height * R::splat(core::f32::consts::TAU).over(R::splat(self.width as f32))
    }

    /// A row by its number from the nearer pole, and whether that is the lower one.
    #[inline(always)]
    fn beside_pole(&self, row: u32) -> (u32, bool) {
        let mirrored = self.height - 1 - row;
        if row <= mirrored { (row, false) } else { (mirrored, true) }
    }

    /// The density with which a unit direction is sampled where `probability` is that of the whole environment.
    #[inline(always)]
    pub fn density<R: Scalar>(&self, direction: V3<R>, probability: R) -> Density<R> {
        let (x, y) = self.place(direction);
        let (column, row) = (within(x.floor_index(), self.width), within(y.floor_index(), self.height));
        let (of_row, of_column) = (self.entry(self.rows(), row, 0), self.entry(self.columns(row), column, 0));
        self.likely(of_row, of_column, probability)
    }

    #[inline(always)]
    fn likely<R: Scalar>(&self, row: Drawn, column: Drawn, probability: R) -> Density<R> {
        let both = row.probability::<R>() * column.probability::<R>();
        Density { over: (both * probability).flush(FAINT), under: self.solid_angle(row.index) }
    }

    /// A direction by two draws: the row is chosen by the second and the column by the first.
    #[inline(always)]
    pub fn sample<R: Scalar>(&self, (across, down): (u32, u32), probability: R) -> EmitterSample<R> {
        let row = self.drawn(self.rows(), self.height, down);
        let column = self.drawn(self.columns(row.index), self.width, across);
        let (pole, is_lower) = self.beside_pole(row.index);
        let (near, far): (R, R) = (self.edge(pole), self.edge(pole + 1));
        let (one, share) = (R::splat(1.0), row.share::<R>());
        let share = if is_lower { one - share } else { share };
        let height = (near + (far - near) * share).flush(SMALL);
        let sine = (height * (one + one - height)).max(R::splat(0.0)).sqrt();
        let up = if is_lower { height - one } else { one - height };
        // In steps of 2^-24 of a turn, of which the cosine knows 2^-26.
        let turn = (R::splat(column.index as f32) + column.share::<R>()).div(R::splat(self.width as f32));
        let steps = (turn * R::splat((1 << 23) as f32)).floor_index() as u32;
        let (x, z) = on_circle::<R>((steps << 9).wrapping_add(1 << 31));
        // The angle is from the middle of the picture.
        let local = V3::new((x * sine).flush(TINY), up, (z * sine).flush(TINY)).map(|c| c.flush(TINY));
        let direction = self.turned(local, true).direction_and_length().0;
        let density = self.likely(row, column, probability);
        let light = density.share_of(self.radiance(direction));
        EmitterSample { direction, limit: R::splat(f32::MAX), light, density, group: 0 }
    }
}

/// A column by an index that may be one beside the picture.
#[inline(always)]
fn around(index: i32, width: u32) -> u32 {
    let width = width as i32;
    let index = if index < 0 {
        index + width
    } else if index >= width {
        index - width
    } else {
        index
    };
    index as u32
}

/// The nearest row or column of a picture.
#[inline(always)]
fn within(index: i32, count: u32) -> u32 {
    index.max(0).min(count as i32 - 1) as u32
}

/// An entry of a table of draws.
#[derive(Clone, Copy)]
struct Drawn {
    index: u32,
    /// How many draws that mean it are before the drawn one.
    over: u32,
    /// How many mean it, less one.
    steps: u32,
}

impl Drawn {
    /// Digits that single precision does not hold.
    #[inline(always)]
    fn shift(&self) -> u32 {
        (32 - self.steps.leading_zeros()).max(24) - 24
    }

    /// How far the drawn one is among those that mean it, in [0, 1).
    #[inline(always)]
    fn share<R: Scalar>(&self) -> R {
        let shift = self.shift();
        // Whole numbers of 24 bits and one more, which every device converts exactly.
        let (over, all) = ((self.over >> shift) as f32, ((self.steps >> shift) + 1) as f32);
        R::splat(over).over(R::splat(all)).min(R::splat(MOST))
    }

    /// How likely it is.
    #[inline(always)]
    fn probability<R: Scalar>(&self) -> R {
        const STEP: f32 = 1.0 / (1u64 << 32) as f32;
        let shift = self.shift();
        let all = R::splat(((self.steps >> shift) + 1) as f32) * R::splat((1u32 << shift) as f32);
        all * R::splat(STEP)
    }
}

/// The greatest number below one.
const MOST: f32 = 1.0 - 1.0 / (1 << 24) as f32;

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::{PI, TAU};
    use glam::Vec3;

    /// The words of a picture of 8 x 4 texels, of which only the header counts.
    fn turned(degrees: f64) -> [u32; 8] {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        [8, 4, (cosine as f32).to_bits(), (sine as f32).to_bits(), 1, 0, 0, 0]
    }

    /// As three.js has it: `u = atan(z, x) / 2 pi + 1/2` and, from below, `v = asin(y) / pi + 1/2`. Blender's is the same.
    #[test]
    fn a_direction_lies_where_others_have_it_in_pictures_of_all_directions() {
        let words = turned(0.0);
        let environment = Environment::new(&words);
        for d in [Vec3::X, Vec3::Z, Vec3::NEG_Z, Vec3::new(0.3, 0.9, 0.2), Vec3::new(-0.6, -0.4, 0.1)] {
            let d = V3::<f64>::splat(d).normalised().0;
            let (x, y) = environment.place(d);
            let (u, v) = (d.z.atan2(d.x) / TAU + 0.5, d.y.asin() / PI + 0.5);
            assert!((x - 8.0 * u).abs() < 1e-5 && (y - 4.0 * (1.0 - v)).abs() < 1e-5, "{d:?}: {x}, {y}");
        }
        assert_eq!(environment.place(V3::<f64>::splat(Vec3::X)), (4.0, 2.0), "the middle is along x");
        let words = turned(90.0);
        let (x, y) = Environment::new(&words).place(V3::<f64>::splat(Vec3::Z));
        assert!((x - 4.0).abs() < 1e-5 && (y - 2.0).abs() < 1e-5, "turned from x to z: {x}, {y}");
    }
}
