//! What a scene gets that names no camera or no lights.

use glam::{DVec3, Vec3};

use super::{Background, Camera, Integrator, Light, Projection, Scene, Settings};
use crate::math;

/// From the mesh to the eye: right, above and in front of it.
const THREE_QUARTER: DVec3 = DVec3::new(0.6, 0.45, 0.66);
/// Vertical field of view in degrees.
const FOV: f32 = 40.0;
/// Room around the bounding sphere.
const MARGIN: f64 = 1.05;

/// The camera that a scene gets which names none: its image, `aspect` times as wide as high, holds the surfaces'
/// bounding sphere. `None` where they are so large that no such place exists in single precision.
pub fn default_camera(scene: &Scene, aspect: f64) -> Option<Camera> {
    let (center, radius) = sphere(scene);
    let half = f64::from(FOV).to_radians() / 2.0;
    let across = math::atan(math::tan(half) * aspect);
    let distance = MARGIN * radius / math::sin(half.min(across));
    let eye = (center + THREE_QUARTER.normalize() * distance).as_vec3();
    let projection = Projection::Perspective { fov: FOV };
    let camera = Camera::new("default", eye, center.as_vec3(), projection);
    (eye.is_finite() && camera.target.is_finite()).then_some(camera)
}

/// The size of a picture so many times as wide as high: about as many pixels as one of the default size has.
pub fn size(aspect: f64) -> (u32, u32) {
    let (width, height) = Settings::default().size;
    let (width, height) = (f64::from(width) * aspect.sqrt(), f64::from(height) / aspect.sqrt());
    let side = |side: f64| side.round().clamp(1.0, f64::from(Settings::MOST_SIDE)) as u32;
    (side(width), side(height))
}

/// Takes the two lamps that a scene file without lights gets away where an integrator finds light elsewhere: paths and
/// `distributed` by what emits, paths by the background too. A pale sky is a bare mesh's, which keeps them.
pub fn without_spare_lamps(scene: &mut Scene, integrator: Integrator) {
    if scene.lights == lights() && scene.background != background() && finds_light(scene, integrator) {
        scene.lights.clear();
    }
}

/// Does an integrator find light in a scene without lights?
fn finds_light(scene: &Scene, integrator: Integrator) -> bool {
    let is_light = |colour: Vec3| colour != Vec3::ZERO;
    let sky = match scene.background {
        Background::Colour(colour) => is_light(colour),
        Background::Gradient { horizon, zenith } => is_light(horizon) || is_light(zenith),
    };
    let has_emitter = scene.materials.iter().any(|material| is_light(material.emission));
    scene.environment.is_some()
        || match integrator {
            Integrator::Path => sky || has_emitter,
            Integrator::Distributed => has_emitter,
            Integrator::Whitted | Integrator::Ao => false,
        }
}

/// A key light from above and a weaker one from the right, of no place, so that size does not matter.
pub fn lights() -> Vec<Light> {
    let light = |direction, intensity| Light::Directional {
        direction,
        colour: Vec3::splat(intensity),
        group: String::new(),
        illuminant: None,
    };
    vec![light(Vec3::new(0.3, -1.0, -0.7), 0.8), light(Vec3::new(-1.0, -0.2, -0.1), 0.35)]
}

/// A pale sky.
pub fn background() -> Background {
    Background::Gradient { horizon: Vec3::new(0.80, 0.85, 0.90), zenith: Vec3::new(0.35, 0.50, 0.75) }
}

/// A sphere around all surfaces, never of radius zero.
fn sphere(scene: &Scene) -> (DVec3, f64) {
    let [low, high] = scene.bounds().map(Vec3::as_dvec3);
    let center = (low + high) / 2.0;
    let reach = |place: Vec3, radius: f32| place.as_dvec3().distance(center) + f64::from(radius);
    let vertices = scene.mesh.positions[..scene.own_vertices()].iter().map(|&position| reach(position, 0.0));
    let spheres = scene.spheres.iter().map(|sphere| reach(sphere.center, sphere.radius));
    let disks = scene.disks.iter().map(|disk| reach(disk.center, disk.radius));
    let radius = vertices.chain(spheres).chain(disks).fold(scene.copies_reach(center), f64::max);
    // The eye must differ from the target once both are rounded to single precision: this is some sixteen of its steps.
    let least = center.abs().max_element() * 1e-6;
    let radius = radius.max(least);
    (center, if radius > 1e-30 { radius } else { 1.0 })
}
