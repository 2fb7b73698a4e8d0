//! `eyerays generate` as a person runs it.

mod program;

use std::fs;

use eyerays::image;
use eyerays::scene_io;
use eyerays_command::generate::Kind;
use program::Place;

#[test]
fn a_scene_is_three_files_that_render_as_they_are() {
    for kind in ["hall", "forest", "cathedral"] {
        let place = Place::new(&[]);
        let outcome = place.succeed(&["generate", kind, "--triangles", "20000"]);
        let names = [format!("{kind}.mtl"), format!("{kind}.obj"), format!("{kind}.toml")];
        assert_eq!(place.names(), names);
        let summary = outcome.stderr.strip_suffix('\n').unwrap();
        assert!(!summary.contains('\n') && names.iter().all(|name| summary.contains(name)), "{summary}");
        assert!(summary.contains("20000 triangles") && outcome.stdout.is_empty(), "{summary}");
        let (scene, warnings) = scene_io::load(&place.path(&names[2])).unwrap();
        assert!(warnings.is_empty(), "{warnings:?}");
        assert_eq!((scene.settings.size, scene.mesh.triangles.len()), ((1024, 1024), 20_000));
        for number in 1..=5 {
            let view = format!("view{number}");
            let render =
                ["render", &names[2], "--camera", &view, "--size", "48x48", "--device", "cpu", "-o", "view.png"];
            let rendered = place.succeed(&render);
            assert!(rendered.stderr.contains("0 non-finite pixels"), "{}", rendered.stderr);
            let picture = image::read(&place.path("view.png")).unwrap();
            assert!(picture.pixels.iter().any(|pixel| pixel != &picture.pixels[0]), "{kind} {view}");
        }
        // The mesh by itself, too.
        place.succeed(&["check", &names[1]]);
    }
}

#[test]
fn spheres_are_a_list_and_a_scene_that_shows_it() {
    let place = Place::new(&[]);
    let outcome = place.succeed(&["generate", "spheres", "--count", "100"]);
    assert_eq!(outcome.stderr, "spheres.toml, spheres.xyzr: flake of 100 spheres\n");
    assert_eq!(place.names(), ["spheres.toml", "spheres.xyzr"]);
    let list = fs::read_to_string(place.path("spheres.xyzr")).unwrap();
    assert_eq!(list.lines().count(), 1 + 100);
    assert!(list.starts_with("# eyerays generate spheres --count 100\n0 1 0 1\n"), "{list}");
    let (scene, warnings) = scene_io::load(&place.path("spheres.toml")).unwrap();
    assert_eq!((scene.spheres.len(), scene.disks.len(), warnings.len()), (100, 1, 0));
    // By either name, and again.
    place.succeed(&["generate", "spheres", "--count", "101", "-q", "-o", "spheres.xyzr"]);
    assert_eq!(fs::read_to_string(place.path("spheres.xyzr")).unwrap().lines().count(), 1 + 101);
}

#[test]
fn plants_replace_plants_and_nothing_else() {
    let own = b"glTF\x02\0\0\0\x20\0\0\0\x14\0\0\0JSON{\"asset\":{\"generator\":\"a program\"}}";
    let place = Place::new(&[]);
    fs::write(place.path("own.glb"), own).unwrap();
    for plants in ["68", "70", "69"] {
        place.succeed(&["generate", "ecosystem", "--plants", plants, "-q", "-o", "plants.toml"]);
        assert!(fs::read_to_string(place.path("plants.toml")).unwrap().contains(&format!("--plants {plants} ")));
    }
    place.refuse(&["generate", "ecosystem", "--plants", "68", "-o", "own.toml"], &["own.glb", "not written by"]);
    assert_eq!(fs::read(place.path("own.glb")).unwrap(), own);
    assert_eq!(place.names(), ["own.glb", "plants.glb", "plants.toml"]);
}

#[test]
fn spheres_are_counted_and_meshes_cut_into_triangles() {
    let place = Place::new(&[("own.xyzr", "0 0 0 1\n")]);
    place.refuse(&["generate", "spheres", "--triangles", "6000"], &["--count"]);
    place.refuse(&["generate", "hall", "--count", "6000"], &["--triangles"]);
    place.refuse(&["generate", "spheres", "--count", "0"], &["--count 0", "1 to 20000000"]);
    place.refuse(&["generate", "spheres", "--count", "9", "-o", "a.obj"], &["a.obj", ".toml"]);
    place.refuse(&["generate", "spheres", "--count", "9", "-o", "-"], &["two files"]);
    place.refuse(&["generate", "spheres", "--count", "9", "-o", "own.toml"], &["own.xyzr", "not written by"]);
    let seeded = ["generate", "spheres", "--count", "9", "--seed", "2"];
    assert_eq!(place.run(&seeded).code, Some(2));
    assert_eq!(place.run(&["generate", "spheres"]).code, Some(2));
    assert_eq!(place.names(), ["own.xyzr"]);
}

#[test]
fn the_same_recipe_gives_the_same_bytes_and_another_seed_others() {
    let place = Place::new(&[]);
    let generate = |seed: &str, name: &str| {
        place.succeed(&["generate", "forest", "--triangles", "8001", "--seed", seed, "-o", name, "-q"])
    };
    assert!(generate("3", "a.obj").stderr.is_empty());
    let first = ["a.obj", "a.mtl", "a.toml"].map(|name| fs::read(place.path(name)).unwrap());
    generate("4", "a.obj");
    assert_ne!(fs::read(place.path("a.obj")).unwrap(), first[0]);
    generate("3", "a.obj");
    let again = ["a.obj", "a.mtl", "a.toml"].map(|name| fs::read(place.path(name)).unwrap());
    assert_eq!(again, first);
    assert_eq!(place.names(), ["a.mtl", "a.obj", "a.toml"]);
}

#[test]
fn numbers_out_of_range_are_refused_with_the_range() {
    let place = Place::new(&[]);
    let (least, most) = (Kind::LEAST.to_string(), Kind::MOST.to_string());
    let wants = ["--triangles", &least, &most];
    for triangles in [0, 1, Kind::LEAST - 1, Kind::MOST + 1, u64::MAX] {
        place.refuse(&["generate", "hall", "--triangles", &triangles.to_string()], &wants);
    }
    let help = place.succeed(&["generate", "--help"]);
    assert!(help.text().contains(&format!("{least} to {most}")) && help.text().contains("FILE.toml"));
    for wrong in [&["generate", "hall"][..], &["generate", "shed", "--triangles", "20000"], &["generate"]] {
        assert_eq!(place.run(wrong).code, Some(2), "{wrong:?}");
    }
    for wrong in ["-1", "1.5", "many", ""] {
        assert_eq!(place.run(&["generate", "hall", "--triangles", wrong]).code, Some(2), "{wrong:?}");
    }
    assert!(place.names().is_empty());
}

#[test]
fn places_that_cannot_be_written_are_refused() {
    let place = Place::new(&[("file", "")]);
    fs::create_dir(place.path("folder.obj")).unwrap();
    fs::create_dir(place.path("taken.mtl")).unwrap();
    for (name, want) in [
        ("missing/hall.obj", "the folder does not exist"),
        ("file/hall.obj", "the folder does not exist"),
        ("folder.obj", "is a directory"),
        ("taken.obj", "is a directory"),
        ("hall", ".obj"),
        ("hall.toml", ".obj"),
        ("/dev/null", ".obj"),
        ("", ".obj"),
        ("-", "three files"),
        ("a\nb.obj", "plain characters"),
        ("a\\b.obj", "plain characters"),
    ] {
        place.refuse(&["generate", "hall", "--triangles", "20000", "-o", name], &[want]);
    }
}

#[test]
fn files_that_a_person_made_are_kept() {
    for (name, content) in
        [("own.toml", program::SCENE), ("own.mtl", "newmtl red\n"), ("own.toml", ""), ("own.obj", program::TRIANGLE)]
    {
        let place = Place::new(&[(name, content)]);
        let wants = [name, "not written by eyerays generate", "-o"];
        place.refuse(&["generate", "hall", "--triangles", "20000", "-o", "own.obj"], &wants);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_nothing() {
    let place = Place::new(&[]);
    std::os::unix::fs::symlink("/dev/full", place.path("hall.obj")).unwrap();
    // Not by `refuse`, which would read the device.
    let outcome = place.run(&["generate", "hall", "--triangles", "20000"]);
    assert_eq!((outcome.code, outcome.stderr.lines().count()), (Some(2), 1));
    assert!(outcome.stderr.contains("hall.obj: no space left"), "{}", outcome.stderr);
    let left: Vec<_> = fs::read_dir(place.path("")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left, ["hall.obj"]);
}
