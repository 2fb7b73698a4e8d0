//! What a scene gets that names no camera or no lights.

use glam::{DVec3, Vec3};

use super::{Background, Camera, Light, Mesh};

/// From the mesh to the eye: right, above and in front of it.
const THREE_QUARTER: DVec3 = DVec3::new(0.6, 0.45, 0.66);
/// Vertical field of view in degrees.
const FOV: f32 = 40.0;
/// Room around the bounding sphere.
const MARGIN: f64 = 1.05;

/// The camera that a scene gets which names none: its image, `aspect` times as wide as high, holds the mesh's
/// bounding sphere. `None` where the mesh is so large that no such place exists in single precision.
pub fn default_camera(mesh: &Mesh, aspect: f64) -> Option<Camera> {
    let (center, radius) = sphere(mesh);
    let half = f64::from(FOV).to_radians() / 2.0;
    let across = (half.tan() * aspect).atan();
    let distance = MARGIN * radius / half.min(across).sin();
    let eye = (center + THREE_QUARTER.normalize() * distance).as_vec3();
    let camera = Camera { name: "default".into(), eye, target: center.as_vec3(), up: Vec3::Y, fov: FOV };
    (eye.is_finite() && camera.target.is_finite()).then_some(camera)
}

/// A key light from above and a weaker one from the right, of no place, so that size does not matter.
pub fn lights() -> Vec<Light> {
    vec![
        Light::Directional { direction: Vec3::new(0.3, -1.0, -0.7), colour: Vec3::splat(0.8) },
        Light::Directional { direction: Vec3::new(-1.0, -0.2, -0.1), colour: Vec3::splat(0.35) },
    ]
}

/// A pale sky.
pub fn background() -> Background {
    Background::Gradient { horizon: Vec3::new(0.80, 0.85, 0.90), zenith: Vec3::new(0.35, 0.50, 0.75) }
}

/// A sphere around the mesh's vertices, never of radius zero.
fn sphere(mesh: &Mesh) -> (DVec3, f64) {
    let [low, high] = mesh.bounds().map(Vec3::as_dvec3);
    let center = (low + high) / 2.0;
    let distances = mesh.positions.iter().map(|position| position.as_dvec3().distance(center));
    let radius = distances.fold(0.0, f64::max);
    // The eye must differ from the target once both are rounded to single precision.
    let least = center.abs().max_element() * 1e-4;
    let radius = radius.max(least);
    (center, if radius > 1e-30 { radius } else { 1.0 })
}
