//! Light of three wavelengths in the place of red, green and blue (hero wavelengths: Wilkie et al., 2014). Each sample of a pixel draws a
//! set of three, one of each third of what the eye sees; what scatters and emits is told at these, and light is linear RGB again where it
//! is added to a pixel.
//!
//! A colour has the spectrum that three smooth ones make of it, which come to one everywhere (Mallett and Yuksel, Spectral Primary
//! Decomposition for Rendering with sRGB Reflectance, 2019): so spectra of filtered texels are filtered, grey is grey, and light that is
//! scattered once has the same mean as in RGB. All light is told as a share of D65's.

use crate::buffer::read;
use crate::data::{SpectrumRow, numbers};
use crate::real::{FAINT, Scalar, V3};
use glam::UVec4;

/// Three rows of three numbers, which are no vectors: naga takes a structure of those for longer than it is.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Matrix {
    a: V3<f32>,
    b: V3<f32>,
    c: V3<f32>,
}

impl Matrix {
    #[inline(always)]
    fn load(spectra: &[UVec4], first: u32, set: u32) -> Self {
        let row = |number| V3::splat(numbers(read(spectra, SpectrumRow(first + number).at(set))));
        Matrix { a: row(0), b: row(1), c: row(2) }
    }

    #[inline(always)]
    fn times<R: Scalar>(&self, v: V3<R>) -> V3<R> {
        let row = |V3 { x, y, z }: V3<f32>| V3::new(R::splat(x), R::splat(y), R::splat(z)).dot(v).flush(FAINT);
        V3::new(row(self.a), row(self.b), row(self.c))
    }
}

/// Three wavelengths of light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bands {
    /// Their number among all sets.
    set: u32,
    /// What the three smooth spectra are at each.
    of_rgb: Matrix,
    /// What light of each adds to red, green and blue.
    to_rgb: Matrix,
}

impl Bands {
    /// None: light is red, green and blue.
    #[inline(always)]
    pub fn none() -> Self {
        let zero = Matrix { a: V3::zero(), b: V3::zero(), c: V3::zero() };
        Bands { set: 0, of_rgb: zero, to_rgb: zero }
    }

    /// The set that a number means which was drawn, see [`SpectrumRow`].
    #[inline(always)]
    pub fn drawn(spectra: &[UVec4], drawn: u32) -> Self {
        let set = drawn >> SpectrumRow::DRAWN;
        Bands {
            set,
            of_rgb: Matrix::load(spectra, SpectrumRow::OF_RGB, set),
            to_rgb: Matrix::load(spectra, SpectrumRow::TO_RGB, set),
        }
    }

    /// What a colour is at each: linear RGB of light, of what reflects it, or of any coefficient.
    #[inline(always)]
    pub fn of<R: Scalar>(&self, rgb: V3<R>) -> V3<R> {
        self.of_rgb.times(rgb)
    }

    /// Linear RGB of light of these wavelengths, right in the mean of all sets. Of a single one some channel may be below zero.
    #[inline(always)]
    pub fn rgb<R: Scalar>(&self, light: V3<R>) -> V3<R> {
        self.to_rgb.times(light)
    }

    /// A row of the table.
    #[inline(always)]
    pub fn row<R: Scalar>(&self, spectra: &[UVec4], row: u32) -> V3<R> {
        V3::splat(numbers(read(spectra, SpectrumRow(row).at(self.set))))
    }
}
