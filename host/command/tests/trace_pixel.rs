//! `eyerays trace-pixel`, and the layers that count the same.

mod program;

use program::{Place, SCENE, shipped};

/// Two squares behind each other.
const SQUARES: &str = r#"
[render]
size = [9, 7]

[[camera]]
name = "front"
eye = [0, 0, 4]
target = [0, 0, 0]

[[material]]
name = "red"
diffuse = [1, 0, 0]

[[mesh]]
shape = "quad"
corners = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
material = "red"

[[mesh]]
shape = "quad"
corners = [[-1, -1, -2], [1, -1, -2], [1, 1, -2], [-1, 1, -2]]
"#;

#[test]
fn a_pixel_is_told_with_what_it_shows_first_and_the_steps_behind() {
    let place = Place::new(&[("scene.toml", SQUARES)]);
    let outcome = place.succeed(&["trace-pixel", "scene.toml", "4", "3", "--method", "if-if"]);
    let lines: Vec<&str> = outcome.text().lines().collect();
    assert_eq!(lines[0], "scene.toml: the middle of pixel 4,3 of 9x7, camera \"front\"");
    assert!(lines[1].starts_with("sees triangle ") && lines[1].ends_with(", material 1 \"red\""), "{}", lines[1]);
    for want in ["  distance  4.000000", "  position  0.000000, 0.000000, 0.000000", "  error     "] {
        assert!(lines.iter().any(|line| line.starts_with(want)), "{want}: {}", outcome.text());
    }
    let title = lines.iter().position(|line| line.starts_with("if-if: ")).expect("the method");
    assert!(lines[title + 1].starts_with("    1  visit node 0, depth 0"), "{}", outcome.text());
    assert!(lines.last().unwrap().starts_with("  hit  triangle "), "{}", outcome.text());
}

#[test]
fn json_has_the_same_and_every_method_agrees() {
    let place = Place::new(&[("scene.toml", SQUARES)]);
    let told = place.succeed(&["trace-pixel", "scene.toml", "4", "3", "--method", "all", "--json"]).json();
    assert_eq!((&told["x"], &told["y"], &told["sample"]), (&4.into(), &3.into(), &().into()));
    assert_eq!((&told["pick"]["distance"], &told["pick"]["surface"]["material"]["name"]), (&4.0.into(), &"red".into()));
    let trails = told["trails"].as_array().unwrap();
    assert_eq!(trails.len(), 9);
    for trail in trails {
        assert_eq!(trail["hit"]["surface"], told["pick"]["surface"], "{trail}");
        assert_eq!(trail["hit"]["t"], 4.0);
        let steps = trail["steps"].as_array().unwrap();
        let count = |kind: &str| steps.iter().filter(|step| step["step"] == kind).count();
        assert_eq!((&trail["visits"], &trail["tests"]), (&count("visit").into(), &count("test").into()));
    }
    let packet = trails.iter().find(|trail| trail["method"] == "packet").unwrap();
    assert_eq!(packet["packet"], serde_json::json!({ "x": 0, "y": 0, "width": 8, "height": 4 }));
}

/// The numbers of both commands are of the same rays.
#[test]
fn layers_of_a_picture_have_the_numbers_of_its_pixels() {
    let place = Place::new(&[]);
    let scene = shipped("lights");
    let view = ["--size", "16x12", "--bvh", "medium"];
    for method in ["auto", "if-if", "wide"] {
        let render = ["render", &scene, "--device", "cpu", "--layers", "visits,tests,deepest", "-o", "picture.exr"];
        place.succeed(&[&render[..], &view, &["--method", method]].concat());
        let [visits, tests, deepest] = ["visits", "tests", "deepest"]
            .map(|name| eyerays::image::read_layer(&place.path("picture.exr"), name).unwrap());
        for (x, y) in [(0, 0), (8, 6), (15, 11), (3, 9)] {
            let (column, row) = (x.to_string(), y.to_string());
            let trace = ["trace-pixel", &scene, &column, &row, "--json", "--method", method];
            let told = place.succeed(&[&trace[..], &view].concat()).json();
            let of = |layer: &eyerays::picture::Picture| f64::from(layer.pixels[y * 16 + x][0]);
            for (name, layer) in [("visits", &visits), ("tests", &tests), ("deepest", &deepest)] {
                assert_eq!(told["trails"][0][name].as_f64(), Some(of(layer)), "{method} {x},{y} {name}");
            }
        }
    }
}

#[test]
fn what_shows_nothing_is_said_to_see_nothing() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    let outcome = place.succeed(&["trace-pixel", "scene.toml", "0", "0"]);
    let lines: Vec<&str> = outcome.text().lines().collect();
    assert_eq!((lines[1], *lines.last().unwrap()), ("sees nothing", "  hit  nothing"));
    let json = place.succeed(&["trace-pixel", "scene.toml", "0", "0", "--json"]).json();
    assert!(json["pick"].is_null() && json["trails"][0]["hit"].is_null());
}

#[test]
fn pixels_samples_and_scenes_that_are_not_there_are_refused_with_what_there_is() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    for (x, y) in [("24", "0"), ("0", "18"), ("-1", "3"), ("99999999999", "0")] {
        let wants = [&format!("the pixel {x},{y} is not in the picture of 24x18")[..], "from 0 to 23", "from 0 to 17"];
        place.refuse(&["trace-pixel", "scene.toml", x, y], &wants);
    }
    place.refuse(&["trace-pixel", "scene.toml", "0", "0", "--sample", "1"], &["no sample 1", "from 0 to 0"]);
    place.refuse(&["trace-pixel", "missing.toml", "0", "0"], &["missing.toml"]);
    place.refuse(&["trace-pixel", "scene.toml", "0", "0", "--stack-max", "64"], &["--stack-max"]);
    for wrong in [&["trace-pixel", "scene.toml", "0"][..], &["trace-pixel", "scene.toml", "0", "0", "--method", "both"]]
    {
        assert_eq!(place.run(wrong).code, Some(2));
    }
    let help = place.succeed(&["trace-pixel", "--help"]);
    assert!(help.text().contains("Examples:") && help.text().contains("interleaved-cut"), "{}", help.text());
}
