//! Does a model light itself, or does it need surroundings that do?

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use crate::image::byte_to_linear;
use crate::scene::{Instance, Light, Map, Material, Scene, SharedMesh, Texels};

/// The least that white surfaces must send on the mean, where 1 is a screen's white: six stops below it.
const LEAST: f64 = 1.0 / 64.0;
/// The most texels of a picture of light that are looked at.
const MOST_TEXELS: usize = 1 << 16;

/// Do a scene's lights and what shines in it light it? They do if all their light, spread evenly over all surfaces, lets white ones
/// send 1/64 of a screen's white. Of what shines that is the mean radiance over the area of all triangles, of lights without
/// extent their irradiance at the middle of the scene over pi, no nearer than its corners.
pub fn is_lit(scene: &Scene, lights: &[Light]) -> bool {
    of_surfaces(scene) + of_lights(scene, lights) >= LEAST
}

/// The mean radiance that surfaces send by themselves.
fn of_surfaces(scene: &Scene) -> f64 {
    let shining: Vec<f64> = scene.materials.iter().map(radiance).collect();
    if shining.iter().all(|&radiance| radiance == 0.0) {
        return 0.0;
    }
    let mesh = &scene.mesh;
    let area = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|vertex| mesh.positions[vertex as usize].as_dvec3());
        (b - a).cross(c - a).length()
    };
    let (mut light, mut all) = (0.0, 0.0);
    for (corners, &material) in mesh.triangles.iter().zip(&mesh.materials).take(scene.own_triangles()) {
        light += area(corners) * shining[material as usize];
        all += area(corners);
    }
    // Copies do not shine.
    let of_mesh = |shared: &SharedMesh| mesh.triangles[shared.triangles.clone()].iter().map(area).sum();
    let areas: Vec<f64> = scene.shared.iter().map(of_mesh).collect();
    all += scene.instances.iter().map(|copy| areas[copy.mesh as usize] * square(copy)).sum::<f64>();
    if all > 0.0 { light / all } else { 0.0 }
}

/// What areas are multiplied with, in the mean of three directions.
fn square(Instance { rows, .. }: &Instance) -> f64 {
    let [x, y, z] = rows.map(Vec3::as_dvec3);
    (x.cross(y).length() + y.cross(z).length() + z.cross(x).length()) / 3.0
}

/// The irradiance in the middle by lights without extent, over pi.
fn of_lights(scene: &Scene, lights: &[Light]) -> f64 {
    let [low, high] = scene.bounds().map(Vec3::as_dvec3);
    let (middle, reach) = ((low + high) / 2.0, (high - low).length() / 2.0);
    let at = |position: Vec3, colour: Vec3| {
        let distance = position.as_dvec3().distance(middle).max(reach);
        if distance > 0.0 { brightness(colour) / (distance * distance) } else { brightness(colour) }
    };
    let irradiance = |light: &Light| match *light {
        Light::Directional { colour, .. } => brightness(colour),
        Light::Point { position, colour, .. } | Light::Spot { position, colour, .. } => at(position, colour),
    };
    lights.iter().map(irradiance).sum::<f64>() / PI
}

/// What a material sends by itself, the mean of the channels and of its picture.
fn radiance(material: &Material) -> f64 {
    let covered = material.maps.emission.as_ref().map_or(Vec3::ONE, mean);
    brightness(material.emission * covered)
}

/// The mean of some of a picture's texels, linear RGB.
fn mean(map: &Map) -> Vec3 {
    let light = |texels: &mut dyn Iterator<Item = [f32; 3]>| {
        let (sum, count) =
            texels.fold((DVec3::ZERO, 0.0), |(sum, count), texel| (sum + Vec3::from(texel).as_dvec3(), count + 1.0));
        (sum / count).as_vec3()
    };
    // No power of two, which would stay in one column.
    let step = |count: usize| if count > MOST_TEXELS { (count / MOST_TEXELS) | 1 } else { 1 };
    match &map.texture.texels {
        Texels::Bytes(bytes) => {
            let some = bytes.iter().step_by(step(bytes.len()));
            light(&mut some.map(|&[r, g, b, _]| [r, g, b].map(byte_to_linear)))
        }
        Texels::Floats(floats) => {
            let some = floats.iter().step_by(step(floats.len()));
            light(&mut some.map(|&[r, g, b, _]| [r, g, b]))
        }
    }
}

fn brightness(colour: Vec3) -> f64 {
    colour.as_dvec3().dot(DVec3::ONE) / 3.0
}
