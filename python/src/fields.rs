//! Arrays that Python has made, which are to be filled with what is told of hits.

use numpy::{Element, PyReadwriteArray1, PyReadwriteArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::told::Column;

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

impl Fields<'_> {
    /// Those that are asked for, of `count` rows each.
    ///
    /// # Errors
    /// An array of another length, or one with gaps.
    pub fn columns(&mut self, count: usize) -> PyResult<Vec<Column<'_>>> {
        let Fields { t, triangle, object, uv, normal, point, error } = self;
        let columns = [
            t.as_mut().map(|of| match of {
                Floats::Single(array) => line(array, count).map(Column::T),
                Floats::Double(array) => line(array, count).map(Column::LongT),
            }),
            triangle.as_mut().map(|of| match of {
                Integers::Short(array) => line(array, count).map(Column::Triangle),
                Integers::Long(array) => line(array, count).map(Column::LongTriangle),
            }),
            object.as_mut().map(|of| match of {
                Integers::Short(array) => line(array, count).map(Column::Object),
                Integers::Long(array) => line(array, count).map(Column::LongObject),
            }),
            uv.as_mut().map(|array| table(array, count).map(Column::Uv)),
            normal.as_mut().map(|array| table(array, count).map(Column::Normal)),
            point.as_mut().map(|array| table(array, count).map(Column::Point)),
            error.as_mut().map(|array| line(array, count).map(Column::Error)),
        ];
        columns.into_iter().flatten().collect()
    }
}

/// What is in an array of so many rows.
///
/// # Errors
/// As [`Fields::columns`].
pub fn line<'a, T: Element>(array: &'a mut PyReadwriteArray1<'_, T>, count: usize) -> PyResult<&'a mut [T]> {
    of_length(array.as_slice_mut().ok(), count)
}

fn table<'a, T: Element, const N: usize>(
    array: &'a mut PyReadwriteArray2<'_, T>,
    count: usize,
) -> PyResult<&'a mut [[T; N]]> {
    of_length(array.as_slice_mut().ok().map(|all| all.as_chunks_mut().0), count)
}

fn of_length<T>(slice: Option<&mut [T]>, count: usize) -> PyResult<&mut [T]> {
    let fits = slice.filter(|slice| slice.len() == count);
    fits.ok_or_else(|| PyValueError::new_err("an array of out has gaps or another shape than what is asked"))
}
