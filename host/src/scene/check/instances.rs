//! Meshes that stand in several places.

use rayon::prelude::*;

use super::first;
use crate::error::Result;
use crate::scene::{Instance, Scene, SharedMesh};

/// Refuses shared meshes that are no parts of the scene's, copies of what there is not, and transforms that are out of range.
pub(super) fn check(scene: &Scene) -> Result<()> {
    let (mut vertex, mut triangle) = (scene.own_vertices(), scene.own_triangles());
    for (number, SharedMesh { vertices, triangles }) in scene.shared.iter().enumerate() {
        let follows = (vertices.start, triangles.start) == (vertex, triangle);
        let is_some = vertices.start < vertices.end && triangles.start < triangles.end;
        let fault = format!("shared mesh {number} has the vertices {vertices:?} and the triangles {triangles:?}");
        let fault = (!follows || !is_some).then(|| format!("{fault}: they must follow those before, and be some"));
        first(fault)?;
        (vertex, triangle) = (vertices.end, triangles.end);
    }
    let ends = (scene.mesh.positions.len(), scene.mesh.triangles.len());
    let rest = !scene.shared.is_empty() && (vertex, triangle) != ends;
    first(rest.then(|| {
        format!("the last shared mesh ends at vertex {vertex} and triangle {triangle}, the scene's mesh at {ends:?}: make both end there")
    }))?;
    parts(scene)?;
    let copies = scene.instances.par_iter().enumerate();
    first(copies.find_map_first(|(number, copy)| Some(format!("copy {number} of a mesh {}", fault(scene, copy)?))))
}

/// Refuses triangles that have vertices of another part.
fn parts(scene: &Scene) -> Result<()> {
    if scene.shared.is_empty() {
        return Ok(());
    }
    let of = |vertices: std::ops::Range<usize>, triangles: std::ops::Range<usize>| {
        let corners = scene.mesh.triangles[triangles.clone()].par_iter().zip(triangles);
        let is_odd = |corners: &[u32; 3]| corners.iter().any(|&vertex| !vertices.contains(&(vertex as usize)));
        corners.find_map_first(|(corners, number)| {
            is_odd(corners).then(|| format!("triangle {number} has vertices of another mesh: give it its own"))
        })
    };
    first(of(0..scene.own_vertices(), 0..scene.own_triangles()))?;
    for SharedMesh { vertices, triangles } in &scene.shared {
        first(of(vertices.clone(), triangles.clone()))?;
    }
    Ok(())
}

/// What is wrong with a copy.
fn fault(scene: &Scene, Instance { mesh, rows, translation }: &Instance) -> Option<String> {
    if *mesh as usize >= scene.shared.len() {
        return Some(format!("is of mesh {mesh}, but there are {}", scene.shared.len()));
    }
    let is_finite = rows.iter().chain([translation]).all(|row| row.is_finite());
    (!is_finite).then(|| "has a transform that is not finite: move it".into())
}
