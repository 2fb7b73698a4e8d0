//! Many pictures by one command, and what they say of themselves.

mod program;

use std::collections::BTreeSet;
use std::fs;

use eyerays::image;
use program::{Place, SCENE, shipped};
use serde_json::Value;

const SMALL: [&str; 4] = ["--device", "cpu", "--size", "16x12"];

#[test]
fn a_turn_is_as_many_pictures_and_its_first_is_the_camera_s_own() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    fs::create_dir(place.path("turn")).unwrap();
    place.succeed(&[&["render", "scene.toml", "--turntable", "4", "-o", "turn/{frame:03}.png"], &SMALL[..]].concat());
    place.succeed(&[&["render", "scene.toml", "-o", "one.png"], &SMALL[..]].concat());
    let read = |name: &str| image::read(&place.path(name)).unwrap();
    assert!(read("turn/000.png").bits_equal(&read("one.png")));
    assert_eq!(fs::read_dir(place.path("turn")).unwrap().count(), 4);
    // The half of it that another machine would render.
    let part = ["render", "scene.toml", "--turntable", "4", "--frames", "2..4", "-o", "{name}-{frame}.png"];
    place.succeed(&[&part, &SMALL[..]].concat());
    assert!(read("scene-3.png").bits_equal(&read("turn/003.png")) && !place.path("scene-1.png").exists());
    place.refuse(
        &[&["render", "scene.toml", "--turntable", "4", "-o", "x.png"], &SMALL[..]].concat(),
        &["x.png", "{frame:04}"],
    );
}

#[test]
fn a_scene_that_fails_does_not_stop_the_others() {
    let camera = "[[camera]]\nname = \"side\"\neye = [4, 0, 0]\ntarget = [0, 0, 0]\n";
    let both = format!("{SCENE}\n{camera}");
    let place = Place::new(&[("a.toml", "size = 3"), ("b.toml", &both), ("notes.txt", "no scene")]);
    let outcome = place.run(&[&["render", ".", "--all-cameras", "-o", "{name}-{camera}.png"], &SMALL[..]].concat());
    assert_eq!(outcome.code, Some(2));
    assert!(outcome.stderr.contains("error: ./a.toml:1: "), "{}", outcome.stderr);
    assert_eq!(place.names(), ["a.toml", "b-front.png", "b-side.png", "b.toml", "notes.txt"]);
    place.refuse(&["render", "a.toml", "b.toml", "-o", "x.png"], &["x.png", "{name}"]);
    fs::create_dir(place.path("empty")).unwrap();
    place.refuse(&["render", "empty"], &["empty: ", "no scene"]);
}

/// The second is to go on with the film of another picture.
#[test]
fn a_picture_that_fails_does_not_stop_the_others_of_its_scene() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    place.succeed(&["render", "scene.toml", "-o", "1.film", "--device", "cpu", "--size", "9x9"]);
    let turn = ["render", "scene.toml", "--turntable", "3", "-o", "{frame}.film", "--resume"];
    let outcome = place.run(&[&turn, &SMALL[..]].concat());
    assert_eq!(outcome.code, Some(2), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("error: 1.film"), "{}", outcome.stderr);
    assert_eq!(place.names(), ["0.film", "1.film", "2.film", "scene.toml"]);
}

#[test]
fn scenes_of_one_name_are_told_apart_by_their_endings() {
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let place = Place::new(&[("cup.toml", SCENE), ("cup.obj", triangle)]);
    place.refuse(&[&["render", "."], &SMALL[..]].concat(), &["cup.png", "{file}"]);
    place.succeed(&[&["render", ".", "-o", "{file}.png"], &SMALL[..]].concat());
    assert_eq!(place.names(), ["cup.obj", "cup.obj.png", "cup.toml", "cup.toml.png"]);
}

/// The names of a schema's properties, and those that it asks for.
fn names(schema: &Value) -> (BTreeSet<&str>, BTreeSet<&str>) {
    let all = schema["properties"].as_object().unwrap().keys().map(String::as_str).collect();
    (all, schema["required"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect())
}

#[test]
fn the_summary_has_what_its_schema_says() {
    let schema = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/summary.schema.json");
    let schema: Value = serde_json::from_str(&fs::read_to_string(schema).unwrap()).unwrap();
    let place = Place::new(&[]);
    for (scene, more) in [("bleeding", &["--spp", "4"][..]), ("glass", &["--reproducible"])] {
        let scene = shipped(scene);
        let summary = place.succeed(&[&["render", &scene, "-o", "p.exr", "--json"], &SMALL[..], more].concat()).json();
        for (found, schema) in [(&summary, &schema), (&summary["picture"], &schema["$defs"]["picture"])] {
            let (all, required) = names(schema);
            let found: BTreeSet<&str> = found.as_object().unwrap().keys().map(String::as_str).collect();
            assert!(found.is_subset(&all), "{:?} are not in the schema", found.difference(&all));
            assert!(required.is_subset(&found), "{:?} are missing", required.difference(&found));
        }
        let is_told = summary["picture"].get("seconds").is_some();
        assert_eq!(is_told, !more.contains(&"--reproducible"));
    }
}

/// Where no figure of time or of a device is in it.
#[test]
fn reproducible_pictures_are_equal_files() {
    let place = Place::new(&[]);
    let scene = shipped("bleeding");
    for (first, second) in [("a.exr", "b.exr"), ("a.png", "b.png")] {
        for (name, threads) in [(first, "1"), (second, "2")] {
            let render = ["render", &scene, "-o", name, "--reproducible", "--spp", "2", "--threads", threads];
            place.succeed(&[&render, &SMALL[..]].concat());
        }
        assert!(fs::read(place.path(first)).unwrap() == fs::read(place.path(second)).unwrap(), "{first}");
    }
}

/// A triangle that an animation moves a unit a second to the right, for two seconds.
fn moving() -> Place {
    let numbers: [f32; 17] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0];
    let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    let json = r#"{ "asset": { "version": "2.0" }, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
        "buffers": [{ "uri": "a.bin", "byteLength": 68 }],
        "bufferViews": [{ "buffer": 0, "byteOffset": 0, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 8 }, { "buffer": 0, "byteOffset": 44, "byteLength": 24 }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5126, "count": 2, "type": "SCALAR" },
            { "bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC3" }],
        "animations": [{ "name": "slide", "samplers": [{ "input": 1, "output": 2 }],
            "channels": [{ "sampler": 0, "target": { "node": 0, "path": "translation" } }] }] }"#;
    let placed = "[[mesh]]\nfile = \"a.gltf\"\n";
    let place = Place::new(&[("a.gltf", json), ("placed.toml", placed)]);
    std::fs::write(place.path("a.bin"), bytes).unwrap();
    place
}

#[test]
fn pictures_of_an_animation_are_those_of_its_moments() {
    let place = moving();
    let small = ["--device", "cpu", "--size", "16x16", "--spp", "1", "--eye", "1,0,5", "--target", "1,0,0", "--quiet"];
    place.succeed(&[&["render", "a.gltf", "--frames", "1..4", "--fps", "2", "-o", "{frame}.png"], &small[..]].concat());
    for (frame, seconds) in [("1.png", "0.5"), ("2.png", "1"), ("3.png", "1.5")] {
        place.succeed(&[&["render", "a.gltf", "--time", seconds, "-o", "single.png"], &small[..]].concat());
        place.succeed(&["diff", frame, "single.png"]);
    }
    assert_eq!(place.run(&["diff", "1.png", "3.png"]).code, Some(1));
    // A camera that nobody placed stands where it does as the animation begins, and what is left out is said once.
    let odd = std::fs::read_to_string(place.path("a.gltf")).unwrap();
    let odd = odd.replacen("{", "{ \"extensionsUsed\": [\"EXT_none\"],", 1);
    std::fs::write(place.path("odd.gltf"), odd).unwrap();
    let frames = ["render", "odd.gltf", "--frames", "0..3", "--fps", "4", "-o", "f{frame}.png"];
    let said = place.succeed(&[&frames[..], &["--device", "cpu", "--size", "32x32", "--spp", "1"]].concat());
    assert_eq!(said.stderr.matches("EXT_none").count(), 1, "{}", said.stderr);
    assert_eq!(place.run(&["diff", "f0.png", "f2.png"]).code, Some(1), "framed anew, it stands still");
    let info = |arguments: &[&str]| place.succeed(&[&["info", "--json"], arguments].concat()).json();
    assert_eq!(info(&["a.gltf"])["animations"], serde_json::json!([{ "name": "slide", "seconds": 2.0 }]));
    for (arguments, least) in [
        (&["--time", "0.25"][..], 0.25),
        (&["--time", "9"], 2.0),
        (&["--time", "-1", "--animation", "slide"], 0.0),
        (&["--time", "1", "--animation", "none"], 0.0),
    ] {
        for scene in ["a.gltf", "placed.toml"] {
            assert_eq!(info(&[&[scene], arguments].concat())["bounds"][0][0], least, "{scene} {arguments:?}");
        }
    }
    assert!(place.run(&["check", "a.gltf"]).stderr.contains("its animation \"slide\" stands at its start"));
    place.refuse(
        &["check", "a.gltf", "--animation", "run"],
        &["a.gltf: animations: there is no \"run\"; name one of slide"],
    );
    place.refuse(&["render", "a.gltf", "--fps", "5", "-o", "x.png"], &["--fps", "--frames A..B or --frame N"]);
    std::fs::write(place.path("still.toml"), program::SCENE).unwrap();
    let still = ["render", "still.toml", "--frames", "0..2", "-o", "{frame}.png"];
    place.refuse(&[&still[..], &["--device", "cpu"]].concat(), &["still.toml: it has no animation"]);
}
