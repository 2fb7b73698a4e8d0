//! Arrays that grow with what is found.

use std::collections::TryReserveError;

use numpy::{Element, IntoPyArray, PyArray2, PyArrayMethods};
use pyo3::exceptions::{PyMemoryError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::told::Column;

/// A field's rows.
enum Field {
    T(Vec<f32>),
    Triangle(Vec<i32>),
    Object(Vec<i32>),
    Uv(Vec<[f32; 2]>),
    Normal(Vec<[f32; 3]>),
    Point(Vec<[f64; 3]>),
    Error(Vec<f32>),
}

/// The fields that are asked for.
pub struct Table(Vec<(String, Field)>);

impl Table {
    /// Without a row.
    ///
    /// # Errors
    /// A name that no field has.
    pub fn new(names: &[String]) -> PyResult<Table> {
        let field = |name: &String| {
            let field = match name.as_str() {
                "t" => Field::T(Vec::new()),
                "triangle" => Field::Triangle(Vec::new()),
                "object" => Field::Object(Vec::new()),
                "uv" => Field::Uv(Vec::new()),
                "normal" => Field::Normal(Vec::new()),
                "point" => Field::Point(Vec::new()),
                "error" => Field::Error(Vec::new()),
                _ => return Err(PyValueError::new_err(format!("a hit has no {name:?}"))),
            };
            Ok((name.clone(), field))
        };
        names.iter().map(field).collect::<PyResult<_>>().map(Table)
    }

    /// So many rows more, to be filled.
    ///
    /// # Errors
    /// If there is not enough memory.
    pub fn grown(&mut self, count: usize) -> PyResult<Vec<Column<'_>>> {
        fn more<T: Copy + Default>(rows: &mut Vec<T>, count: usize) -> Result<&mut [T], TryReserveError> {
            let start = rows.len();
            rows.try_reserve(count)?;
            rows.resize(start + count, T::default());
            Ok(&mut rows[start..])
        }
        let grown = self.0.iter_mut().map(|(_, field)| match field {
            Field::T(rows) => more(rows, count).map(Column::T),
            Field::Triangle(rows) => more(rows, count).map(Column::Triangle),
            Field::Object(rows) => more(rows, count).map(Column::Object),
            Field::Uv(rows) => more(rows, count).map(Column::Uv),
            Field::Normal(rows) => more(rows, count).map(Column::Normal),
            Field::Point(rows) => more(rows, count).map(Column::Point),
            Field::Error(rows) => more(rows, count).map(Column::Error),
        });
        let grown = grown.collect::<Result<_, _>>();
        grown
            .map_err(|_| PyMemoryError::new_err("there is not enough memory for all crossings; ask fewer rays at once"))
    }

    /// The arrays by their names.
    ///
    /// # Errors
    /// What Python raises.
    pub fn finish(self, py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let arrays = PyDict::new(py);
        for (name, field) in self.0 {
            match field {
                Field::T(rows) | Field::Error(rows) => arrays.set_item(name, rows.into_pyarray(py))?,
                Field::Triangle(rows) | Field::Object(rows) => arrays.set_item(name, rows.into_pyarray(py))?,
                Field::Uv(rows) => arrays.set_item(name, matrix(py, rows)?)?,
                Field::Normal(rows) => arrays.set_item(name, matrix(py, rows)?)?,
                Field::Point(rows) => arrays.set_item(name, matrix(py, rows)?)?,
            }
        }
        Ok(arrays)
    }
}

fn matrix<T: Element, const N: usize>(py: Python<'_>, rows: Vec<[T; N]>) -> PyResult<Bound<'_, PyArray2<T>>> {
    let count = rows.len();
    rows.into_flattened().into_pyarray(py).reshape([count, N])
}
