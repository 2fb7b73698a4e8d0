//! Files of which something was changed by chance: refused, or whole.

use glam::Vec3;

use super::model::{Model, parse};
use crate::scene::Mesh;
use crate::scene_io::gltf::Gltf;
use crate::scene_io::obj::Obj;

/// Numbers of Marsaglia's xorshift, so that each run changes the same files.
struct Dice(u64);

impl Dice {
    fn below(&mut self, most: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % most as u64) as usize
    }
}

/// The bytes with a few bits flipped, an end cut off, or other numbers in their JSON.
fn mutated(seed: &[u8], dice: &mut Dice) -> Vec<u8> {
    let mut bytes = seed.to_vec();
    match dice.below(8) {
        0 => bytes.truncate(dice.below(seed.len())),
        1 | 2 => {
            for _ in 0..=dice.below(4) {
                let at = dice.below(seed.len());
                bytes[at] ^= 1 << dice.below(8);
            }
        }
        _ => {
            for _ in 0..=dice.below(2) {
                other_number(&mut bytes, dice);
            }
        }
    }
    bytes
}

const NUMBERS: [&str; 16] = [
    "-1",
    "0",
    "1",
    "2",
    "3",
    "5",
    "7",
    "255",
    "65536",
    "4294967295",
    "4294967296",
    "18446744073709551615",
    "1e-300",
    "1e300",
    "-0.5",
    "null",
];

/// Replaces a number; a binary file's lengths are made good, so that its JSON is looked at.
fn other_number(bytes: &mut Vec<u8>, dice: &mut Dice) {
    let is_digit = |byte: &u8| byte.is_ascii_digit();
    let from = dice.below(bytes.len());
    let Some(start) =
        (from..bytes.len()).find(|&at| b":[,".contains(&bytes[at]) && bytes.get(at + 1).is_some_and(is_digit))
    else {
        return;
    };
    let end = (start + 1..bytes.len()).find(|&at| !is_digit(&bytes[at])).unwrap_or(bytes.len());
    let number = NUMBERS[dice.below(NUMBERS.len())].as_bytes();
    let longer = number.len().wrapping_sub(end - start - 1) as u32;
    bytes.splice(start + 1..end, number.iter().copied());
    if bytes.starts_with(b"glTF") {
        for at in [8, 12] {
            let length = u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()).wrapping_add(longer);
            bytes[at..at + 4].copy_from_slice(&length.to_le_bytes());
        }
    }
}

#[test]
fn ten_thousand_damaged_files_are_refused_or_whole() {
    let model = Model::everything();
    let seeds = [model.gltf(), model.glb()];
    seeds.iter().for_each(|seed| assert_eq!(parse(seed).unwrap().obj.copies.meshes[0].triangles.len(), 3));
    let mut dice = Dice(0x2545_f491_4f6c_dd1d);
    let mut read = 0;
    for number in 0..10_000 {
        let bytes = mutated(&seeds[number % 2], &mut dice);
        match parse(&bytes) {
            Ok(scene) => {
                read += 1;
                assert_whole(&scene);
            }
            Err(error) => assert!(!error.to_string().contains('\n'), "{error}"),
        }
    }
    // Else the changes are too coarse to find anything.
    assert!((1_000..9_000).contains(&read), "{read} of them are read");
}

fn assert_whole(scene: &Gltf) {
    let Obj { mesh, copies, .. } = &scene.obj;
    assert!(!mesh.triangles.is_empty() || !copies.places.is_empty());
    assert!(copies.places.iter().all(|(mesh, _)| *mesh < copies.meshes.len()) && copies.fault().is_none());
    copies.meshes.iter().chain([mesh]).for_each(|mesh| assert_mesh(scene, mesh));
    for (name, fields) in &scene.obj.materials {
        let maps = fields.maps.all().count();
        assert!(maps <= 2 && fields.clone().finish(name).opacity <= 1.0);
    }
}

fn assert_mesh(scene: &Gltf, mesh: &Mesh) {
    let vertices = mesh.positions.len();
    assert_eq!(mesh.triangles.len(), mesh.materials.len());
    let [first, second] = &mesh.coordinates;
    let lengths = [mesh.normals.len(), mesh.tangents.len(), mesh.colours.len(), first.len(), second.len()];
    assert!(lengths.iter().all(|&length| length == 0 || length == vertices), "{lengths:?} of {vertices}");
    assert!(mesh.triangles.iter().flatten().all(|&vertex| (vertex as usize) < vertices));
    assert!(mesh.materials.iter().all(|&material| (material as usize) < scene.obj.materials.len()));
    assert!(mesh.positions.iter().all(|position| position.is_finite()));
    let unit = |n: &Vec3| *n == Vec3::ZERO || (n.length() - 1.0).abs() < 1e-5;
    assert!(mesh.normals.iter().all(unit));
}
