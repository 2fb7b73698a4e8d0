//! A scene of the meshes that Python gives.

use eyerays::error::Error;
use eyerays::scene::{Instance, Material, Mesh, Object, Primitives, Scene, SharedMesh, Visibility};
use glam::{DVec3, Vec3};
use numpy::ndarray::ArrayView3;
use numpy::{PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::{Rows, RowsView};
use crate::error::raised;

/// Vertices, triangles by their vertices, and where copies stand: matrices of four rows and columns. Without these it stands where it is.
#[derive(FromPyObject)]
pub struct MeshArrays<'py>(Rows<'py>, PyReadonlyArray2<'py, u32>, Option<PyReadonlyArray3<'py, f64>>);

/// The scene, of one object a mesh or a copy in their order, moved by minus `offset`.
///
/// # Errors
/// Triangles of vertices that there are not, arrays of other shapes, more than a scene holds.
pub fn scene(meshes: &[MeshArrays<'_>], offset: DVec3) -> PyResult<Scene> {
    let mut parts = Parts::default();
    for (number, MeshArrays(vertices, faces, copies)) in meshes.iter().enumerate() {
        let vertices = vertices.view("vertices")?;
        // Copies are of a mesh around its own middle, which loses least where it stands far away from zero.
        let middle = if copies.is_some() { middle(&vertices) } else { offset };
        let of = if copies.is_some() { &mut parts.shared } else { &mut parts.own };
        let range = append(of, positions(&vertices, middle), faces).map_err(|fault| fault.of(number))?;
        match copies {
            None => parts.objects.push(Primitives::Triangles(range.1)),
            Some(matrices) => parts.copy(range, matrices.as_array(), (middle, offset)),
        }
    }
    Ok(parts.finish())
}

/// What is wrong with a mesh.
struct Fault(String);

impl Fault {
    fn of(self, number: usize) -> PyErr {
        PyValueError::new_err(format!("mesh {number}: {}", self.0))
    }
}

/// Vertices and triangles.
type Ranges = (std::ops::Range<usize>, std::ops::Range<usize>);

#[derive(Default)]
struct Parts {
    own: Mesh,
    shared: Mesh,
    ranges: Vec<Ranges>,
    instances: Vec<Instance>,
    objects: Vec<Primitives>,
}

/// The middle of a box around vertices.
fn middle(vertices: &RowsView<'_>) -> DVec3 {
    let nowhere = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (least, greatest) = vertices.iter().fold(nowhere, |(least, greatest), p| (least.min(p), greatest.max(p)));
    let middle = least + (greatest - least) * 0.5;
    if middle.is_finite() { middle } else { DVec3::ZERO }
}

fn positions(vertices: &RowsView<'_>, offset: DVec3) -> Vec<Vec3> {
    vertices.iter().map(|place| (place - offset).as_vec3()).collect()
}

/// Adds a mesh to another, and tells its vertices and triangles there.
fn append(to: &mut Mesh, positions: Vec<Vec3>, faces: &PyReadonlyArray2<'_, u32>) -> Result<Ranges, Fault> {
    let (first, count) = (to.positions.len(), positions.len());
    if faces.shape()[1] != 3 {
        return Err(Fault(format!("faces has rows of {} numbers, not of three", faces.shape()[1])));
    }
    if u32::try_from(first + count).is_err() {
        return Err(Fault("there are more vertices than 32 bits count; divide the scene".to_owned()));
    }
    let start = to.triangles.len();
    // Vertices that no triangle has are left out: they may be anywhere.
    let mut numbers = vec![None; count];
    for (row, corners) in faces.as_array().rows().into_iter().enumerate() {
        let corners = [corners[0], corners[1], corners[2]];
        if corners.iter().any(|&vertex| vertex as usize >= count) {
            return Err(Fault(format!("faces[{row}] has a vertex that is none of the {count}")));
        }
        to.triangles.push(corners.map(|vertex| {
            *numbers[vertex as usize].get_or_insert_with(|| {
                to.positions.push(positions[vertex as usize]);
                to.positions.len() as u32 - 1
            })
        }));
    }
    to.materials.resize(to.triangles.len(), 0);
    Ok((first..to.positions.len(), start..to.triangles.len()))
}

impl Parts {
    fn copy(&mut self, range: Ranges, matrices: ArrayView3<'_, f64>, (middle, offset): (DVec3, DVec3)) {
        for matrix in matrices.outer_iter() {
            let row = |i: usize| DVec3::new(matrix[[i, 0]], matrix[[i, 1]], matrix[[i, 2]]);
            let moved = DVec3::from([0, 1, 2].map(|i| row(i).dot(middle) + matrix[[i, 3]]));
            let first = self.instances.len();
            self.instances.push(Instance {
                mesh: self.ranges.len() as u32,
                rows: [0, 1, 2].map(|i| row(i).as_vec3()),
                translation: (moved - offset).as_vec3(),
            });
            self.objects.push(Primitives::Instances(first..first + 1));
        }
        self.ranges.push(range);
    }

    /// What stands where it is comes before what is copied.
    fn finish(self) -> Scene {
        let Parts { mut own, shared, ranges, instances, objects } = self;
        let (vertex, triangle) = (own.positions.len(), own.triangles.len());
        own.positions.extend(shared.positions);
        own.triangles.extend(shared.triangles.iter().map(|corners| corners.map(|of| of + vertex as u32)));
        own.materials.resize(own.triangles.len(), 0);
        let moved = |(vertices, triangles): Ranges| SharedMesh {
            vertices: vertices.start + vertex..vertices.end + vertex,
            triangles: triangles.start + triangle..triangles.end + triangle,
        };
        let named = |primitives| Object {
            name: String::new(),
            primitives,
            bounds: [Vec3::ZERO; 2],
            visibility: Visibility::default(),
        };
        let shared = ranges.into_iter().map(moved).collect();
        let objects = objects.into_iter().map(named).collect();
        Scene { shared, instances, objects, ..Scene::of_mesh(own, Material::default()) }
    }
}

/// Refuses what no scene holds before it is read.
///
/// # Errors
/// None of the meshes has a triangle.
pub fn check(scene: &Scene) -> PyResult<()> {
    if scene.primitives() == 0 {
        return Err(raised(Error::new("the scene has no triangle; add a mesh")));
    }
    Ok(())
}
