//! `diff --layer`: layers of two files, compared by themselves.

mod program;

use program::{Place, SCENE};
use std::fs;

/// Two renderings that differ in their light alone, and one of another camera.
fn place() -> Place {
    let place = Place::new(&[("scene.toml", SCENE)]);
    let render = ["render", "scene.toml", "--device", "cpu", "--layers", "albedo,depth", "-o"];
    let moved = ["--eye", "0,0.2,4", "--target", "0,0,0"];
    for (name, more) in [("a.exr", &["--exposure", "1"][..]), ("b.exr", &[]), ("moved.exr", &moved)] {
        place.succeed(&[&render[..], &[name], more].concat());
    }
    place
}

#[test]
fn a_layer_is_compared_instead_of_the_colours() {
    let place = place();
    let code = |arguments: &[&str]| place.run(&[&["diff"], arguments].concat()).code;
    assert_eq!(code(&["a.exr", "b.exr"]), Some(1));
    for layer in ["albedo", "depth"] {
        let same = place.succeed(&["diff", "a.exr", "b.exr", "--layer", layer]);
        assert!(same.text().starts_with(&format!("a.exr against b.exr, layer {layer}\n")), "{}", same.text());
        assert!(same.text().contains("equal in every bit  yes"), "{}", same.text());
    }
    // Nothing is infinitely far away in both, which is no difference.
    assert!(!place.succeed(&["diff", "a.exr", "b.exr", "--layer", "depth"]).text().contains("non-finite values   0"));
    let json = place.run(&["diff", "a.exr", "moved.exr", "--layer", "depth", "--json", "-o", "map.png"]);
    assert_eq!((json.code, &json.json()["layer"]), (Some(1), &"depth".into()));
    assert!(place.path("map.png").is_file());
}

#[test]
fn layers_that_are_not_there_are_refused_with_those_that_are() {
    let place = place();
    place.succeed(&["render", "scene.toml", "--device", "cpu", "-o", "plain.exr"]);
    place.succeed(&["render", "scene.toml", "--device", "cpu", "-o", "plain.png"]);
    let normal = ["diff", "a.exr", "b.exr", "--layer", "normal"];
    place.refuse(&normal, &["a.exr: has no layer \"normal\"; it has albedo, colour, depth"]);
    let plain = ["diff", "a.exr", "plain.exr", "--layer", "depth"];
    place.refuse(&plain, &["plain.exr: has no layer \"depth\"; it has colour"]);
    place.refuse(&["diff", "a.exr", "plain.png", "--layer", "depth"], &["plain.png: ", "not an EXR image"]);
    assert_eq!(place.run(&["diff", "scene.toml", "--layer", "depth"]).code, Some(2));
    let whole = fs::read(place.path("a.exr")).unwrap();
    fs::write(place.path("cut.exr"), &whole[..whole.len() / 2]).unwrap();
    place.refuse(&["diff", "a.exr", "cut.exr", "--layer", "depth"], &["cut.exr: "]);
}
