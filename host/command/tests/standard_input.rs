//! Scenes from standard input.

mod program;

use std::io::Write;
use std::process::{Command, Stdio};

use program::{Outcome, Place, SCENE, TRIANGLE};

/// Runs the program with a text on its standard input.
fn piped(mut command: Command, text: &[u8]) -> Outcome {
    let mut program = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // A program that refuses its options reads nothing.
    let _ = program.stdin.take().unwrap().write_all(text);
    program.wait_with_output().unwrap().into()
}

fn refusal(place: &Place, arguments: &[&str], text: &[u8]) -> String {
    let outcome = piped(place.command(arguments), text);
    assert_eq!((outcome.code, outcome.stdout.len()), (Some(2), 0), "{}", outcome.stderr);
    assert_eq!(outcome.stderr.lines().count(), 1, "{}", outcome.stderr);
    outcome.stderr
}

#[test]
fn a_scene_from_standard_input_has_the_picture_of_its_file() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    place.succeed(&["render", "scene.toml", "--device", "cpu", "-o", "file.exr"]);
    let outcome = piped(place.command(&["render", "-", "--device", "cpu", "-o", "input.exr"]), SCENE.as_bytes());
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    place.succeed(&["diff", "file.exr", "input.exr"]);
    let outcome = piped(place.command(&["render", "-", "--device", "cpu"]), SCENE.as_bytes());
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    assert_eq!(place.names(), ["eyerays.png", "file.exr", "input.exr", "scene.toml"]);
}

#[test]
fn check_and_info_read_standard_input_too() {
    let place = Place::new(&[("mesh.obj", TRIANGLE)]);
    let scene = b"[[mesh]]\nfile = \"mesh.obj\"\n";
    let checked = piped(place.command(&["check", "-"]), scene);
    assert!(checked.text().starts_with("standard input: 1 triangle, "), "{}{}", checked.text(), checked.stderr);
    let told = piped(place.command(&["info", "-", "--json", "--bvh", "fast"]), scene);
    assert_eq!(told.json()["hierarchies"][0]["primitives"], 1, "{}", told.stderr);
}

#[test]
fn what_is_wrong_on_standard_input_is_one_line_with_its_number() {
    let place = Place::new(&[]);
    let misspelt = SCENE.replace("target", "tarjet");
    for arguments in [&["check", "-"][..], &["info", "-"], &["render", "-", "--device", "cpu"]] {
        let said = refusal(&place, arguments, misspelt.as_bytes());
        assert!(said.starts_with("error: standard input:7: ") && said.contains("\"tarjet\""), "{said}");
        let said = refusal(&place, arguments, b"");
        assert_eq!(said, "error: standard input: it is empty; write a scene to it\n");
        let said = refusal(&place, arguments, b"[[mesh]]\n\xff");
        assert!(said.starts_with("error: standard input:2: this is not UTF-8 text"), "{said}");
        let said = refusal(&place, arguments, b"[[mesh]]\nfile = \"missing.obj\"\n");
        assert!(said.starts_with("error: standard input:2: ") && said.contains("missing.obj"), "{said}");
    }
    assert!(place.names().is_empty());
}

#[test]
fn more_than_a_scene_file_may_hold_is_not_read() {
    let said = refusal(&Place::new(&[]), &["check", "-"], &vec![b'\n'; (64 << 20) + 1]);
    assert!(said.contains("standard input: it holds more than 67108864 bytes"), "{said}");
}
