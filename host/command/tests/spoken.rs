//! What the command says: it never stops what is done, steers no terminal, and drivers add nothing.

mod program;

use std::fs::{self, File};
use std::process::{Command, Stdio};

use eyerays::line::steers;
use program::{Place, SCENE, TRIANGLE, has_gpu};

/// The code of a command whose standard output nobody reads, and what it said.
fn unread(command: &mut Command) -> (Option<i32>, String) {
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let output = command.stdout(writer).output().unwrap();
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

/// Runs something of every command that prints.
const PRINTING: [&[&str]; 8] = [
    &["info"],
    &["info", "scene.toml", "--json"],
    &["check", "scene.toml"],
    &["render", "scene.toml", "-q", "--device", "cpu", "-o", "-"],
    &["render", "scene.toml", "--device", "cpu", "-o", "out.png", "--json"],
    &["bench", "scene.toml", "-q", "--quick", "--device", "cpu", "--size", "8x8", "--methods", "auto"],
    &["--help"],
    &["--version"],
];

#[test]
fn a_reader_that_is_gone_ends_nothing() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    for arguments in PRINTING {
        assert_eq!(unread(&mut place.command(arguments)), (Some(0), String::new()), "{arguments:?}");
    }
    for (name, eye) in [("a.exr", "0,0,4"), ("b.exr", "0,1,4")] {
        place.succeed(&["render", "scene.toml", "--device", "cpu", "-o", name, "--eye", eye, "--target", "0,0,0"]);
    }
    assert_eq!(unread(&mut place.command(&["diff", "a.exr", "b.exr"])), (Some(1), String::new()));
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_output_is_named() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    for arguments in PRINTING {
        let full = File::options().write(true).open("/dev/full").unwrap();
        let output = place.command(arguments).stdout(full).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(said, "error: standard output: no space left; free some or write elsewhere\n", "{arguments:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_closed_or_full_standard_error_stops_nothing() {
    let warned = format!("mtllib missing.mtl\n{TRIANGLE}");
    let place = Place::new(&[("mesh.obj", &warned), ("scene.toml", SCENE)]);
    let render = ["render", "mesh.obj", "-o", "out.png", "--size", "8x8", "--device", "cpu"];
    let full = || File::options().write(true).open("/dev/full").unwrap().into();
    let closed = || {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        Stdio::from(writer)
    };
    for stderr in [&full as &dyn Fn() -> Stdio, &closed] {
        let code = |arguments: &[&str]| place.command(arguments).stderr(stderr()).status().unwrap().code();
        assert_eq!(code(&render), Some(0));
        fs::remove_file(place.path("out.png")).unwrap();
        assert_eq!(place.command(&render).env("RUST_LOG", "trace").stderr(stderr()).status().unwrap().code(), Some(0));
        fs::remove_file(place.path("out.png")).unwrap();
        assert_eq!(code(&["check", "missing.toml"]), Some(2));
        assert_eq!(code(&["check"]), Some(2));
        assert_eq!(code(&["generate", "hall", "--triangles", "6000"]), Some(0));
        place.succeed(&["check", "hall.toml"]);
    }
}

#[test]
fn names_steer_no_terminal() {
    let scene = SCENE.replace("\"front\"", r#""a\u001b[2J\u009b1m\u202e\nerror: forged""#);
    let place = Place::new(&[("scene.toml", &scene), ("spot.obj", TRIANGLE)]);
    fs::rename(place.path("spot.obj"), place.path("a\u{9b}1m\u{202e}.obj")).unwrap();
    place.succeed(&["render", "scene.toml", "--device", "cpu", "-o", "a\u{9b}1m\u{202e}.png"]);
    for arguments in [
        &["check", "scene.toml"][..],
        &["check", "a\u{9b}1m\u{202e}.obj"],
        &["check", "a\u{9b}1m\u{202e}.png"],
        &["check", "scene.toml", "a\u{9b}1m\u{202e}.obj"],
        &["render", "scene.toml", "--device", "cpu", "-o", "a\u{9b}1m\u{202e}.png"],
        &["render", "scene.toml", "--device", "cpu", "-o", "a\u{9b}1m\u{202e}.png", "--json"],
        &["diff", "a\u{9b}1m\u{202e}.png", "a\u{9b}1m\u{202e}.png"],
        &["info", "a\u{9b}1m\u{202e}.obj", "--json"],
        &["bench", "scene.toml", "--quick", "--device", "cpu", "--size", "8x8", "--methods", "auto"],
        &["bench", "scene.toml", "--quick", "--device", "cpu", "--size", "8x8", "--methods", "auto", "--format", "csv"],
        &[
            "bench",
            "scene.toml",
            "--quick",
            "--device",
            "cpu",
            "--size",
            "8x8",
            "--methods",
            "auto",
            "--format",
            "json",
        ],
    ] {
        let outcome = place.run(arguments);
        if arguments.iter().any(|argument| argument.ends_with("json")) {
            outcome.json();
        }
        for text in [outcome.text(), &outcome.stderr] {
            assert!(text.chars().all(|c| c == '\n' || !steers(c)), "{arguments:?}: {text:?}");
            // A line end in quotes is CSV's.
            assert!(arguments.contains(&"csv") || !text.contains("\nerror: forged"), "{arguments:?}: {text:?}");
        }
    }
}

/// The Wayland library, which Vulkan's layers ask for a display, complains without it.
#[cfg(target_os = "linux")]
#[test]
fn drivers_add_nothing() {
    if !has_gpu() {
        return;
    }
    let place = Place::new(&[("scene.toml", SCENE)]);
    for arguments in [&["info"][..], &["render", "scene.toml", "-q", "--device", "gpu", "-o", "out.png"]] {
        let output = place.command(arguments).env_remove("XDG_RUNTIME_DIR").output().unwrap();
        assert_eq!((output.status.code(), String::from_utf8(output.stderr).unwrap()), (Some(0), String::new()));
    }
    // And what comes after is heard again.
    let output = place.command(&["render", "scene.toml", "--device", "gpu", "-o", "out.png"]).output().unwrap();
    assert!(output.stderr.starts_with(b"out.png: 24x18"));
}

/// Vulkan's loader writes to standard error itself what this variable asks for.
#[cfg(target_os = "linux")]
#[test]
fn drivers_are_heard_where_warnings_are_asked_for() {
    if !has_gpu() {
        return;
    }
    let place = Place::new(&[]);
    let said = |arguments: &[&str]| {
        let output = place.command(arguments).env("VK_LOADER_DEBUG", "all").output().unwrap();
        assert!(output.status.success());
        !output.stderr.is_empty()
    };
    assert!(!said(&["info"]) && said(&["info", "-v"]));
}
