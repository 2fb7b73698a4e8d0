//! The surfaces of a scene, which Python asks with arrays of rays.

use std::ops::Range;
use std::path::PathBuf;
use std::sync::OnceLock;

use eyerays::error::Result;
use eyerays::gpu::Gpu;
use eyerays::quality::Bvh;
use eyerays::queries::{Crossings, Queries};
use eyerays::scene::Scene;
use eyerays::scene_io;
use glam::DVec3;
use numpy::{IntoPyArray, PyArray1, PyReadwriteArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::Rows;
use crate::blocks;
use crate::error::{Raised, raised};
use crate::fields::{self, Fields};
use crate::gpu;
use crate::meshes::{self, MeshArrays};
use crate::rays::{Points, RayArrays, RaysView};
use crate::table::Table;
use crate::told::{Column, Columns};

/// Fewer rays are answered by a CPU before a GPU has them.
const WORTH_A_GPU: usize = 1 << 16;

/// The surfaces of a scene, ready for rays.
#[pyclass(frozen, module = "eyerays._native")]
pub struct Surfaces {
    cpu: Queries,
    gpu: OnceLock<Result<Queries>>,
    offset: DVec3,
    #[pyo3(get)]
    triangles: usize,
    #[pyo3(get)]
    objects: Vec<String>,
    /// Of places, in the scene's units.
    #[pyo3(get)]
    roundoff: f64,
}

#[pymethods]
impl Surfaces {
    /// Of meshes that are moved by minus `offset` before they are rounded to single precision.
    #[staticmethod]
    fn of_meshes(
        py: Python<'_>,
        meshes: Vec<MeshArrays<'_>>,
        offset: [f64; 3],
        quality: &str,
        threads: usize,
    ) -> PyResult<Surfaces> {
        let offset = DVec3::from(offset);
        let scene = meshes::scene(&meshes, offset)?;
        meshes::check(&scene)?;
        py.detach(|| Surfaces::new(&scene, offset, quality, threads))
    }

    /// Of a scene file, and what its warnings say.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf, quality: &str, threads: usize) -> PyResult<(Surfaces, Vec<String>)> {
        py.detach(|| {
            let (scene, warnings) = scene_io::load(&path).map_err(raised)?;
            let warnings = warnings.iter().map(ToString::to_string).collect();
            Ok((Surfaces::new(&scene, DVec3::ZERO, quality, threads)?, warnings))
        })
    }

    /// Tells what rays meet first into the arrays of `fields`.
    fn closest(
        &self,
        py: Python<'_>,
        rays: RayArrays<'_>,
        mut fields: Fields<'_>,
        device: &str,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<()> {
        let rays = rays.view(self.offset)?;
        let queries = py.detach(|| self.on(device, rays.count()))?;
        let columns = self.columns(&queries, fields.columns(rays.count())?);
        let told = py.detach(|| queries.closest_into(rays.count(), &rays, columns, &mut heard(&rays, progress)));
        told.map_err(|Raised(error)| error)
    }

    /// Tells where triangles come nearest to points into the arrays of `fields`; `t` is the distance.
    fn nearest(
        &self,
        py: Python<'_>,
        points: Rows<'_>,
        mut fields: Fields<'_>,
        device: &str,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let points = Points::new(points.view("points")?);
        let queries = py.detach(|| self.on(device, points.count()))?;
        let mut columns = self.columns(&queries, fields.columns(points.count())?);
        blocks::each(py, (points.count(), queries.most_rays()), progress, |block| {
            let start = block.start;
            let nearest = queries.nearest(block.len(), |i| points.point(start + i, self.offset)).map_err(raised)?;
            points.check()?;
            let columns = columns.rows(&block);
            queries.install(|| columns.tell(&nearest, &|of| of.map(|(hit, _)| hit), &|of| of.map(|(_, place)| place)));
            Ok(())
        })
    }

    /// All that rays cross: arrays of the fields that are named, by them, and how many crossings there are up to each ray.
    fn crossings<'py>(
        &self,
        py: Python<'py>,
        rays: RayArrays<'_>,
        names: Vec<String>,
        device: &str,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<(Bound<'py, PyDict>, Bound<'py, PyArray1<i64>>)> {
        let rays = rays.view(self.offset)?;
        let queries = py.detach(|| self.on(device, rays.count()))?;
        let mut table = Table::new(&names)?;
        let mut ends = vec![0];
        self.crossed(py, (&rays, &queries), progress, |block, crossings| {
            let mut end = ends[block.start];
            ends.extend((0..block.len()).map(|ray| {
                end += crossings.of_ray(ray).len() as i64;
                end
            }));
            let columns = self.columns(&queries, table.grown(crossings.hits().len())?);
            queries.install(|| columns.tell(crossings.hits(), &|hit| Some(*hit), &|hit| queries.place(hit)));
            Ok(())
        })?;
        Ok((table.finish(py)?, ends.into_pyarray(py)))
    }

    /// Tells into an array how many triangles each ray crosses.
    fn count(
        &self,
        py: Python<'_>,
        rays: RayArrays<'_>,
        mut out: PyReadwriteArray1<'_, i32>,
        device: &str,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let rays = rays.view(self.offset)?;
        let queries = py.detach(|| self.on(device, rays.count()))?;
        let out = fields::line(&mut out, rays.count())?;
        self.crossed(py, (&rays, &queries), progress, |block, crossings| {
            out[block].iter_mut().enumerate().for_each(|(ray, to)| *to = crossings.of_ray(ray).len() as i32);
            Ok(())
        })
    }

    /// Tells into an array of bytes whether rays meet anything.
    fn any(
        &self,
        py: Python<'_>,
        rays: RayArrays<'_>,
        mut out: PyReadwriteArray1<'_, bool>,
        device: &str,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<()> {
        let rays = rays.view(self.offset)?;
        let queries = py.detach(|| self.on(device, rays.count()))?;
        let out = fields::line(&mut out, rays.count())?;
        let told = py.detach(|| queries.any_into(rays.count(), &rays, out, &mut heard(&rays, progress)));
        told.map_err(|Raised(error)| error)
    }
}

/// Refuses rays that are none, and lets Python be heard.
fn heard<'a>(
    rays: &'a RaysView<'_>,
    progress: Option<Py<PyAny>>,
) -> impl FnMut(usize) -> std::result::Result<(), Raised> + 'a {
    move |done| {
        rays.check()?;
        Ok(blocks::heard(progress.as_ref(), (done, rays.count()))?)
    }
}

impl Surfaces {
    fn new(scene: &Scene, offset: DVec3, quality: &str, threads: usize) -> PyResult<Surfaces> {
        let quality: Bvh = quality.parse().map_err(raised)?;
        let cpu = Queries::new(scene, quality, threads).map_err(raised)?;
        Ok(Surfaces {
            roundoff: cpu.roundoff(),
            cpu,
            gpu: OnceLock::new(),
            offset,
            triangles: scene.primitives() as usize,
            objects: scene.objects.iter().map(|object| object.name.clone()).collect(),
        })
    }

    fn columns<'a>(&self, queries: &'a Queries, arrays: Vec<Column<'a>>) -> Columns<'a> {
        Columns { arrays, queries, offset: self.offset }
    }

    /// Tells what rays cross, block by block.
    fn crossed(
        &self,
        py: Python<'_>,
        (rays, queries): (&RaysView<'_>, &Queries),
        progress: Option<&Bound<'_, PyAny>>,
        mut tell: impl FnMut(Range<usize>, &Crossings) -> PyResult<()> + Send,
    ) -> PyResult<()> {
        blocks::each(py, (rays.count(), queries.most_rays()), progress, |block| {
            let crossings = queries.crossings(block.clone(), rays).map_err(raised)?;
            rays.check()?;
            tell(block, &crossings)
        })
    }

    /// The device for so many rays.
    fn on(&self, device: &str, rays: usize) -> PyResult<Queries> {
        let on = |gpu: &Gpu| self.gpu.get_or_init(|| self.cpu.on(gpu)).clone();
        match device {
            "cpu" => Ok(self.cpu.clone()),
            "gpu" => gpu::any().and_then(|gpu| on(&gpu)).map_err(raised),
            "auto" if rays < WORTH_A_GPU => Ok(self.cpu.clone()),
            // What a GPU can't hold the CPU can.
            "auto" => Ok(gpu::hardware().and_then(|gpu| on(&gpu).ok()).unwrap_or_else(|| self.cpu.clone())),
            other => Err(PyValueError::new_err(format!("device {other:?} is none of \"auto\", \"cpu\" and \"gpu\""))),
        }
    }
}
