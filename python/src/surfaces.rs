//! The surfaces of a scene, which Python asks with arrays of rays.

use std::path::PathBuf;
use std::sync::OnceLock;

use eyerays::error::Result;
use eyerays::gpu::Gpu;
use eyerays::quality::Bvh;
use eyerays::queries::Queries;
use eyerays::scene::Scene;
use eyerays::scene_io;
use glam::DVec3;
use numpy::PyReadwriteArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::blocks;
use crate::error::raised;
use crate::fields::{Block, Fields};
use crate::gpu;
use crate::meshes::{self, MeshArrays};
use crate::rays::RayArrays;

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
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let rays = rays.view()?;
        let queries = py.detach(|| self.on(device, rays.count()))?;
        let mut slices = fields.slices(rays.count())?;
        blocks::each(py, (rays.count(), queries.most_rays()), progress, |block| {
            let start = block.start;
            let hits = queries.closest(block.len(), |i| rays.ray(start + i, self.offset)).map_err(raised)?;
            rays.check()?;
            let lengths = |i: usize| rays.length(start + i);
            queries.install(|| slices.tell(&Block { hits: &hits, rays: block, lengths, offset: self.offset }));
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
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let rays = rays.view()?;
        let queries = py.detach(|| self.on(device, rays.count()))?;
        let out = out.as_slice_mut().ok().filter(|out| out.len() == rays.count());
        let out = out.ok_or_else(|| PyValueError::new_err("out has gaps or another shape than the rays"))?;
        blocks::each(py, (rays.count(), queries.most_rays()), progress, |block| {
            let start = block.start;
            let met = queries.any(block.len(), |i| rays.ray(start + i, self.offset)).map_err(raised)?;
            rays.check()?;
            out[block].copy_from_slice(&met);
            Ok(())
        })
    }
}

impl Surfaces {
    fn new(scene: &Scene, offset: DVec3, quality: &str, threads: usize) -> PyResult<Surfaces> {
        let quality: Bvh = quality.parse().map_err(raised)?;
        Ok(Surfaces {
            cpu: Queries::new(scene, quality, threads).map_err(raised)?,
            gpu: OnceLock::new(),
            offset,
            triangles: scene.primitives() as usize,
            objects: scene.objects.iter().map(|object| object.name.clone()).collect(),
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
