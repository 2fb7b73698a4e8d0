//! Scenes made by code, so that a test knows every number in them.

use eyerays::scene::{Camera, Light, Material, Mesh, Projection, Scene, Settings};
use glam::{Vec3, Vec4};

/// A scene without surfaces or lights before black, seen from the origin along -z, a pixel large.
pub fn empty() -> Scene {
    Scene {
        materials: Vec::new(),
        cameras: vec![Camera::new("front", Vec3::ZERO, Vec3::NEG_Z, Projection::Perspective { fov: 1.0 })],
        settings: Settings { size: (1, 1), min_contribution: 0.0, ..Settings::default() },
        ..Scene::of_mesh(Mesh::default(), black())
    }
}

/// A material that answers to nothing.
pub fn black() -> Material {
    Material { ambient: Some(Vec3::ZERO), diffuse: Vec3::ZERO, shininess: 1.0, ..Material::default() }
}

/// Lambert's, with the same answer to ambient light.
pub fn matt(colour: Vec3) -> Material {
    Material { ambient: Some(colour), diffuse: colour, ..black() }
}

/// What has its colour in ambient light of 1 whatever else shines on it.
pub fn glowing(colour: Vec3) -> Material {
    Material { ambient: Some(colour), ..black() }
}

/// A mirror.
pub fn mirror(colour: Vec3) -> Material {
    Material { reflection: colour, ..black() }
}

/// Glass of index 1.5.
pub fn glass(colour: Vec3) -> Material {
    Material { transmission: colour, ..black() }
}

/// Adds triangles of one material.
pub fn add(scene: &mut Scene, material: Material, corners: &[Vec3], triangles: &[[u32; 3]]) {
    let mesh = &mut scene.mesh;
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(corners);
    if !mesh.normals.is_empty() {
        mesh.normals.resize(mesh.positions.len(), Vec3::ZERO);
    }
    if !mesh.tangents.is_empty() {
        mesh.tangents.resize(mesh.positions.len(), Vec4::ZERO);
    }
    mesh.triangles.extend(triangles.iter().map(|triangle| triangle.map(|corner| first + corner)));
    mesh.materials.resize(mesh.triangles.len(), scene.materials.len() as u32);
    scene.materials.push(material);
}

/// Adds a quadrilateral; its front is where its corners run counter-clockwise.
pub fn add_quad(scene: &mut Scene, material: Material, corners: [Vec3; 4]) {
    add(scene, material, &corners, &[[0, 1, 2], [0, 2, 3]]);
}

/// Adds a square of edge 2 * `half` around `centre` that faces +z.
pub fn add_wall(scene: &mut Scene, material: Material, centre: Vec3, half: f32) {
    let corner = |x: f32, y: f32| centre + Vec3::new(x * half, y * half, 0.0);
    add_quad(scene, material, [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
}

/// Adds a box along the axes, seen from outside.
pub fn add_box(scene: &mut Scene, material: Material, min: Vec3, max: Vec3) {
    let corners: Vec<Vec3> = (0..8)
        .map(|bits| {
            let side = |axis: usize| if bits >> axis & 1 == 0 { min[axis] } else { max[axis] };
            Vec3::new(side(0), side(1), side(2))
        })
        .collect();
    let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles: Vec<[u32; 3]> = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    add(scene, material, &corners, &triangles);
}

/// White light that travels along `direction` from infinitely far.
pub fn sun(direction: Vec3) -> Light {
    Light::Directional { direction, colour: Vec3::ONE, group: String::new(), illuminant: None }
}

/// White light from a place.
pub fn lamp(position: Vec3) -> Light {
    Light::Point { position, colour: Vec3::ONE, group: String::new(), illuminant: None }
}
