//! What `convert` writes.

mod program;

use program::{Place, shipped};

#[test]
fn a_converted_scene_renders_to_the_same_picture_without_the_files_that_it_came_from() {
    let place = Place::new(&[]);
    for name in ["whitted", "lights", "cornell_path"] {
        let file = format!("{name}.eyerays");
        let said = place.succeed(&["convert", &shipped(name), &file]).stderr;
        assert!(said.contains(&format!("{file}: ")) && said.contains(" bytes"), "{said}");
        let picture = |scene: &str| {
            let options = ["--size", "48x32", "--device", "cpu", "-o", "out.exr", "--json"];
            place.succeed(&[&["render", scene], &options[..]].concat()).json()["film_hash"].clone()
        };
        assert_eq!(picture(&file), picture(&shipped(name)), "{name}");
    }
    let again = place.succeed(&["convert", "lights.eyerays", "-o", "again.eyerays", "-q"]);
    assert!(again.stderr.is_empty());
    let [once, twice] = ["lights", "again"].map(|name| std::fs::read(place.path(&format!("{name}.eyerays"))).unwrap());
    assert_eq!(once, twice);
}

#[test]
fn another_ending_and_the_input_as_output_are_refused_and_nothing_is_written() {
    let place = Place::new(&[]);
    let ending = "whitted.obj: the ending chooses the form; end the name in .eyerays or .toml";
    place.refuse(&["convert", &shipped("whitted"), "whitted.obj"], &[ending]);
    assert!(place.names().is_empty());
    place.succeed(&["convert", &shipped("whitted"), "whitted.eyerays"]);
    place.refuse(&["convert", "whitted.eyerays", "whitted.eyerays"], &["would replace the input"]);
    assert_eq!(place.names(), ["whitted.eyerays"]);
}

#[test]
fn a_damaged_file_is_refused_by_every_command_in_a_line_that_names_it_and_what_to_do() {
    let place = Place::new(&[]);
    place.succeed(&["convert", &shipped("whitted"), "whole.eyerays", "-q"]);
    let whole = std::fs::read(place.path("whole.eyerays")).unwrap();
    let damaged = |damage: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = whole.clone();
        damage(&mut bytes);
        bytes
    };
    let middle = whole.len() / 2;
    for (bytes, why) in [
        (damaged(&|bytes| bytes[middle] ^= 1), "its contents have another hash"),
        (damaged(&|bytes| bytes.truncate(middle)), "are not what its header tells, as if it were cut off"),
        (damaged(&|bytes| bytes.truncate(20)), "its 20 bytes are less than a header"),
        (damaged(&|bytes| bytes[8] = 1), "version 1 of the binary form"),
        (damaged(&|bytes| bytes[13] = 1), "its header has other than zeros in its spare bytes"),
        (damaged(&|bytes| bytes[170] = 1), "its byte 170, which belongs to no section, is not zero"),
        (b"[render]\n".to_vec(), "this is no binary scene"),
    ] {
        std::fs::write(place.path("bad.eyerays"), bytes).unwrap();
        for arguments in [
            &["check", "bad.eyerays"][..],
            &["info", "bad.eyerays"],
            &["render", "bad.eyerays", "--device", "cpu", "-o", "out.png"],
            &["convert", "bad.eyerays", "again.eyerays"],
            &["diff", "bad.eyerays"],
            &["bench", "bad.eyerays", "--device", "cpu"],
            &["tradeoff", "bad.eyerays", "--device", "cpu"],
        ] {
            place.refuse(arguments, &["bad.eyerays: ", why, "eyerays convert"]);
        }
    }
}

/// A mesh with a camera, a light, a texture and a material with most that there is.
const MODEL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/fuzz/seeds/gltf/everything.glb");

#[test]
fn a_model_becomes_a_scene_file_that_renders_to_the_same_picture() {
    let place = Place::new(&[]);
    std::fs::copy(MODEL, place.path("model.glb")).unwrap();
    place.succeed(&["convert", "model.glb", "model.toml"]);
    let text = std::fs::read_to_string(place.path("model.toml")).unwrap();
    for said in ["integrator = \"path\"", "[[camera]]", "kind = \"spot\"", "base_color = [", "file = \"model.glb\""] {
        assert!(text.contains(said), "{said} is not in {text}");
    }
    let picture = |scene: &str| {
        let options = ["--size", "48x32", "--spp", "4", "--device", "cpu", "-o", "out.exr", "--json"];
        place.succeed(&[&["render", scene], &options[..]].concat()).json()["film_hash"].clone()
    };
    assert_eq!(picture("model.toml"), picture("model.glb"));
    // A bare mesh as well, from another folder.
    std::fs::create_dir(place.path("scenes")).unwrap();
    std::fs::write(place.path("mesh.obj"), program::TRIANGLE).unwrap();
    place.succeed(&["convert", "mesh.obj", "scenes/mesh.toml"]);
    assert_eq!(picture("scenes/mesh.toml"), picture("mesh.obj"));
    let text = std::fs::read_to_string(place.path("scenes/mesh.toml")).unwrap();
    assert!(text.contains("file = \"../mesh.obj\""), "both may be moved together: {text}");
    // And one that nothing lights but what shines.
    std::fs::write(place.path("lamp.gltf"), LAMP).unwrap();
    place.succeed(&["convert", "lamp.gltf", "lamp.toml"]);
    assert_eq!(picture("lamp.toml"), picture("lamp.gltf"));
    let text = std::fs::read_to_string(place.path("lamp.toml")).unwrap();
    assert!(text.contains("# Several of its materials are called \"matt\""), "{text}");
}

/// A triangle that shines before two others, whose materials share a name.
const LAMP: &str = r#"{ "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
"meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "material": 0 },
{ "attributes": { "POSITION": 1 }, "material": 1 }, { "attributes": { "POSITION": 1 }, "indices": 2, "material": 2 }] }],
"materials": [{ "name": "lamp", "emissiveFactor": [1, 1, 1] }, { "name": "matt" },
{ "name": "matt", "pbrMetallicRoughness": { "metallicFactor": 0 } }],
"accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" },
{ "bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3" },
{ "bufferView": 2, "componentType": 5121, "count": 3, "type": "SCALAR" }],
"bufferViews": [{ "buffer": 0, "byteLength": 36 }, { "buffer": 0, "byteOffset": 36, "byteLength": 36 },
{ "buffer": 0, "byteOffset": 72, "byteLength": 3 }],
"buffers": [{ "byteLength": 75, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIC/AACAPwAAAAAAAIC/AAAAAAAAgD8AAIC/AgEA" }] }"#;

#[test]
fn a_scene_file_is_neither_made_of_another_nor_replaced() {
    let place = Place::new(&[("mesh.obj", program::TRIANGLE), ("scene.toml", "# mine")]);
    place.refuse(
        &["convert", "mesh.obj", "scene.toml"],
        &["scene.toml: is there already, perhaps with changes of yours"],
    );
    place.refuse(&["convert", &shipped("whitted"), "new.toml"], &["a scene file takes its surfaces from a .gltf"]);
    place.refuse(&["convert", "mesh.obj", "new.toml", "--no-bvh"], &["--bvh and --no-bvh are of .eyerays files"]);
    assert_eq!(place.names(), ["mesh.obj", "scene.toml"]);
}
