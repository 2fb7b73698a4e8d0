//! What is told of hits, into arrays that Python has made.

use std::ops::Range;

use eyerays::batch::Hit;
use eyerays::queries::{Hits, Place};
use glam::DVec3;
use numpy::{Element, PyReadwriteArray1, PyReadwriteArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::prelude::*;

/// Floats of either precision.
#[derive(FromPyObject)]
pub enum Floats<'py> {
    /// `float32`.
    Single(PyReadwriteArray1<'py, f32>),
    /// `float64`.
    Double(PyReadwriteArray1<'py, f64>),
}

/// Numbers of triangles or objects.
#[derive(FromPyObject)]
pub enum Integers<'py> {
    /// `int32`.
    Short(PyReadwriteArray1<'py, i32>),
    /// `int64`.
    Long(PyReadwriteArray1<'py, i64>),
}

/// The arrays, contiguous and as long as there are rays; what is not asked for is `None`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Fields<'py> {
    t: Option<Floats<'py>>,
    triangle: Option<Integers<'py>>,
    object: Option<Integers<'py>>,
    uv: Option<PyReadwriteArray2<'py, f32>>,
    normal: Option<PyReadwriteArray2<'py, f32>>,
    point: Option<PyReadwriteArray2<'py, f64>>,
    error: Option<PyReadwriteArray1<'py, f32>>,
}

/// The same without Python.
pub struct Slices<'a> {
    t: (&'a mut [f32], &'a mut [f64]),
    triangle: (&'a mut [i32], &'a mut [i64]),
    object: (&'a mut [i32], &'a mut [i64]),
    uv: &'a mut [f32],
    normal: &'a mut [f32],
    point: &'a mut [f64],
    error: &'a mut [f32],
}

/// Hits of a block of rays.
pub struct Block<'a, L> {
    /// What the rays have met.
    pub hits: &'a Hits,
    /// Which rays they are.
    pub rays: Range<usize>,
    /// How long a ray's direction is, by its number in the block.
    pub lengths: L,
    /// What is added to places.
    pub offset: DVec3,
}

impl Fields<'_> {
    /// What is in them, of `count` rays.
    ///
    /// # Errors
    /// An array of another length, or one with gaps.
    pub fn slices(&mut self, count: usize) -> PyResult<Slices<'_>> {
        let Fields { t, triangle, object, uv, normal, point, error } = self;
        Ok(Slices {
            t: match t {
                Some(Floats::Single(array)) => (line(array, count)?, &mut []),
                Some(Floats::Double(array)) => (&mut [], line(array, count)?),
                None => (&mut [], &mut []),
            },
            triangle: integers(triangle, count)?,
            object: integers(object, count)?,
            uv: table(uv, 2 * count)?,
            normal: table(normal, 3 * count)?,
            point: table(point, 3 * count)?,
            error: match error {
                Some(array) => line(array, count)?,
                None => &mut [],
            },
        })
    }
}

type OfIntegers<'a> = (&'a mut [i32], &'a mut [i64]);

fn integers<'a>(array: &'a mut Option<Integers<'_>>, count: usize) -> PyResult<OfIntegers<'a>> {
    Ok(match array {
        Some(Integers::Short(array)) => (line(array, count)?, &mut []),
        Some(Integers::Long(array)) => (&mut [], line(array, count)?),
        None => (&mut [], &mut []),
    })
}

fn line<'a, T: Element>(array: &'a mut PyReadwriteArray1<'_, T>, count: usize) -> PyResult<&'a mut [T]> {
    of_length(array.as_slice_mut().ok(), count)
}

fn table<'a, T: Element>(array: &'a mut Option<PyReadwriteArray2<'_, T>>, count: usize) -> PyResult<&'a mut [T]> {
    match array {
        Some(array) => of_length(array.as_slice_mut().ok(), count),
        None => Ok(&mut []),
    }
}

fn of_length<T>(slice: Option<&mut [T]>, count: usize) -> PyResult<&mut [T]> {
    let fits = slice.filter(|slice| slice.len() == count);
    fits.ok_or_else(|| PyValueError::new_err("an array of out has gaps or another shape than the rays"))
}

impl Slices<'_> {
    /// Tells the hits of a block. Of rays that have met nothing `t` is infinite, integers are -1 and all else is NaN.
    pub fn tell<L: Fn(usize) -> f64 + Sync>(&mut self, block: &Block<'_, L>) {
        let hits = block.hits;
        let t = |i: usize| hits.hit(i).map_or(f64::INFINITY, |hit| hit.distance / (block.lengths)(i));
        let surface = |hit: &Hit| hits.surface(hit).unwrap_or_default();
        let triangle = |i: usize| hits.hit(i).map_or(-1, |hit| i64::from(surface(&hit).1));
        let object = |i: usize| hits.hit(i).map_or(-1, |hit| i64::from(surface(&hit).0));
        let place = |i: usize| hits.place(i).unwrap_or(NOWHERE);
        // What is met is not infinitely far.
        let single = |t: f64| if t.is_finite() { t.min(f32::MAX.into()) as f32 } else { f32::INFINITY };
        each(self.t.0, &block.rays, |i| single(t(i)));
        each(self.t.1, &block.rays, t);
        each(self.triangle.0, &block.rays, |i| triangle(i) as i32);
        each(self.triangle.1, &block.rays, triangle);
        each(self.object.0, &block.rays, |i| object(i) as i32);
        each(self.object.1, &block.rays, object);
        each(rows(self.uv), &block.rays, |i| hits.hit(i).map_or([f32::NAN; 2], |hit| hit.coordinates));
        each(rows(self.normal), &block.rays, |i| place(i).normal.to_array());
        each(rows(self.point), &block.rays, |i| (place(i).point + block.offset).to_array());
        each(self.error, &block.rays, |i| place(i).error as f32);
    }
}

const NOWHERE: Place = Place { point: DVec3::NAN, normal: glam::Vec3::NAN, error: f64::NAN };

fn rows<T, const N: usize>(slice: &mut [T]) -> &mut [[T; N]] {
    slice.as_chunks_mut().0
}

/// Sets the block's part of an array, unless that is empty since nobody asks for it.
fn each<T: Send>(array: &mut [T], rays: &Range<usize>, of: impl Fn(usize) -> T + Sync) {
    if let Some(part) = array.get_mut(rays.clone()) {
        part.par_iter_mut().enumerate().for_each(|(i, to)| *to = of(i));
    }
}
