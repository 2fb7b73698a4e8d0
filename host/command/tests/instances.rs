//! Meshes that stand in several places: one picture, whether they are held once or not, from every form of a scene.

mod program;

use program::Place;

/// A tetrahedron with a base, by its corners.
const OBJ: &str = "v 0 1 0\nv -1 0 -1\nv 1 0 -1\nv 0 0 1\nf 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n";

/// A floor, and the same mesh seven times: turned, stretched, mirrored, flat, and by other materials.
const SCENE: &str = r#"
[render]
size = [48, 36]
samples = 2

[[camera]]
name = "front"
eye = [1.0, 3.0, 8.0]
target = [0.0, 0.5, 0.0]

[[light]]
kind = "directional"
direction = [-0.4, -1.0, -0.3]

[[material]]
name = "red"
diffuse = [0.8, 0.1, 0.1]

[[mesh]]
shape = "box"
min = [-5.0, -0.2, -5.0]
max = [5.0, 0.0, 5.0]

[[mesh]]
file = "a.obj"

[[mesh]]
file = "a.obj"
rotate = [10.0, 30.0, 5.0]
translate = [2.0, 0.1, 0.0]

[[mesh]]
file = "a.obj"
scale = [-0.5, 1.5, 0.7]
translate = [-2.0, 0.0, 1.0]

[[mesh]]
file = "a.obj"
material = "red"
translate = [0.3, 0.2, 2.0]

[[mesh]]
file = "a.obj"
material = "red"
scale = 0.5
translate = [-0.6, 0.2, 3.0]

[[mesh]]
file = "a.obj"
smooth = true
translate = [3.0, 0.0, -2.0]
"#;

fn hash(place: &Place, scene: &str, options: &[&str]) -> String {
    let arguments = [&["render", scene, "-o", "a.exr", "--json", "--device", "cpu"], options].concat();
    place.succeed(&arguments).json()["film_hash"].as_str().expect("a text").to_owned()
}

#[test]
fn a_scene_file_that_repeats_a_mesh_is_one_picture_whether_it_is_held_once_or_not() {
    let place = Place::new(&[("a.toml", SCENE), ("a.obj", OBJ)]);
    for integrator in ["whitted", "path", "ao"] {
        let of = |instances| hash(&place, "a.toml", &["--integrator", integrator, "--instances", instances]);
        assert_eq!(of("always"), of("never"), "{integrator}");
        assert_eq!(of("auto"), of("never"), "{integrator}");
    }
    let info = place.succeed(&["info", "a.toml", "--json", "--instances", "always"]).json();
    let meshes = info["outline"]["meshes"].as_array().or(info["meshes"].as_array()).expect("a list").clone();
    let count = |key: &str| meshes.iter().map(|mesh| mesh[key].as_u64().unwrap()).sum::<u64>();
    assert_eq!((meshes.len(), count("instances"), count("triangles")), (7, 5, 12 + 6 * 4), "{meshes:?}");
}

#[test]
fn layers_tell_objects_materials_and_places_alike() {
    let place = Place::new(&[("a.toml", SCENE), ("a.obj", OBJ)]);
    let layers = "depth,normal,object,material,position,albedo";
    let write = |instances: &str, file: &str| {
        let arguments =
            ["render", "a.toml", "--device", "cpu", "--layers", layers, "--instances", instances, "-o", file];
        place.succeed(&arguments);
    };
    write("always", "once.exr");
    write("never", "apart.exr");
    for layer in layers.split(',') {
        place.succeed(&["diff", "once.exr", "apart.exr", "--layer", layer]);
    }
}

#[test]
fn plants_are_the_same_as_a_model_a_binary_scene_and_flat() {
    let place = Place::new(&[]);
    place.succeed(&["generate", "ecosystem", "--plants", "150", "-o", "plants.toml"]);
    let small = ["--size", "40x24", "--spp", "1", "--camera", "among", "--instances"];
    let of = |scene, instances| hash(&place, scene, &[&small[..], &[instances]].concat());
    let always = of("plants.toml", "always");
    assert_eq!(always, of("plants.toml", "never"));
    for (instances, file) in [("always", "once.eyerays"), ("never", "flat.eyerays")] {
        place.succeed(&["convert", "plants.toml", "--instances", instances, "-o", file]);
        assert_eq!(always, of(file, "always"));
        assert_eq!(always, of(file, "never"));
    }
    let bytes = |file: &str| std::fs::metadata(place.path(file)).unwrap().len();
    assert!(bytes("once.eyerays") < bytes("flat.eyerays") / 4, "what is held once is written once");
    place.refuse(&["bench", "plants.toml", "--instances", "always", "--quick"], &["leave --instances out"]);
}
