//! The window on a screen, with mouse and keys: what it shows has the bytes of pictures that `render` writes.
#![cfg(all(target_os = "linux", feature = "view"))]

mod program;
mod screen;

use std::fs;
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

use program::{Place, decoded, has_gpu};
use screen::{Screen, until};

const SIZE: (u32, u32) = (320, 240);

/// Two spheres of which one moves, a floor and a lamp.
const SCENE: &str = "\
[render]
size = [320, 240]
samples = 2

[[camera]]
name = \"front\"
eye = [0.0, 1.0, 6.0]
target = [0.0, 0.5, 0.0]

[[light]]
kind = \"point\"
position = [3.0, 5.0, 4.0]
color = [0.9, 0.9, 0.9]

[[material]]
name = \"red\"
diffuse = [0.8, 0.2, 0.1]

[[mesh]]
shape = \"sphere\"
material = \"red\"

[[mesh]]
shape = \"sphere\"
translate = [1.5, 0.5, 0.0]
scale = 0.5

[[mesh.key]]
time = 0.0

[[mesh.key]]
time = 4.0
translate = [-1.5, 1.5, 0.0]
";

/// A window that is open.
struct Open<'a> {
    screen: &'a Screen,
    window: u32,
    process: Child,
    /// What it has printed so far.
    printed: Arc<Mutex<String>>,
}

impl<'a> Open<'a> {
    fn new(screen: &'a Screen, place: &Place, arguments: &[&str]) -> Open<'a> {
        let mut command: Command = place.command(arguments);
        command.env("DISPLAY", &screen.display).env_remove("WAYLAND_DISPLAY");
        // Lavapipe optimizes kernels for as long as others let it.
        command.env("GALLIVM_PERF", "nopt");
        let mut process = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let lines = BufReader::new(process.stdout.take().expect("it is piped")).lines();
        let printed = Arc::new(Mutex::new(String::new()));
        let own = printed.clone();
        thread::spawn(move || lines.map_while(Result::ok).for_each(|line| *own.lock().unwrap() += &(line + "\n")));
        Open { screen, window: screen.window(), process, printed }
    }

    fn pixels(&self) -> Option<Vec<[u8; 3]>> {
        self.screen.pixels(self.window, SIZE)
    }

    /// Waits until the window shows a picture, byte by byte.
    fn shows(&self, what: &str, wanted: &[[u8; 3]]) {
        until(what, || (self.pixels()? == wanted).then_some(()));
    }

    /// Waits until it shows something else.
    fn shows_other(&self, what: &str, than: &[[u8; 3]]) -> Vec<[u8; 3]> {
        until(what, || self.pixels().filter(|pixels| pixels != than))
    }

    /// Waits until it has printed a text.
    fn prints(&self, text: &str) {
        until(&format!("{text:?} printed"), || self.printed.lock().unwrap().contains(text).then_some(()));
    }

    /// Closes it by its key.
    fn close(mut self) {
        self.screen.press_with_ctrl('q'.into());
        until("end", || self.process.try_wait().unwrap());
        let output = self.process.wait_with_output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), said.as_str()), (Some(0), ""));
    }
}

/// What `render` writes of the scene.
fn rendered(place: &Place, more: &[&str]) -> Vec<[u8; 3]> {
    let arguments = [&["render", "scene.toml", "--device", "cpu", "-q", "-o", "want.png"], more].concat();
    place.succeed(&arguments);
    decoded(&place.path("want.png"))
}

/// All that a hand does, on one device first and then on the other.
fn used(device: &str) {
    let Some(screen) = Screen::new() else { return };
    let place = Place::new(&[("scene.toml", SCENE)]);
    let first = rendered(&place, &[]);
    let open = Open::new(&screen, &place, &["view", "scene.toml", "--size", "320x240", "--device", device]);
    open.shows("picture", &first);

    screen.drag((160, 120), (220, 130));
    let turned = open.shows_other("turned picture", &first);
    screen.press('r'.into());
    open.shows("first picture again", &first);
    assert_ne!(turned, first);

    screen.press('g'.into());
    open.shows("same picture of another device", &first);

    let text = SCENE.replace("[0.8, 0.2, 0.1]", "[0.1, 0.2, 0.8]");
    fs::write(place.path("scene.toml"), &text).unwrap();
    let blue = rendered(&place, &[]);
    open.shows("picture of the changed file", &blue);
    fs::write(place.path("scene.toml"), "[[light]\n").unwrap();
    thread::sleep(Duration::from_millis(600));
    open.shows("last good picture", &blue);
    fs::write(place.path("scene.toml"), &text).unwrap();
    open.shows("picture of the mended file", &blue);

    screen.press(' '.into());
    open.shows_other("picture of another moment", &blue);
    screen.press(' '.into());

    screen.click(150, 135);
    open.prints("material \"red\"");
    screen.press_with_ctrl('s'.into());
    until("camera in the file", || {
        fs::read_to_string(place.path("scene.toml")).ok()?.contains("front 2").then_some(())
    });
    screen.press('n'.into());
    screen.press('c'.into());
    open.prints("[[camera]]");
    open.prints("eye = [0.0, 1.0, 6.0]");
    open.close();
}

#[test]
fn a_window_of_the_cpu_does_all_that_a_hand_asks() {
    used("cpu");
}

#[test]
fn a_window_of_a_gpu_does_all_that_a_hand_asks() {
    if has_gpu() {
        used("gpu");
    }
}

#[test]
fn two_hundred_sizes_ten_minimisings_and_an_end_in_the_middle_of_a_picture_leave_nothing_behind() {
    let Some(screen) = Screen::new() else { return };
    let place = Place::new(&[("scene.toml", SCENE)]);
    let mut open = Open::new(&screen, &place, &["view", "scene.toml", "--device", "cpu", "--samples", "16"]);
    for step in 0..200u32 {
        screen.resize(open.window, 200 + step * 37 % 400, 150 + step * 53 % 400);
        thread::sleep(Duration::from_millis(10));
        assert!(open.process.try_wait().unwrap().is_none(), "it has ended at size {step}");
        if step.is_multiple_of(20) {
            screen.minimise(open.window, true);
            thread::sleep(Duration::from_millis(50));
            screen.minimise(open.window, false);
        }
    }
    open.close();
}

#[test]
fn without_a_screen_there_is_one_line() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    let mut command = place.command(&["view", "scene.toml"]);
    command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET");
    place
        .refuse_run(&mut command, &["the window can't be opened: neither", "is set: a window takes", "eyerays render"]);
    let mut command = place.command(&["view", "-"]);
    place.refuse_run(&mut command, &["name its file"]);
}
