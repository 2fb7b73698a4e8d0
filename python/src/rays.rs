//! Rays as Python gives them.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use eyerays::batch::{Ray, RayBlock, Rays};
use glam::DVec3;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::{Numbers, NumbersView, Rows, RowsView};

/// Where rays start, where they go, and how many lengths of that they go at most.
#[derive(FromPyObject)]
pub struct RayArrays<'py>(Rows<'py>, Rows<'py>, Numbers<'py>);

impl RayArrays<'_> {
    /// What is in them, moved by minus `offset`.
    ///
    /// # Errors
    /// Arrays of other shapes.
    pub fn view(&self, offset: DVec3) -> PyResult<RaysView<'_>> {
        let RayArrays(origins, directions, tmax) = self;
        let (origins, directions) = (origins.view("origins")?, directions.view("directions")?);
        if origins.len() != directions.len() {
            let (a, b) = (origins.len(), directions.len());
            return Err(PyValueError::new_err(format!("there are {a} origins and {b} directions")));
        }
        let tmax = tmax.view("tmax", origins.len())?;
        Ok(RaysView { origins, directions, tmax, offset, fault: AtomicUsize::new(NO_FAULT) })
    }
}

/// The same without Python, and the first of them that is none.
pub struct RaysView<'a> {
    origins: RowsView<'a>,
    directions: RowsView<'a>,
    tmax: NumbersView<'a>,
    offset: DVec3,
    fault: AtomicUsize,
}

const NO_FAULT: usize = usize::MAX;

impl Rays for RaysView<'_> {
    #[inline(always)]
    fn ray(&self, number: usize) -> Ray {
        let (origin, direction) = (self.origins.row(number) - self.offset, self.directions.row(number));
        Ray { origin, direction, tmax: self.tmax.of(number) }
    }

    /// One that is none is remembered.
    #[inline(always)]
    fn fill(&self, rays: Range<usize>, block: &mut RayBlock) {
        let (start, count) = (rays.start, rays.len());
        self.origins.fill(rays.clone(), self.offset, &mut block.origins);
        self.directions.fill(rays.clone(), DVec3::ZERO, &mut block.directions);
        self.tmax.fill(rays, &mut block.tmax);
        // Without a branch a ray, as processors like it.
        if !(0..count).fold(true, |all, row| all & is_ray(&block.ray(row))) {
            let fault = (0..count).find(|&row| !is_ray(&block.ray(row)));
            self.fault.fetch_min(fault.map_or(NO_FAULT, |row| start + row), Ordering::Relaxed);
        }
    }
}

#[inline(always)]
fn is_ray(ray: &Ray) -> bool {
    let Ray { origin, direction, tmax } = *ray;
    let is_finite = |v: DVec3| v.x.is_finite() & v.y.is_finite() & v.z.is_finite();
    let goes = (direction.x != 0.0) | (direction.y != 0.0) | (direction.z != 0.0);
    is_finite(origin) & is_finite(direction) & goes & !tmax.is_nan()
}

impl RaysView<'_> {
    /// How many there are.
    pub fn count(&self) -> usize {
        self.origins.len()
    }

    /// Refuses what was given if a ray was none that was made.
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
