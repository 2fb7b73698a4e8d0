//! Untrusted bytes: they are refused or read correctly, but never cause a panic.

use std::path::Path;

use glam::Vec3;
use proptest::prelude::*;

use super::budget;
use crate::scene_io::load::Loading;
use crate::scene_io::map::Images;
use crate::scene_io::{load, mtl, obj, xyzr};

/// Words of the format between words of no format.
fn word() -> impl Strategy<Value = String> {
    prop_oneof![
        4 => "(v|vn|vt|f|usemtl|mtllib|o|l|newmtl|Kd|d|illum|Pr|Pc|Ps|Ke|map_Kd -s|norm -bm|bump -bm) ",
        8 => "-?[0-9]{1,2} ",
        3 => "-?[0-9]{0,2}/[0-9]?/-?[0-9]{0,20} ",
        2 => "-?[0-9]\\.[0-9]e-?[0-9]{1,2} ",
        1 => "nan |inf |\\\\|#|\\.\\./|\u{e9}|\u{a0}",
        4 => "\n|\r\n",
    ]
}

fn text() -> impl Strategy<Value = Vec<u8>> {
    let words = prop::collection::vec(word(), 0..80).prop_map(|words| {
        let start = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\n";
        (start.to_owned() + &words.concat()).into_bytes()
    });
    prop_oneof![words, prop::collection::vec(any::<u8>(), 0..300)]
}

/// The documented example with a few bytes changed.
fn changed() -> impl Strategy<Value = Vec<u8>> {
    let example = include_bytes!("../example.toml");
    let change = (0..example.len(), any::<u8>());
    prop::collection::vec(change, 1..4).prop_map(|changes| {
        let mut bytes = example.to_vec();
        for (at, byte) in changes {
            bytes[at] = byte;
        }
        bytes
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 10_000, ..ProptestConfig::default() })]

    #[test]
    fn a_mesh_is_refused_or_whole(bytes in text()) {
        if let Ok(obj) = obj::parse(Path::new("/nowhere/a.obj"), &bytes[..], budget(1 << 20)) {
            let mesh = obj.mesh;
            prop_assert!(!mesh.triangles.is_empty());
            prop_assert_eq!(mesh.triangles.len(), mesh.materials.len());
            prop_assert!(mesh.normals.is_empty() || mesh.normals.len() == mesh.positions.len());
            prop_assert!(mesh.positions.iter().all(|position| position.is_finite()));
            let inside = |&vertex: &u32| (vertex as usize) < mesh.positions.len();
            prop_assert!(mesh.triangles.iter().flatten().all(inside));
            prop_assert!(mesh.coordinates[0].is_empty() || mesh.coordinates[0].len() == mesh.positions.len());
            prop_assert!(mesh.coordinates[0].iter().all(|place| place.is_finite()));
            let unit = |n: &Vec3| *n == Vec3::ZERO || (n.length() - 1.0).abs() < 1e-5;
            prop_assert!(mesh.normals.iter().all(unit));
            let known = |&material: &u32| (material as usize) < obj.materials.len();
            prop_assert!(mesh.materials.iter().all(known));
        }
    }

    #[test]
    fn spheres_are_refused_or_whole(
        numbers in prop::collection::vec("-?[0-9]{1,3} |[0-9]\\.[0-9]e-?[0-9]{1,2} |\n|\n|#|nan ", 0..60), bytes in text(),
    ) {
        for bytes in [numbers.concat().into_bytes(), bytes] {
            if let Ok(spheres) = xyzr::parse(Path::new("/nowhere/a.xyzr"), &bytes[..], budget(1 << 20)) {
                prop_assert!(!spheres.is_empty());
                for sphere in spheres {
                    prop_assert!(sphere.radius > 0.0 && sphere.bounds().iter().all(|corner| corner.is_finite()));
                }
            }
        }
    }

    #[test]
    fn a_material_file_is_refused_or_in_range(bytes in text()) {
        if let Ok(library) = mtl::parse(Path::new("/nowhere/a.mtl"), &bytes, &mut Images::new(Path::new("/nowhere"), Loading::default())) {
            for (name, fields) in library.materials {
                let material = fields.finish(&name);
                let share = |colour: Vec3| colour == colour.clamp(Vec3::ZERO, Vec3::ONE);
                prop_assert!(share(material.diffuse) && share(material.transmission));
                prop_assert!((1.0..=4.0).contains(&material.ior));
            }
        }
    }

    #[test]
    fn a_scene_file_is_refused_in_one_line(bytes in changed()) {
        if let Err(error) = load::parse(Path::new("/nowhere/a.toml"), &bytes, budget(1 << 30), Loading::default()) {
            prop_assert!(!error.to_string().contains('\n'));
        }
    }
}
