//! Whether a scene holds together. Kernels read through its numbers without checking them again.

use glam::Vec3;
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::film::Film;
use crate::scene::{Disk, Integrator, Mesh, Scene, Settings, Sphere};

/// Refuses numbers that name what there is not. Scenes of files have none; those that code makes may.
///
/// # Errors
/// The first of them.
pub fn scene(scene: &Scene) -> Result<()> {
    let materials = scene.materials.len();
    mesh(&scene.mesh, materials)?;
    let spheres = scene.spheres.par_iter().enumerate();
    first(spheres.find_map_first(|(number, sphere)| {
        let Sphere { center, radius, material } = *sphere;
        let fault = round(center, radius, sphere.bounds(), material, materials)?;
        Some(format!("sphere {number} has {fault}"))
    }))?;
    let disks = scene.disks.par_iter().enumerate();
    first(disks.find_map_first(|(number, disk)| {
        let Disk { center, normal, radius, material } = *disk;
        let fault = upright(normal).or_else(|| round(center, radius, disk.bounds(), material, materials))?;
        Some(format!("disk {number} has {fault}"))
    }))
}

fn first(fault: Option<String>) -> Result<()> {
    fault.map_or(Ok(()), |fault| Err(Error::new(fault)))
}

/// What is wrong with a sphere or a disk.
fn round(center: Vec3, radius: f32, bounds: [Vec3; 2], material: u32, materials: usize) -> Option<String> {
    if !center.is_finite() {
        return Some(format!("the center {center}, which is not finite: move it"));
    }
    if !(radius.is_finite() && radius > 0.0) {
        return Some(format!("the radius {radius}: make it finite and greater than 0"));
    }
    if !bounds.iter().all(|corner| corner.is_finite()) {
        return Some(format!("the radius {radius}, which leaves the range of single precision: make it smaller"));
    }
    let is_there = (material as usize) < materials;
    (!is_there).then(|| format!("material {material}, but there are {materials}"))
}

/// What is wrong with a normal.
fn upright(normal: Vec3) -> Option<String> {
    /// How far the length may be from 1, for normals that code calculates in single precision.
    const OFF: f64 = 1e-3;
    let length = normal.as_dvec3().length();
    let is_unit = (length - 1.0).abs() <= OFF;
    (!is_unit).then(|| format!("a normal of length {length}: make it 1"))
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
    first(fault)
}

/// Refuses settings beyond the limits that memory is planned for.
///
/// # Errors
/// The first of them.
pub fn settings(settings: &Settings) -> Result<()> {
    let Settings { size: (width, height), samples, spp, bounces, min_contribution, transport, .. } = *settings;
    Film::check_size(width, height)?;
    crate::error::within("samples", &[samples], 1..=Settings::MOST_SAMPLES)?;
    crate::error::within("bounces", &[bounces], 0..=Settings::MOST_BOUNCES)?;
    crate::error::within("min_contribution", &[min_contribution], 0.0..=1.0)?;
    crate::error::within("spp", &[spp], 0..=Settings::MOST_SPP)?;
    crate::error::within("clamp", &[transport.clamp], 0.0..=f32::MAX)?;
    crate::error::within("ao_distance", &[transport.ao_distance], f32::MIN_POSITIVE..=f32::INFINITY)?;
    settings.grid().map(|_| ())
}

/// Refuses to leave out light.
///
/// # Errors
/// The integrator draws no light that materials emit.
pub fn emission(emissive: Option<&str>, integrator: Integrator) -> Result<()> {
    match (emissive, integrator) {
        (Some(name), Integrator::Whitted) => Err(Error::new(format!(
            "the material {name:?} emits light, which the integrator whitted does not draw: choose path or distributed (--integrator path)"
        ))),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use eyerays_bvh::Quality;

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
        assert!(spoilt(|s| s.mesh.materials[1] = 1000).starts_with("triangle 1 has material 1000"));
        assert!(spoilt(|s| s.mesh.triangles[0][1] = u32::MAX).starts_with("triangle 0 has vertex 4294967295"));
        assert!(spoilt(|s| s.mesh.materials.truncate(1)).contains("materials of them"));
        assert!(spoilt(|s| s.mesh.normals.push(Vec3::X)).contains("normals"));
        assert!(spoilt(|s| s.materials.clear()).starts_with("triangle 0 has material"));
    }

    #[test]
    fn spheres_and_disks_that_are_none_are_refused_by_their_number() {
        let mut whole = whitted();
        let sphere = Sphere { center: Vec3::ZERO, radius: 1.0, material: 0 };
        whole.spheres = vec![sphere; 2];
        // Off by no more than single precision makes it.
        let disk = Disk { center: Vec3::ONE, normal: Vec3::new(0.6, 0.800_1, 0.0), radius: 2.0, material: 1 };
        whole.disks = vec![disk; 3];
        assert_eq!(super::scene(&whole), Ok(()));
        let spoilt = |spoil: fn(&mut Scene)| {
            let mut scene = whole.clone();
            spoil(&mut scene);
            super::scene(&scene).expect_err("accepted").message()
        };
        assert_eq!(spoilt(|s| s.spheres[1].material = 9), "sphere 1 has material 9, but there are 3");
        assert_eq!(spoilt(|s| s.disks[2].material = 9), "disk 2 has material 9, but there are 3");
        for radius in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            let mut scene = whole.clone();
            scene.spheres[0].radius = radius;
            let fault = super::scene(&scene).expect_err("accepted").message();
            assert_eq!(fault, format!("sphere 0 has the radius {radius}: make it finite and greater than 0"));
        }
        assert!(spoilt(|s| (s.spheres[0].center.x, s.spheres[0].radius) = (3e38, 1e38)).contains("leaves the range"));
        assert!(spoilt(|s| s.spheres[1].center.y = f32::NAN).starts_with("sphere 1 has the center [0, NaN, 0]"));
        assert!(spoilt(|s| s.disks[0].radius = -1.0).starts_with("disk 0 has the radius -1"));
        for normal in [Vec3::ZERO, Vec3::splat(0.5), Vec3::NAN, Vec3::INFINITY, Vec3::Y * 1.01] {
            let mut scene = whole.clone();
            scene.disks[1].normal = normal;
            let fault = super::scene(&scene).expect_err("accepted").message();
            assert!(fault.starts_with("disk 1 has a normal of length "), "{fault}");
        }
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
