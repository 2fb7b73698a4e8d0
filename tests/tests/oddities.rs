//! Scenes that are legal and odd: light that pictures take away, coordinates that no mesh has, tangents that some meshes have.

use std::sync::Arc;

use eyerays::picture::Picture;
use eyerays::scene::{Integrator, Map, Physical, Placement, Scene, Settings, Texels, Texture, Transport};
use eyerays_shader::data::Effects;
use eyerays_tests::{on_cpu, pack, shipped};
use glam::{Vec2, Vec3, Vec4};

fn picture(scene: &Scene, integrator: Integrator) -> Picture {
    let transport = Transport { integrator, ..scene.settings.transport };
    let settings = Settings { size: (24, 16), spp: 4, transport, ..scene.settings };
    let (picture, rays) = on_cpu(&pack(scene, &scene.cameras[0], settings));
    assert_eq!(rays.non_finite, 0);
    picture
}

fn light(picture: &Picture) -> f64 {
    picture.pixels.iter().flatten().map(|&channel| f64::from(channel)).sum()
}

/// A picture of bytes, of 64 x 64 texels.
fn map(texel: impl Fn(usize) -> [u8; 4], set: u32) -> Option<Map> {
    let texels = Texels::Bytes((0..64 * 64).map(texel).collect());
    let texture = Arc::new(Texture { name: "map".into(), width: 64, height: 64, texels });
    Some(Map { texture, placement: Placement { set, ..Placement::default() } })
}

/// All of it shines as brightly as its picture says, and nothing else lights it.
fn shining(texel: impl Fn(usize) -> [u8; 4]) -> Scene {
    let mut scene = shipped("bleeding");
    scene.lights.clear();
    scene.mesh.coordinates[0] =
        scene.mesh.positions.iter().map(|place| Vec2::new(place.x, place.y + place.z)).collect();
    let emission = map(texel, 0);
    for material in &mut scene.materials {
        (material.emission, material.maps.emission) = (Vec3::ONE, emission.clone());
    }
    scene
}

#[test]
fn a_black_picture_of_light_is_dark_and_a_faint_one_is_seen() {
    let black = shining(|_| [0, 0, 0, 255]);
    let faint = shining(|_| [1, 1, 1, 255]);
    for integrator in [Integrator::Path, Integrator::Distributed] {
        assert_eq!(light(&picture(&black, integrator)), 0.0, "{integrator:?}");
        assert!(light(&picture(&faint, integrator)) > 0.0, "{integrator:?}");
    }
    // Kernels that draw lamps need some.
    let is_emissive = |scene| pack(scene, &scene.cameras[0], scene.settings).effects().has(Effects::EMISSIVE);
    assert_eq!((is_emissive(&black), is_emissive(&faint)), (false, true));
    // One texel of many, so that the mean rounds to nothing in 8 bits.
    let spark = shining(|i| if i == 77 { [9, 9, 9, 255] } else { [0, 0, 0, 255] });
    let samples = pack(&spark, &spark.cameras[0], spark.settings);
    assert!(samples.lighting().emissions.iter().all(|emission| f32::from_bits(emission.radiance.w) > 0.0));
}

#[test]
fn coordinates_of_a_set_that_no_mesh_has_are_zero() {
    let mut scene = shipped("bleeding");
    let red = |set| map(|i| if i == 0 { [255, 0, 0, 255] } else { [0, 255, 0, 255] }, set);
    let covered = |scene: &mut Scene, set| scene.materials.iter_mut().for_each(|m| m.maps.base = red(set));
    scene.mesh.coordinates[0] = vec![Vec2::ZERO; scene.mesh.positions.len()];
    covered(&mut scene, 0);
    let of_zeros = picture(&scene, Integrator::Path);
    covered(&mut scene, 1);
    assert!(picture(&scene, Integrator::Path).bits_equal(&of_zeros), "no second set");
    scene.mesh.coordinates[0].clear();
    assert!(picture(&scene, Integrator::Path).bits_equal(&of_zeros), "no set at all");
}

/// Of two meshes in a scene, one without tangents looks as it does alone, by whichever set its normal map lies.
#[test]
fn tangents_are_made_for_what_has_none() {
    let mut scene = shipped("bleeding");
    let count = scene.mesh.positions.len();
    let lying = |place: &Vec3| Vec2::new(place.x + 0.3 * place.z, place.y - 0.2 * place.z);
    let coordinates: Vec<Vec2> = scene.mesh.positions.iter().map(lying).collect();
    let waves = |set| map(|i| [90 + (i % 64) as u8, 140, 220, 255], set);
    for material in &mut scene.materials {
        material.physical = Some(Physical::default());
        material.maps.normal = waves(0);
    }
    scene.mesh.coordinates[0] = coordinates.clone();
    let made = picture(&scene, Integrator::Path);
    // As where another mesh of the file has tangents.
    scene.mesh.tangents = vec![Vec4::ZERO; count];
    assert!(picture(&scene, Integrator::Path).bits_equal(&made), "zeros are none");
    scene.mesh.tangents = vec![Vec4::new(1.0, 0.0, 0.0, 1.0); count];
    assert!(!picture(&scene, Integrator::Path).bits_equal(&made), "a mesh's own count");
    scene.mesh.tangents.clear();
    scene.materials.iter_mut().for_each(|material| material.maps.normal = waves(1));
    scene.mesh.coordinates = [vec![Vec2::ZERO; count], coordinates];
    assert!(picture(&scene, Integrator::Path).bits_equal(&made), "by the set of the map");
}
