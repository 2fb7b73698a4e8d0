//! A scene with everything that surfaces and surroundings may have: physical materials of each kind, textures of each form, normal
//! maps, masks, blends, vertex colours, tangents that are made and a picture of the sky.

use std::sync::Arc;

use eyerays::scene::{
    Absorption, Alpha, Conductor, Environment, Map, Maps, Physical, Placement, Scene, Texels, Texture, Wall, Wrap,
};
use glam::{Vec2, Vec3, Vec4};

/// That of some shipped scene's shapes.
pub fn covered() -> Scene {
    let mut scene = crate::shipped("lights");
    let kinds = kinds();
    for (i, material) in scene.materials.iter_mut().enumerate() {
        material.physical = Some(kinds[i % kinds.len()]);
        material.maps = maps(i);
        (material.alpha, material.opacity) = match i % 3 {
            0 => (Alpha::Opaque, 1.0),
            1 => (Alpha::Mask(0.4), 0.9),
            _ => (Alpha::Blend, 0.7),
        };
    }
    // One of each opacity.
    for material in scene.materials.iter_mut().take(3) {
        material.emission = Vec3::new(0.3, 0.2, 0.1);
    }
    let mesh = &mut scene.mesh;
    mesh.coordinates[0] = mesh.positions.iter().map(|p| Vec2::new(p.x * 0.7 + p.y, p.z * 0.6 - p.y)).collect();
    mesh.coordinates[1] = mesh.positions.iter().map(|p| Vec2::new(p.y * 0.3, p.x * 0.2)).collect();
    let colour = |(i, _): (usize, &Vec3)| Vec4::new(1.0, 0.5 + 0.5 * (i % 2) as f32, 0.8, 1.0 - 0.1 * (i % 3) as f32);
    mesh.colours = mesh.positions.iter().enumerate().map(colour).collect();
    let light = |i: usize| (1 + i % 7) as f32;
    let sky = picture("sky", 16, 8, |i| Some([0.1 * light(i), 0.2 * light(i), 0.4 * light(i), 1.0]));
    scene.environment = Some(Environment { texture: sky, rotation: 30.0, scale: 0.7, visible: true });
    scene
}

/// Physical materials, one of each kind.
fn kinds() -> [Physical; 6] {
    let base = Physical { base: Vec3::new(0.9, 0.7, 0.4), roughness: 0.4, ..Physical::default() };
    let gold = Conductor { eta: Vec3::new(0.143, 0.375, 1.442), k: Vec3::new(3.983, 2.386, 1.603), metal: None };
    let absorption = Some(Absorption { colour: Vec3::new(0.6, 0.9, 0.7), distance: 0.5 });
    let glass = Physical { transmission: Vec3::splat(0.9), roughness: 0.3, absorption, ..base };
    [
        base,
        Physical { metallic: 1.0, anisotropy: 0.8, anisotropy_rotation: 20.0, ..base },
        Physical { conductor: Some(gold), roughness: 0.2, ..base },
        glass,
        Physical { wall: Wall::Interface, absorption: None, ..glass },
        Physical { roughness: 0.0, specular_weight: 0.8, specular_tint: Vec3::new(1.0, 0.8, 0.6), ..base },
    ]
}

/// Maps of a material by its number, with every way to lay them.
fn maps(number: usize) -> Maps {
    let wraps = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];
    let map = |texture: &Arc<Texture>, turn: f32| Map {
        texture: texture.clone(),
        placement: Placement {
            set: (number % 2) as u32,
            wrap: [wraps[number % 3], wraps[(number + 1) % 3]],
            nearest: number % 4 == 3,
            ..Placement::default().transformed(Vec2::new(1.5, 0.8), turn, Vec2::new(0.1, 0.2))
        },
    };
    let bytes = picture("bytes", 7, 5, |_| None);
    let floats = picture("floats", 4, 6, |i| Some([0.5, 0.1 * (i % 9) as f32, 0.9, 0.2 * (i % 6) as f32]));
    Maps {
        base: Some(map(&bytes, 15.0)),
        metallic_roughness: Some(map(&floats, 0.0)),
        normal: number.is_multiple_of(2).then(|| map(&bytes, 40.0)),
        normal_scale: 0.6,
        emission: Some(map(&floats, 5.0)),
        transmission: Some(map(&bytes, 0.0)),
        specular_tint: Some(map(&floats, 0.0)),
        anisotropy: number.is_multiple_of(3).then(|| map(&bytes, 0.0)),
        ..Maps::default()
    }
}

/// A picture whose texels are given, or bytes that look drawn at random.
fn picture(name: &str, width: u32, height: u32, light: impl Fn(usize) -> Option<[f32; 4]>) -> Arc<Texture> {
    let count = (width * height) as usize;
    let floats: Option<Vec<[f32; 4]>> = (0..count).map(&light).collect();
    let byte = |i: usize, k: usize| ((i * 97 + k * 59 + i * i * 13) % 256) as u8;
    let texels = match floats {
        Some(floats) => Texels::Floats(floats),
        None => Texels::Bytes((0..count).map(|i| [0, 1, 2, 3].map(|k| byte(i, k))).collect()),
    };
    Arc::new(Texture { name: name.into(), width, height, texels })
}
