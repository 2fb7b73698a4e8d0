//! Rays as Python gives them.

use std::sync::atomic::{AtomicUsize, Ordering};

use eyerays::batch::Ray;
use glam::DVec3;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::{Numbers, NumbersView, Rows, RowsView};

/// Where rays start, where they go, and how many lengths of that they go at most.
#[derive(FromPyObject)]
pub struct RayArrays<'py>(Rows<'py>, Rows<'py>, Numbers<'py>);

impl RayArrays<'_> {
    /// What is in them.
    ///
    /// # Errors
    /// Arrays of other shapes.
    pub fn view(&self) -> PyResult<Rays<'_>> {
        Rays::new(self)
    }
}

/// The same without Python, and the first of them that is none.
pub struct Rays<'a> {
    origins: RowsView<'a>,
    directions: RowsView<'a>,
    tmax: NumbersView<'a>,
    fault: AtomicUsize,
}

const NO_FAULT: usize = usize::MAX;

impl<'a> Rays<'a> {
    fn new(RayArrays(origins, directions, tmax): &'a RayArrays<'_>) -> PyResult<Self> {
        let (origins, directions) = (origins.view("origins")?, directions.view("directions")?);
        if origins.len() != directions.len() {
            let (a, b) = (origins.len(), directions.len());
            return Err(PyValueError::new_err(format!("there are {a} origins and {b} directions")));
        }
        let tmax = tmax.view("tmax", origins.len())?;
        Ok(Rays { origins, directions, tmax, fault: AtomicUsize::new(NO_FAULT) })
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.origins.len()
    }

    /// Ray `i`, moved by minus `offset`. One that is none is remembered.
    #[inline]
    pub fn ray(&self, i: usize, offset: DVec3) -> Ray {
        let (origin, direction, tmax) = (self.origins.row(i), self.directions.row(i), self.tmax.of(i));
        if !origin.is_finite() || !direction.is_finite() || direction == DVec3::ZERO || tmax.is_nan() {
            self.fault.fetch_min(i, Ordering::Relaxed);
        }
        Ray { origin: origin - offset, direction, tmax }
    }

    /// Refuses what was given if a ray was none that [`Rays::ray`] has made.
    ///
    /// # Errors
    /// It names the first.
    pub fn check(&self) -> PyResult<()> {
        let i = self.fault.load(Ordering::Relaxed);
        if i == NO_FAULT {
            return Ok(());
        }
        let what = if !self.origins.row(i).is_finite() {
            format!("the origin of ray {i} is not finite")
        } else if !self.directions.row(i).is_finite() {
            format!("the direction of ray {i} is not finite")
        } else if self.directions.row(i) == DVec3::ZERO {
            format!("the direction of ray {i} is zero")
        } else {
            format!("tmax of ray {i} is not a number")
        };
        Err(PyValueError::new_err(what))
    }
}

/// Points as Python gives them, and the first of them that is none.
pub struct Points<'a> {
    rows: RowsView<'a>,
    fault: AtomicUsize,
}

impl<'a> Points<'a> {
    /// Of rows.
    pub fn new(rows: RowsView<'a>) -> Self {
        Points { rows, fault: AtomicUsize::new(NO_FAULT) }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.rows.len()
    }

    /// Point `i`, moved by minus `offset`. One that is none is remembered.
    pub fn point(&self, i: usize, offset: DVec3) -> DVec3 {
        let point = self.rows.row(i);
        if !point.is_finite() {
            self.fault.fetch_min(i, Ordering::Relaxed);
        }
        point - offset
    }

    /// Refuses what was given if a point was none that [`Points::point`] has told.
    ///
    /// # Errors
    /// It names the first.
    pub fn check(&self) -> PyResult<()> {
        match self.fault.load(Ordering::Relaxed) {
            NO_FAULT => Ok(()),
            i => Err(PyValueError::new_err(format!("point {i} is not finite"))),
        }
    }
}
