//! Whether what moves is of its scene.

use rayon::prelude::*;

use super::{Mesh, camera, light, of_vertices};
use crate::error::{Error, Result};
use crate::scene::{Instance, Light, Motion, Pose, Scene, Shape};

/// Refuses poses that have other copies, meshes or cameras than the scene, and what is out of range.
pub(super) fn check(scene: &Scene) -> Result<()> {
    let Some(Motion { poses, cameras, lights, exposure }) = &scene.motion else { return Ok(()) };
    let most = Motion::MOST_STEPS;
    if poses.is_empty() || poses.len() > most {
        return Err(Error::new(format!("the motion has {} poses; it must have 1 to {most}", poses.len())));
    }
    if !(0.0..=1.0).contains(exposure) {
        return Err(Error::new(format!("rows are exposed for {exposure} of the shutter's time; it must be 0 to 1")));
    }
    let shapes = |pose: &Pose| pose.shapes.iter().map(|&(mesh, _)| mesh).collect::<Vec<_>>();
    let bent = shapes(&poses[0]);
    cameras.iter().try_for_each(camera).map_err(Error::new)?;
    for (number, pose) in poses.iter().enumerate() {
        let refuse = |fault: String| Error::new(format!("pose {number} of the motion {fault}"));
        if shapes(pose) != bent || !bent.is_sorted_by(|a, b| a < b) {
            return Err(refuse("gives other meshes a shape than the first, or not in their order".into()));
        }
        copies(scene, &pose.instances).map_err(&refuse)?;
        pose.shapes.iter().try_for_each(|(mesh, of)| shape(scene, *mesh as usize, of)).map_err(&refuse)?;
        let (own, others) = (cameras.len(), pose.cameras.len());
        if own != others {
            return Err(refuse(format!("has {others} cameras, but {own} move")));
        }
        pose.cameras.iter().try_for_each(camera).map_err(&refuse)?;
        self::lights(scene, lights, &pose.lights).map_err(refuse)?;
    }
    Ok(())
}

fn lights(scene: &Scene, numbers: &[u32], there: &[Light]) -> std::result::Result<(), String> {
    let is_known = |&number: &u32| (number as usize) < scene.lights.len();
    if !numbers.is_sorted_by(|a, b| a < b) || !numbers.iter().all(is_known) || numbers.len() != there.len() {
        return Err("moves other lights than the scene has, or not in their order".into());
    }
    let mut pairs = numbers.iter().zip(there).enumerate();
    let fault = pairs.find_map(|(number, (&own, there))| {
        let is_same = scene.lights[own as usize].is_as(there);
        let fault = light(number, there).err();
        (!is_same).then(|| format!("has light {number} of another kind than the scene")).or(fault)
    });
    fault.map_or(Ok(()), Err)
}

fn copies(scene: &Scene, others: &[Instance]) -> std::result::Result<(), String> {
    let own = &scene.instances;
    if own.len() != others.len() {
        return Err(format!("has {} copies of meshes, but the scene {}", others.len(), own.len()));
    }
    let fault = own.par_iter().zip(others).enumerate().find_map_first(|(number, (own, other))| {
        if own.mesh != other.mesh {
            return Some(format!("has copy {number} of mesh {}, but the scene of {}", other.mesh, own.mesh));
        }
        let is_finite = other.rows.iter().chain([&other.translation]).all(|row| row.is_finite());
        (!is_finite).then(|| format!("has copy {number} with a transform that is not finite: move it"))
    });
    fault.map_or(Ok(()), Err)
}

fn shape(scene: &Scene, mesh: usize, of: &Shape) -> std::result::Result<(), String> {
    let Some(shared) = scene.shared.get(mesh) else {
        return Err(format!("gives mesh {mesh} a shape, but there are {}", scene.shared.len()));
    };
    let vertices = shared.vertices.len();
    let count = |all: &[_]| if all.is_empty() { 0 } else { vertices };
    let wanted = [vertices, count(&scene.mesh.normals), if scene.mesh.tangents.is_empty() { 0 } else { vertices }];
    if wanted != [of.positions.len(), of.normals.len(), of.tangents.len()] {
        return Err(format!(
            "gives mesh {mesh} a shape of other vertices: give it {vertices}, and normals and tangents as the scene's"
        ));
    }
    let bare = Mesh { positions: of.positions.clone(), normals: of.normals.clone(), ..Mesh::default() };
    of_vertices(&bare).map_err(|fault| format!("has mesh {mesh}, of which {}", fault.message()))
}
