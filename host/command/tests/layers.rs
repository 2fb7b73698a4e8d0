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

/// A floor and a ball by a lamp of a group and another one.
const STUDIO: &str = r#"
[render]
size = [24, 18]
spp = 8
sampler = "sobol"
integrator = "path"

[background]
color = [0.2, 0.2, 0.3]

[[camera]]
name = "front"
eye = [0, 1, 4]
target = [0, 0, 0]

[[light]]
kind = "point"
position = [2, 3, 2]
group = "key"

[[light]]
kind = "point"
position = [-2, 3, 2]

[[mesh]]
shape = "quad"
corners = [[-4, -1, 4], [4, -1, 4], [4, -1, -4], [-4, -1, -4]]

[[mesh]]
shape = "sphere"
"#;

const KEPT: [&str; 7] = ["albedo", "normal", "direct", "indirect", "diffuse_direct", "group_key", "group_rest"];

fn kept<'a>(more: &[&'a str]) -> Vec<&'a str> {
    let layers = "albedo,normal,direct,indirect,diffuse_direct,light_groups";
    [&["render", "studio.toml", "--device", "cpu", "--layers", layers], more].concat()
}

/// By samples, by tiles, and in one that was ended and gone on with.
#[test]
fn layers_are_merged_and_gone_on_with_like_the_light() {
    let place = Place::new(&[("studio.toml", STUDIO)]);
    place.succeed(&kept(&["-o", "whole.exr"]));
    place.succeed(&kept(&["--samples-to", "3", "-o", "a.film"]));
    place.succeed(&kept(&["--samples-from", "3", "--tile", "0,0,24,7", "-o", "b.film"]));
    place.succeed(&kept(&["--samples-from", "3", "--tile", "0,7,24,11", "-o", "c.film"]));
    place.succeed(&["merge", "c.film", "a.film", "b.film", "-o", "merged.exr"]);
    place.succeed(&kept(&["--spp", "5", "-o", "on.film"]));
    place.succeed(&kept(&["--resume", "-o", "on.film"]));
    place.succeed(&["merge", "on.film", "-o", "on.exr"]);
    place.succeed(&["diff", "whole.exr", "merged.exr"]);
    for layer in KEPT {
        for other in ["merged.exr", "on.exr"] {
            place.succeed(&["diff", "whole.exr", other, "--layer", layer]);
        }
    }
    let other = ["render", "studio.toml", "--device", "cpu", "--layers", "albedo", "--resume", "-o", "on.film"];
    place.refuse(
        &other,
        &["on.film: a film that keeps other layers: albedo,normal,direct,", " albedo in the other; ask for the same"],
    );
}

#[test]
fn a_film_keeps_no_layer_that_is_no_sum_of_samples() {
    let place = Place::new(&[("studio.toml", STUDIO)]);
    for more in [&["-o", "a.film"][..], &["--samples-to", "3", "-o", "a.exr"]] {
        let depth = ["render", "studio.toml", "--device", "cpu", "--layers", "albedo,depth"];
        place.refuse(&[&depth, more].concat(), &["--layers: depth"]);
    }
    let whitted = ["render", "studio.toml", "--device", "cpu", "--integrator", "whitted", "--layers", "emission"];
    place.refuse(&[&whitted[..], &["-o", "a.exr"]].concat(), &["--integrator path"]);
    let plain = STUDIO.replace("group = \"key\"", "");
    fs::write(place.path("plain.toml"), plain).unwrap();
    let groups = ["render", "plain.toml", "--device", "cpu", "--layers", "light_groups", "-o", "a.exr"];
    place.refuse(&groups, &["plain.toml: no lamp of the scene is in a group"]);
    let measured = ["render", "studio.toml", "--device", "cpu", "--repeat", "2", "--layers", "emission", "-o", "a.exr"];
    place.refuse(&measured, &["--repeat", "the layer emission"]);
    let farm = ["farm", "studio.toml", "--parts", "2", "-o", "job", "--picture", "a.png", "--", "--layers", "emission"];
    place.refuse(&farm, &["PNG"]);
}

/// Channels of files are called so.
#[test]
fn names_of_groups_that_no_file_could_hold_are_refused() {
    let long = "x".repeat(65);
    for name in ["a.b", "a,b", " a", "rest", "\u{65e5}\u{672c}", "a\\u0000b", "a\\nb", &long] {
        let place = Place::new(&[("odd.toml", &STUDIO.replace("\"key\"", &format!("\"{name}\"")))]);
        place.refuse(&["check", "odd.toml"], &["a group of lamps is called ", "64 characters"]);
    }
    let place = Place::new(&[("good.toml", &STUDIO.replace("\"key\"", "\"L\u{e4}mpchen 1\""))]);
    place.succeed(&["render", "good.toml", "--device", "cpu", "--layers", "light_groups", "-o", "a.exr"]);
    place.succeed(&["diff", "a.exr", "a.exr", "--layer", "group_L\u{e4}mpchen 1"]);
    let lit = STUDIO.replace("shape = \"sphere\"", "shape = \"sphere\"\nlit_by = [3]");
    fs::write(place.path("lit.toml"), lit).unwrap();
    place.refuse(&["check", "lit.toml"], &["a list of names in quotes, not an integer"]);
}

/// Without what a few samples make too bright, the picture is still direct and indirect light.
#[test]
fn indirect_light_is_what_the_finished_picture_has_beside_direct_light() {
    let place = Place::new(&[("studio.toml", STUDIO)]);
    let kept = ["--spp", "32", "--fireflies=9", "--layers", "direct,indirect", "-o", "a.exr"];
    place.succeed(&[&["render", "studio.toml", "--device", "cpu"], &kept[..]].concat());
    let read = |layer: &str| eyerays::image::read_layer(&place.path("a.exr"), layer).unwrap().pixels;
    for ((all, direct), indirect) in read("colour").iter().zip(read("direct")).zip(read("indirect")) {
        for i in 0..3 {
            assert!(
                (all[i] - direct[i] - indirect[i]).abs() <= 1e-6 * all[i].max(1.0),
                "{all:?} {direct:?} {indirect:?}"
            );
        }
    }
}

/// Those that are no sums of samples are rendered once a merged film is gone on with, of which nothing is missing.
#[test]
fn a_merged_film_gets_all_other_layers_by_its_scene() {
    let place = Place::new(&[("studio.toml", STUDIO)]);
    let render = ["render", "studio.toml", "--device", "cpu", "--layers"];
    let all = "albedo,depth,position,object,crypto_object,crypto_material";
    place.succeed(&[&render[..], &[all, "-o", "whole.exr", "--reproducible"]].concat());
    place.succeed(&[&render[..], &["albedo", "--samples-to", "3", "-o", "a.film"]].concat());
    place.succeed(&[&render[..], &["albedo", "--samples-from", "3", "-o", "b.film"]].concat());
    place.succeed(&["merge", "b.film", "a.film", "-o", "all.film"]);
    let on = [all, "--checkpoint", "all.film", "--resume", "-o", "merged.exr", "--reproducible"];
    place.succeed(&[&render[..], &on].concat());
    assert_eq!(fs::read(place.path("whole.exr")).unwrap(), fs::read(place.path("merged.exr")).unwrap());
}
