//! Arrays that Python gives, as they lie in its memory.

use std::ops::Range;

use eyerays::batch::BLOCK;
use glam::{DVec3, Vec3};
use numpy::PyReadonlyArray1;
use numpy::PyReadonlyArray2;
use numpy::PyUntypedArrayMethods;
use numpy::ndarray::{ArrayView1, ArrayView2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Rows of three numbers, of any strides.
#[derive(FromPyObject)]
pub enum Rows<'py> {
    /// Of `float32`.
    Single(PyReadonlyArray2<'py, f32>),
    /// Of `float64`.
    Double(PyReadonlyArray2<'py, f64>),
}

/// The same without Python.
#[derive(Clone, Copy)]
pub enum RowsView<'a> {
    /// Of `f32`, one after the other.
    Singles(&'a [[f32; 3]]),
    /// Of `f64`, likewise.
    Doubles(&'a [[f64; 3]]),
    /// Of `f32`.
    Single(ArrayView2<'a, f32>),
    /// Of `f64`.
    Double(ArrayView2<'a, f64>),
}

impl Rows<'_> {
    /// What is in them.
    ///
    /// # Errors
    /// Rows of another length.
    pub fn view(&self, name: &str) -> PyResult<RowsView<'_>> {
        let shape = match self {
            Rows::Single(array) => array.shape(),
            Rows::Double(array) => array.shape(),
        };
        if shape[1] != 3 {
            return Err(PyValueError::new_err(format!("{name} has rows of {} numbers, not of three", shape[1])));
        }
        // `as_slice` gives Fortran's order, too, which has columns one after the other.
        Ok(match self {
            Rows::Single(array) => match array.as_slice() {
                Ok(all) if array.is_c_contiguous() => RowsView::Singles(all.as_chunks().0),
                _ => RowsView::Single(array.as_array()),
            },
            Rows::Double(array) => match array.as_slice() {
                Ok(all) if array.is_c_contiguous() => RowsView::Doubles(all.as_chunks().0),
                _ => RowsView::Double(array.as_array()),
            },
        })
    }
}

impl RowsView<'_> {
    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            RowsView::Singles(rows) => rows.len(),
            RowsView::Doubles(rows) => rows.len(),
            RowsView::Single(rows) => rows.nrows(),
            RowsView::Double(rows) => rows.nrows(),
        }
    }

    /// Row `i`.
    #[inline(always)]
    pub fn row(&self, i: usize) -> DVec3 {
        match self {
            RowsView::Singles(rows) => Vec3::from(rows[i]).as_dvec3(),
            RowsView::Doubles(rows) => DVec3::from(rows[i]),
            RowsView::Single(rows) => DVec3::new(rows[[i, 0]].into(), rows[[i, 1]].into(), rows[[i, 2]].into()),
            RowsView::Double(rows) => DVec3::new(rows[[i, 0]], rows[[i, 1]], rows[[i, 2]]),
        }
    }

    /// Some rows, less `offset`, an axis a column.
    #[inline(always)]
    pub fn fill(&self, range: Range<usize>, offset: DVec3, columns: &mut [[f64; BLOCK]; 3]) {
        match self {
            RowsView::Singles(rows) => fill(rows[range].iter().map(|row| row.map(f64::from)), offset, columns),
            RowsView::Doubles(rows) => fill(rows[range].iter().copied(), offset, columns),
            _ => fill(range.map(|i| self.row(i).to_array()), offset, columns),
        }
    }

    /// All rows.
    pub fn iter(&self) -> impl Iterator<Item = DVec3> + '_ {
        (0..self.len()).map(|i| self.row(i))
    }
}

#[inline(always)]
fn fill(rows: impl Iterator<Item = [f64; 3]>, offset: DVec3, columns: &mut [[f64; BLOCK]; 3]) {
    let [xs, ys, zs] = columns;
    for (((row, x), y), z) in rows.zip(xs).zip(ys).zip(zs) {
        (*x, *y, *z) = (row[0] - offset.x, row[1] - offset.y, row[2] - offset.z);
    }
}

/// A number for each ray, or one for all.
#[derive(FromPyObject)]
pub enum Numbers<'py> {
    /// One for all.
    One(f64),
    /// One each.
    Each(PyReadonlyArray1<'py, f64>),
}

/// The same without Python.
#[derive(Clone, Copy)]
pub enum NumbersView<'a> {
    /// One for all.
    One(f64),
    /// One each.
    Each(ArrayView1<'a, f64>),
}

impl Numbers<'_> {
    /// What they are for so many rays.
    ///
    /// # Errors
    /// Another number of them.
    pub fn view(&self, name: &str, count: usize) -> PyResult<NumbersView<'_>> {
        match self {
            Numbers::One(number) => Ok(NumbersView::One(*number)),
            Numbers::Each(array) if array.len() == count => Ok(NumbersView::Each(array.as_array())),
            Numbers::Each(array) => {
                Err(PyValueError::new_err(format!("{name} has {} numbers for {count} rays", array.len())))
            }
        }
    }
}

impl NumbersView<'_> {
    /// Those of some rays.
    #[inline(always)]
    pub fn fill(&self, range: Range<usize>, column: &mut [f64; BLOCK]) {
        column.iter_mut().zip(range).for_each(|(to, i)| *to = self.of(i));
    }

    /// That of ray `i`.
    #[inline]
    pub fn of(&self, i: usize) -> f64 {
        match self {
            NumbersView::One(number) => *number,
            NumbersView::Each(numbers) => numbers[i],
        }
    }
}
