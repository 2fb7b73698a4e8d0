//! What every recipe promises, of the bytes that it writes.

use std::collections::HashMap;
use std::path::Path;

use eyerays_bvh::Quality;
use glam::Vec3;
use proptest::prelude::*;

use super::{Files, Kind, Pair, Recipe, Spheres, obj};
use eyerays::job::Job;
use eyerays::scene::{self, Background, Scene};
use eyerays::scene_io;
use eyerays::view::View;
use eyerays::{cpu, picture::Picture};

const KINDS: [Kind; 3] = [Kind::Hall, Kind::Forest, Kind::Cathedral];

/// A mesh's text.
fn text(kind: Kind, triangles: u64, seed: u64) -> String {
    let mut bytes = Vec::new();
    obj::write_mesh(&kind.model(triangles, seed), triangles, "scene.mtl", &mut bytes).unwrap();
    String::from_utf8(bytes).unwrap()
}

/// The triangles of a group each, after a look at every one.
fn groups(text: &str) -> HashMap<&str, u64> {
    let (mut points, mut counts, mut group) = (Vec::new(), HashMap::new(), "");
    for line in text.lines() {
        let (key, rest) = line.split_once(' ').unwrap();
        match key {
            "v" => points.push(Vec3::from_slice(&rest.split(' ').map(|x| x.parse().unwrap()).collect::<Vec<f32>>())),
            "g" => group = rest,
            "f" => {
                let corner = |word: &str| points[word.split('/').next().unwrap().parse::<usize>().unwrap() - 1];
                let [a, b, c] = rest.split(' ').map(corner).collect::<Vec<_>>()[..] else { panic!("{line}") };
                let area = (b - a).as_dvec3().cross((c - a).as_dvec3()).length();
                assert!(area > 1e-12 && area.is_finite(), "{group}: {a} {b} {c}");
                *counts.entry(group).or_default() += 1;
            }
            _ => {}
        }
    }
    counts
}

#[test]
fn there_are_exactly_as_many_triangles_as_asked_for() {
    for kind in KINDS {
        for triangles in [Kind::LEAST, Kind::LEAST + 1, 9_999, 20_000, 75_000, 100_001] {
            for seed in [0, 1, u64::MAX] {
                let total: u64 = groups(&text(kind, triangles, seed)).values().sum();
                assert_eq!(total, triangles, "{kind:?} {seed}");
            }
        }
    }
}

#[test]
fn a_million_triangles_are_none_too_small() {
    for kind in KINDS {
        assert_eq!(groups(&text(kind, 1_000_000, 3)).values().sum::<u64>(), 1_000_000);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn any_number_can_be_dealt_out(kind in 0usize..3, triangles in Kind::LEAST..=Kind::MOST, seed: u64) {
        let model = KINDS[kind].model(triangles, seed);
        prop_assert_eq!(model.deal(triangles).map(|(_, count)| count).sum::<u64>(), triangles);
    }

    #[test]
    fn any_few_triangles_are_sound(kind in 0usize..3, more in 0u64..30_000, seed: u64) {
        let total: u64 = groups(&text(KINDS[kind], Kind::LEAST + more, seed)).values().sum();
        prop_assert_eq!(total, Kind::LEAST + more);
    }
}

/// A change of these numbers is a change of the scenes, which others have measured.
#[test]
fn a_recipe_gives_the_same_bytes_on_every_machine() {
    for (kind, expected) in KINDS.into_iter().zip(HASHES) {
        let place = tempfile::tempdir().unwrap();
        let files = write(place.path(), Recipe { kind, triangles: 20_000, seed: 1 });
        let found = files.paths().map(|path| fnv(&std::fs::read(path).unwrap()));
        assert_eq!(found, expected, "{kind:?}: {found:#018x?}");
    }
}

#[test]
fn a_number_of_spheres_gives_the_same_bytes_on_every_machine() {
    let place = tempfile::tempdir().unwrap();
    let files = Pair::beside(&place.path().join("scene.toml")).unwrap();
    Spheres { count: 20_000 }.write(&files).unwrap();
    let found = files.paths().map(|path| fnv(&std::fs::read(path).unwrap()));
    assert_eq!(found, [0x5248_c5c8_e91a_2711, 0x20da_5a64_271d_0ea2], "{found:#018x?}");
}

/// Of mesh, materials and scene.
const HASHES: [[u64; 3]; 3] = [
    [0xfd39_089b_e589_f268, 0x9e39_7eab_df0a_b9b4, 0x7b64_5f72_ed0f_8bb6],
    [0xf141_f581_b23d_57e0, 0xc896_ef28_6cfd_3135, 0xc648_07a4_132f_70f5],
    [0x47e1_8061_6e38_ecf7, 0x2f6f_37ef_62d8_c65b, 0xb49e_d5ba_a15a_3cb1],
];

/// Fowler, Noll and Vo's hash, 1a.
fn fnv(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &b| (hash ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3))
}

#[test]
fn another_seed_gives_another_scene() {
    for kind in KINDS {
        let (a, b) = (text(kind, 20_000, 1), text(kind, 20_000, 2));
        let moved = a.lines().zip(b.lines()).filter(|(a, b)| a.starts_with("v ") && a != b).count();
        assert!(moved > 1_000, "{kind:?}: {moved}");
    }
}

#[test]
fn most_of_the_forest_is_its_figure() {
    for triangles in [20_000, 75_000, 300_000] {
        let figure = groups(&text(Kind::Forest, triangles, 1))["figure"];
        assert!(2 * figure > triangles, "{figure} of {triangles}");
    }
}

/// From 20000 on, nothing is left out.
#[test]
fn every_table_shows_every_piece() {
    for kind in KINDS {
        for seed in 0..20 {
            let [some, all] = [20_000, Kind::MOST].map(|triangles| kind.model(triangles, seed).fewest());
            assert_eq!(some, all, "{kind:?} {seed}");
        }
    }
}

fn write(folder: &Path, recipe: Recipe) -> Files {
    let files = Files::beside(&folder.join("scene.obj")).unwrap();
    recipe.write(&files).unwrap();
    files
}

fn load(kind: Kind, triangles: u64, seed: u64) -> Scene {
    let place = tempfile::tempdir().unwrap();
    let files = write(place.path(), Recipe { kind, triangles, seed });
    let (scene, warnings) = scene_io::load(files.paths()[2]).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(scene.mesh.triangles.len() as u64, triangles);
    scene
}

/// A view with nothing but this around the scene.
fn picture(scene: &Scene, camera: usize, around: Vec3) -> Picture {
    let scene = Scene { background: Background::Colour(around), ..scene.clone() };
    let settings = scene::Settings { size: (72, 72), ..scene.settings };
    let packed = Job::new(&scene, settings, Quality::Fast).unwrap();
    let view = View::new(&packed, &scene.cameras[camera]).unwrap();
    cpu::render::<f32>(&packed, &view, eyerays::method::Method::IfIf, 0, &|_| ()).unwrap().0
}

/// Where two backgrounds give two colours, a ray got out.
fn open_pixels(scene: &Scene, camera: usize) -> usize {
    let [black, bright] = [0.0, 1e4].map(|grey| picture(scene, camera, Vec3::splat(grey)).pixels);
    black.iter().zip(&bright).filter(|(a, b)| a != b).count()
}

#[test]
fn the_rooms_are_closed_and_the_forest_sees_the_sky() {
    for kind in KINDS {
        for (triangles, seed) in [(Kind::LEAST, 1), (20_000, 2)] {
            let scene = load(kind, triangles, seed);
            assert_eq!(scene.cameras.len(), 5);
            assert!(scene.lights.len() >= 2);
            for camera in 0..5 {
                let open = open_pixels(&scene, camera);
                let sky = kind == Kind::Forest;
                assert_eq!(open > 72 * 72 / 20, sky, "{kind:?} view{}: {open}", camera + 1);
                assert!(sky || open == 0, "{kind:?} view{}: {open}", camera + 1);
            }
        }
    }
}

/// From inside a thing, all there is to see is near and the same.
#[test]
fn the_views_show_something() {
    for kind in KINDS {
        for seed in 1..4 {
            let scene = load(kind, 20_000, seed);
            for camera in 0..5 {
                let picture = picture(&scene, camera, Vec3::ONE);
                let mut colours: Vec<_> = picture.pixels.iter().map(|p| p.map(|c| (c * 16.0) as i32)).collect();
                colours.sort_unstable();
                colours.dedup();
                assert!(colours.len() > 30, "{kind:?} seed {seed} view{}: {}", camera + 1, colours.len());
            }
        }
    }
}

#[test]
fn names_that_the_files_could_not_hold_are_refused() {
    for name in ["-", "", "scene", "scene.toml", "a\nb.obj", "a\\b.obj", "c:d.obj", " a.obj", "folder/", "..obj"] {
        assert!(Files::beside(Path::new(name)).is_err(), "{name:?}");
    }
}

#[test]
fn odd_names_are_held() {
    for name in ["a b  c.obj", "quote\"s.obj", "'#$.obj", "é.OBJ"] {
        let place = tempfile::tempdir().unwrap();
        let files = Files::beside(&place.path().join(name)).unwrap();
        Recipe { kind: Kind::Hall, triangles: Kind::LEAST, seed: 1 }.write(&files).unwrap();
        let (scene, warnings) = scene_io::load(files.paths()[2]).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(warnings.is_empty() && scene.materials.len() > 5, "{name}: {warnings:?}");
    }
}
