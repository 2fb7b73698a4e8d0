//! Pictures that are watched while they are rendered: by a viewer that knows tev's protocol from its description alone, and by the
//! window of this program.

mod program;
#[cfg(all(target_os = "linux", feature = "view"))]
mod screen;

use std::io::Read;
use std::net::{TcpListener, TcpStream};
use std::thread;

use eyerays::image;
use program::{Place, shipped};

/// What a viewer has got.
#[derive(Default)]
struct Seen {
    name: String,
    size: (usize, usize),
    /// Red, green and blue.
    pixels: Vec<[f32; 3]>,
    /// How often the first row has come.
    pictures: usize,
}

impl Seen {
    /// All that comes until the renderer hangs up.
    fn of(mut stream: TcpStream) -> Seen {
        let (mut seen, mut bytes) = (Seen::default(), Vec::new());
        stream.read_to_end(&mut bytes).unwrap();
        let mut rest = &bytes[..];
        while !rest.is_empty() {
            let length = u32::from_le_bytes(rest[..4].try_into().unwrap()) as usize;
            seen.take(rest[4], &rest[6..length]);
            rest = &rest[length..];
        }
        seen
    }

    fn take(&mut self, kind: u8, body: &[u8]) {
        let end = body.iter().position(|&byte| byte == 0).unwrap();
        let name = String::from_utf8(body[..end].to_vec()).unwrap();
        let body = &body[end + 1..];
        let int = |at: usize| i32::from_le_bytes(body[at..at + 4].try_into().unwrap()) as usize;
        match kind {
            4 => {
                (self.name, self.size) = (name, (int(0), int(4)));
                assert_eq!((int(8), &body[12..]), (3, &b"R\0G\0B\0"[..]));
                self.pixels = vec![[-1.0; 3]; self.size.0 * self.size.1];
            }
            6 => {
                assert_eq!((name, int(0), &body[4..10]), (self.name.clone(), 3, &b"R\0G\0B\0"[..]));
                let (left, top, width, height) = (int(10), int(14), int(18), int(22));
                assert_eq!((left, width), (0, self.size.0));
                self.pictures += usize::from(top == 0);
                let values: Vec<f32> = body[26 + 48..].as_chunks().0.iter().map(|&b| f32::from_le_bytes(b)).collect();
                assert_eq!(values.len(), 3 * width * height);
                self.pixels[top * width..][..width * height].copy_from_slice(values.as_chunks().0);
            }
            other => panic!("a packet of kind {other}"),
        }
    }
}

#[test]
fn a_viewer_gets_the_picture_again_and_again_and_in_the_end_that_of_the_file() {
    let place = Place::new(&[]);
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let viewer = thread::spawn(move || Seen::of(listener.accept().unwrap().0));
    let scene = shipped("cornell_path");
    let arguments = ["--device", "cpu", "--threads", "1", "--size", "200x200", "--spp", "48", "--preview-every", "0"];
    let outcome =
        place.succeed(&[&["render", &scene, "-o", "box.exr", "--live", &address, "-q"], &arguments[..]].concat());
    assert_eq!(outcome.stderr, "");
    let (seen, wanted) = (viewer.join().unwrap(), image::read(&place.path("box.exr")).unwrap());
    assert_eq!((seen.name.as_str(), seen.size), ("box.exr", (200, 200)));
    assert_eq!(seen.pixels, wanted.pixels);
    assert!(seen.pictures > 1, "{} pictures", seen.pictures);
}

#[test]
fn a_viewer_that_is_not_there_is_told_of_and_one_that_goes_does_not_end_the_rendering() {
    let place = Place::new(&[]);
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let scene = shipped("cornell");
    let viewer = thread::spawn(move || drop(listener.accept().unwrap()));
    let arguments = ["--device", "cpu", "--size", "600x600", "-o", "box.png"];
    let outcome = place.succeed(&[&["render", &scene, "--live", &address], &arguments[..]].concat());
    viewer.join().unwrap();
    assert_eq!(outcome.stderr.matches("the rendering goes on without it").count(), 1, "{}", outcome.stderr);
    assert_eq!(place.names(), ["box.png"]);
    place.refuse(&["render", &scene, "--live", &address], &["--live", &address, "start tev"]);
    let outcome = place.run(&["render", "--live", &scene]);
    assert!(outcome.stderr.contains("is no HOST:PORT"), "{}", outcome.stderr);
}

#[cfg(all(target_os = "linux", feature = "view"))]
#[test]
fn a_window_of_its_own_shows_the_picture_and_stays() {
    let Some(screen) = screen::Screen::new() else { return };
    let place = Place::new(&[]);
    let scene = shipped("whitted");
    let mut command =
        place.command(&["render", &scene, "--device", "cpu", "--size", "320x240", "-q", "-o", "a.png", "--live"]);
    command.env("DISPLAY", &screen.display).env_remove("WAYLAND_DISPLAY");
    assert!(command.status().unwrap().success());
    let window = screen.window();
    let wanted = program::decoded(&place.path("a.png"));
    screen::until("picture", || (screen.pixels(window, (320, 240))? == wanted).then_some(()));
    screen.press_with_ctrl('q'.into());
    screen::until("end", || screen.is_closed(window).then_some(()));
}

#[cfg(all(target_os = "linux", feature = "view"))]
#[test]
fn without_a_screen_a_window_that_was_asked_for_is_told_of() {
    let place = Place::new(&[]);
    let mut command = place.command(&["render", &shipped("cornell"), "-o", "a.png", "--live"]);
    command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET");
    place.refuse_run(&mut command, &["--live: the window can't be opened", "HOST:PORT"]);
}
