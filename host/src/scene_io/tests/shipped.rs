//! The scenes that the project ships.

use std::path::Path;

use crate::scene::{Light, Scene};
use crate::scene_io::load;

fn shipped(name: &str) -> Scene {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let (scene, warnings) = load(&folder.join(name)).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    scene
}

#[test]
fn every_scene_loads_without_a_warning_and_is_small_enough_for_slow_devices() {
    for name in ["cornell.toml", "whitted.toml", "glass.toml", "lights.toml"] {
        let scene = shipped(name);
        assert!(scene.mesh.triangles.len() < 50_000, "{name}");
        assert!(scene.cameras.len() >= 3, "{name}");
    }
    let gallery = [
        "metal.toml",
        "frosted.toml",
        "dusk.toml",
        "room.toml",
        "subdivision.toml",
        "media.toml",
        "finishes.toml",
        "spectrum.toml",
        "hills.toml",
        "strands.toml",
        "caustics.toml",
        "chess.glb",
    ];
    for name in ["cornell_path.toml", "soft_shadows.toml", "bleeding.toml", "occlusion.toml"].into_iter().chain(gallery)
    {
        assert!(shipped(name).settings.transport.integrator.samples(), "{name}");
    }
}

#[test]
fn the_meshes_load_by_themselves() {
    assert_eq!(shipped("prism.obj").mesh.triangles.len(), 8);
    assert_eq!(shipped("rod.obj").mesh.triangles.len(), 48 * 2 + 46 * 2);
}

#[test]
fn the_lights_are_many_and_of_every_kind() {
    let lights = shipped("lights.toml").lights;
    assert!(lights.len() >= 24);
    let count = |kind: fn(&Light) -> bool| lights.iter().filter(|light| kind(light)).count();
    assert_eq!(count(|light| matches!(light, Light::Point { .. })), 6);
    assert_eq!(count(|light| matches!(light, Light::Directional { .. })), 2);
}
