//! Whether a scene holds together. Kernels read through its numbers without checking them again.

use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::film::Film;
use crate::scene::{Mesh, Scene, Settings};

/// Refuses numbers that name what there is not. Scenes of files have none; those that code makes may.
///
/// # Errors
/// The first of them.
pub fn scene(scene: &Scene) -> Result<()> {
    mesh(&scene.mesh, scene.materials.len())
}

fn mesh(mesh: &Mesh, materials: usize) -> Result<()> {
    let (triangles, vertices) = (mesh.triangles.len(), mesh.positions.len());
    if mesh.materials.len() != triangles {
        let own = mesh.materials.len();
        return Err(Error::new(format!(
            "the mesh has {triangles} triangles and {own} materials of them: give each one"
        )));
    }
    if !mesh.normals.is_empty() && mesh.normals.len() != vertices {
        let own = mesh.normals.len();
        return Err(Error::new(format!("the mesh has {vertices} vertices and {own} normals: give each one, or none")));
    }
    let corners = mesh.triangles.par_iter().zip(&mesh.materials).enumerate();
    let fault = corners.find_map_first(|(triangle, (corners, &material))| {
        if let Some(vertex) = corners.iter().find(|&&vertex| vertex as usize >= vertices) {
            return Some(format!("triangle {triangle} has vertex {vertex}, but there are {vertices}"));
        }
        let is_there = (material as usize) < materials;
        (!is_there).then(|| format!("triangle {triangle} has material {material}, but there are {materials}"))
    });
    fault.map_or(Ok(()), |fault| Err(Error::new(fault)))
}

/// Refuses settings beyond the limits that memory is planned for.
///
/// # Errors
/// The first of them.
pub fn settings(settings: &Settings) -> Result<()> {
    let Settings { size: (width, height), samples, bounces, min_contribution, .. } = *settings;
    Film::check_size(width, height)?;
    crate::error::within("samples", &[samples], 1..=Settings::MOST_SAMPLES)?;
    crate::error::within("bounces", &[bounces], 0..=Settings::MOST_BOUNCES)?;
    crate::error::within("min_contribution", &[min_contribution], 0.0..=1.0)
}

#[cfg(test)]
mod tests {
    use eyerays_bvh::Quality;
    use glam::Vec3;

    use super::*;
    use crate::device_scene::DeviceScene;

    fn whitted() -> Scene {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/whitted.toml");
        crate::scene::load(path.as_ref()).unwrap().0
    }

    fn refusal(scene: &Scene, settings: Settings) -> Option<String> {
        let packed = DeviceScene::new(scene, settings, Quality::Fast);
        packed.err().map(|error| error.message())
    }

    /// What code makes is refused as what files hold is; kernels would read beyond their buffers.
    #[test]
    fn a_mesh_that_names_what_there_is_not_is_refused() {
        let whole = whitted();
        assert_eq!(refusal(&whole, whole.settings), None);
        let spoilt = |spoil: fn(&mut Scene)| {
            let mut scene = whole.clone();
            spoil(&mut scene);
            refusal(&scene, scene.settings).expect("accepted")
        };
        assert!(spoilt(|s| s.mesh.materials[3] = 1000).starts_with("triangle 3 has material 1000"));
        assert!(spoilt(|s| s.mesh.triangles[2][1] = u32::MAX).starts_with("triangle 2 has vertex 4294967295"));
        assert!(spoilt(|s| s.mesh.materials.truncate(1)).contains("materials of them"));
        assert!(spoilt(|s| s.mesh.normals.push(Vec3::X)).contains("normals"));
        assert!(spoilt(|s| s.materials.clear()).starts_with("triangle 0 has material"));
    }

    #[test]
    fn settings_beyond_their_limits_are_refused_when_they_are_taken_too() {
        let scene = whitted();
        let mut packed = DeviceScene::new(&scene, scene.settings, Quality::Fast).unwrap();
        for beyond in [
            Settings { size: (0, 4), ..scene.settings },
            Settings { samples: 0, ..scene.settings },
            Settings { bounces: u32::MAX, ..scene.settings },
            Settings { min_contribution: f32::NAN, ..scene.settings },
        ] {
            assert!(refusal(&scene, beyond).is_some(), "{beyond:?}");
            assert!(packed.set(beyond).is_err(), "{beyond:?}");
        }
        assert_eq!(*packed.settings(), scene.settings);
    }
}
