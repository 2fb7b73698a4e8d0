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
        let film = |scene: &str| {
            let options = ["--size", "48x32", "--device", "cpu", "-o", "out.exr", "--json"];
            place.succeed(&[&["render", scene], &options[..]].concat()).json()["film_hash"].clone()
        };
        assert_eq!(film(&file), film(&shipped(name)), "{name}");
    }
    let again = place.succeed(&["convert", "lights.eyerays", "again.eyerays", "-q"]);
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
fn a_damaged_file_is_refused_in_a_line_that_names_it() {
    let place = Place::new(&[]);
    place.succeed(&["convert", &shipped("whitted"), "whole.eyerays"]);
    let mut bytes = std::fs::read(place.path("whole.eyerays")).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    std::fs::write(place.path("whole.eyerays"), &bytes).unwrap();
    place.refuse(&["check", "whole.eyerays"], &["whole.eyerays: its contents have another hash"]);
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
    let film = |scene: &str| {
        let options = ["--size", "48x32", "--spp", "4", "--device", "cpu", "-o", "out.exr", "--json"];
        place.succeed(&[&["render", scene], &options[..]].concat()).json()["film_hash"].clone()
    };
    assert_eq!(film("model.toml"), film("model.glb"));
    // A bare mesh as well, from another folder.
    std::fs::create_dir(place.path("scenes")).unwrap();
    std::fs::write(place.path("mesh.obj"), program::TRIANGLE).unwrap();
    place.succeed(&["convert", "mesh.obj", "scenes/mesh.toml"]);
    assert_eq!(film("scenes/mesh.toml"), film("mesh.obj"));
}

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
