//! What a signal leaves: nothing half-written, the old files, and its number as the exit code.
#![cfg(target_os = "linux")]

mod program;

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use program::{Place, TRIANGLE, shipped};

const CODES: [(&str, i32); 3] = [("HUP", 129), ("INT", 130), ("TERM", 143)];

/// The program, whose signals are not ignored even where those of the tests are, as by `nohup`.
fn heeding(place: &Place, arguments: &[&str]) -> Command {
    let program = place.command(arguments);
    let mut command = Command::new("env");
    command.arg("--default-signal=HUP,INT,TERM").arg(program.get_program()).args(program.get_args());
    command.current_dir(place.path("")).env_remove("RUST_LOG");
    command
}

fn send(child: &Child, signal: &str) {
    let sent = Command::new("kill").args(["-s", signal, &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
}

fn interrupted(mut child: Child, signal: &str) -> ExitStatus {
    send(&child, signal);
    child.wait().unwrap()
}

/// Whether the mesh is begun.
fn is_writing(place: &Place) -> bool {
    let mut entries = fs::read_dir(place.path("")).unwrap().flatten();
    let is_large = |entry: &fs::DirEntry| entry.metadata().is_ok_and(|found| found.len() > 1 << 16);
    entries.any(|entry| entry.file_name().as_encoded_bytes().ends_with(b".tmp") && is_large(&entry))
}

/// A mesh of so many triangles takes seconds to write.
#[test]
fn an_interrupt_while_writing_keeps_the_old_files_and_leaves_nothing() {
    let place = Place::new(&[]);
    let generate = |triangles| heeding(&place, &["generate", "hall", "--triangles", triangles, "-q"]);
    assert!(generate("6000").status().unwrap().success());
    let names = ["hall.mtl", "hall.obj", "hall.toml"];
    let old = names.map(|name| fs::read(place.path(name)).unwrap());
    for (signal, code) in CODES {
        let child = generate("20000000").spawn().unwrap();
        let start = Instant::now();
        while !is_writing(&place) {
            assert!(start.elapsed() < Duration::from_secs(60), "it writes nothing");
        }
        assert_eq!(interrupted(child, signal).code(), Some(code));
        assert_eq!(place.names(), names);
        assert_eq!(names.map(|name| fs::read(place.path(name)).unwrap()), old);
    }
}

/// Of one sample.
#[test]
fn an_interrupt_ends_a_rendering_at_once_that_has_nothing_to_keep() {
    let place = Place::new(&[("mesh.obj", &format!("mtllib missing.mtl\n{TRIANGLE}"))]);
    let render = ["render", "mesh.obj", "--device", "cpu", "--size", "6000x6000", "--threads", "1"];
    for (signal, code) in CODES {
        let mut child = heeding(&place, &render).stderr(Stdio::piped()).spawn().unwrap();
        // The warning, after which it renders for seconds.
        let mut line = String::new();
        BufReader::new(child.stderr.as_mut().unwrap()).read_line(&mut line).unwrap();
        let start = Instant::now();
        assert_eq!(interrupted(child, signal).code(), Some(code), "{line}");
        assert!(start.elapsed() < Duration::from_secs(5));
        assert_eq!(place.names(), ["mesh.obj"]);
    }
}

/// A rendering that takes an hour, and its first pictures so far.
fn long_rendering(place: &Place) -> Child {
    let scene = shipped("bleeding");
    let render = ["render", &scene, "--device", "cpu", "--size", "64x48", "--spp", "16000000"];
    let child = heeding(place, &[&render[..], &["--preview-every", "0.05", "-o", "a.exr"]].concat())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let start = Instant::now();
    while !place.path("a.exr").exists() {
        assert!(start.elapsed() < Duration::from_secs(60), "there is no picture so far");
    }
    child
}

/// What it says, once it ends.
fn said(child: &mut Child) -> String {
    let mut said = String::new();
    child.stderr.as_mut().unwrap().read_to_string(&mut said).unwrap();
    said
}

#[test]
fn an_interrupt_of_a_rendering_keeps_the_samples_that_are_done() {
    for (signal, code) in CODES {
        let place = Place::new(&[]);
        let mut child = long_rendering(&place);
        send(&child, signal);
        let said = said(&mut child);
        assert_eq!(child.wait().unwrap().code(), Some(code), "{said}");
        let line = said.lines().find_map(|line| line.strip_prefix("ended after "));
        let samples = line.and_then(|line| line.split(' ').next()).unwrap_or_else(|| panic!("{said}"));
        assert!(said.contains("of 16000000 samples") && said.contains("a.exr.film has what is done"), "{said}");
        // With what it takes to go on.
        assert_eq!(place.names(), ["a.exr", "a.exr.film"]);
        let render = ["render", &shipped("bleeding"), "--device", "cpu", "--size", "64x48", "-o", "b.exr", "-q"];
        place.succeed(&[&render[..], &["--spp", samples]].concat());
        place.succeed(&["diff", "a.exr", "b.exr"]);
    }
}

/// However it ends: the picture so far is whole.
#[test]
fn a_rendering_that_is_killed_leaves_its_picture_so_far() {
    let place = Place::new(&[]);
    for wait in 0..4 {
        let child = long_rendering(&place);
        std::thread::sleep(Duration::from_millis(77 * wait));
        interrupted(child, "KILL");
        place.succeed(&["diff", "a.exr", "a.exr"]);
    }
}

#[test]
fn a_second_interrupt_ends_a_rendering_at_once() {
    let place = Place::new(&[]);
    let scene = shipped("bleeding");
    let render = ["render", &scene, "--device", "cpu", "--size", "4096x4096", "--threads", "1", "--preview-every", "0"];
    for (signal, code) in CODES {
        let mut child = heeding(&place, &render).stderr(Stdio::piped()).spawn().unwrap();
        let mut said = String::new();
        let start = Instant::now();
        // Too early it would end the program, which has nothing to render yet.
        std::thread::sleep(Duration::from_secs(3));
        send(&child, signal);
        BufReader::new(child.stderr.as_mut().unwrap()).read_line(&mut said).unwrap();
        assert!(said.contains("once more ends at once"), "{said}");
        assert_eq!(interrupted(child, signal).code(), Some(code));
        assert!(start.elapsed() < Duration::from_secs(10), "its first sample takes longer");
        assert!(place.names().is_empty());
    }
}

/// As `nohup` starts it.
#[test]
fn a_signal_that_was_ignored_stays_so() {
    let place = Place::new(&[]);
    let program = place.command(&["generate", "hall", "--triangles", "1000000", "-q"]);
    let mut shell = Command::new("sh");
    shell.args(["-c", "trap '' HUP; exec \"$@\"", "sh"]).arg(program.get_program()).args(program.get_args());
    let child = shell.current_dir(place.path("")).spawn().unwrap();
    while !is_writing(&place) {}
    assert!(interrupted(child, "HUP").success());
    assert_eq!(place.names(), ["hall.mtl", "hall.obj", "hall.toml"]);
}

/// The system lets it write 8 KiB; a picture of noise takes more.
#[test]
fn a_picture_that_is_larger_than_files_may_be_is_refused_and_leaves_nothing() {
    let place = Place::new(&[("mesh.obj", TRIANGLE)]);
    let program = place.command(&["render", "mesh.obj", "--device", "cpu", "--size", "300x300", "-o", "p.hdr", "-q"]);
    let mut limited = Command::new("bash");
    limited.args(["-c", "ulimit -f 8; exec \"$0\" \"$@\""]).arg(program.get_program()).args(program.get_args());
    limited.current_dir(place.path("")).env_remove("RUST_LOG");
    place.refuse_run(&mut limited, &["p.hdr", "ulimit -f"]);
}
