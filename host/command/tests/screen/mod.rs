//! A screen that nobody sees, with a hand on its mouse and keys: Xvfb, and what X calls XTEST.

// Every test program compiles this file and uses its own share of it.
#![allow(dead_code)]

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use x11rb::connection::Connection;
use x11rb::protocol::xproto::{
    BUTTON_PRESS_EVENT, BUTTON_RELEASE_EVENT, ConnectionExt, ImageFormat, InputFocus, KEY_PRESS_EVENT,
    KEY_RELEASE_EVENT, MOTION_NOTIFY_EVENT, MapState, Window,
};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;

/// Many times what anything takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(240);

/// Its symbol; Latin letters are their own.
const CTRL: u32 = 0xffe3;

pub struct Screen {
    server: Child,
    /// Its name, for those who draw on it.
    pub display: String,
    connection: RustConnection,
    root: Window,
}

impl Screen {
    /// Of 800 x 600 pixels. None where Xvfb is not installed, unless it must be.
    pub fn new() -> Option<Screen> {
        let mut command = Command::new("Xvfb");
        command.args(["-displayfd", "1", "-screen", "0", "800x600x24", "-nolisten", "tcp"]);
        let server = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn();
        let mut server = match server {
            Ok(server) => server,
            Err(error) => {
                let required = std::env::var("EYERAYS_REQUIRE_SCREEN").is_ok_and(|value| value == "1");
                assert!(!required, "EYERAYS_REQUIRE_SCREEN=1, but Xvfb does not start: {error}");
                eprintln!("skipped: Xvfb does not start: {error}");
                return None;
            }
        };
        let mut number = String::new();
        BufReader::new(server.stdout.take().expect("it is piped"))
            .read_line(&mut number)
            .expect("Xvfb tells its number");
        let display = format!(":{}", number.trim());
        let (connection, screen) = x11rb::connect(Some(&display)).expect("Xvfb is there");
        let root = connection.setup().roots[screen].root;
        Some(Screen { server, display, connection, root })
    }

    /// The window that is open, once there is one.
    pub fn window(&self) -> Window {
        let window = until("a window", || {
            let tree = self.connection.query_tree(self.root).unwrap().reply().unwrap();
            tree.children.into_iter().find(|&child| {
                let told = self.connection.get_window_attributes(child).unwrap().reply();
                told.is_ok_and(|told| told.map_state == MapState::VIEWABLE) && self.size(child).0 > 100
            })
        });
        self.connection.set_input_focus(InputFocus::PARENT, window, 0u32).unwrap().check().unwrap();
        window
    }

    /// A window's columns and rows.
    pub fn size(&self, window: Window) -> (u32, u32) {
        let told = self.connection.get_geometry(window).unwrap().reply();
        told.map_or((0, 0), |told| (told.width.into(), told.height.into()))
    }

    /// Takes a window off the screen, or puts it there again.
    pub fn minimise(&self, window: Window, is_small: bool) {
        let cookie = if is_small { self.connection.unmap_window(window) } else { self.connection.map_window(window) };
        cookie.unwrap().check().unwrap();
        if !is_small {
            self.connection.set_input_focus(InputFocus::PARENT, window, 0u32).unwrap().check().unwrap();
        }
    }

    /// Has it gone?
    pub fn is_closed(&self, window: Window) -> bool {
        self.connection.get_geometry(window).unwrap().reply().is_err()
    }

    /// Asks for another size.
    pub fn resize(&self, window: Window, width: u32, height: u32) {
        let size = x11rb::protocol::xproto::ConfigureWindowAux::new().width(width).height(height);
        self.connection.configure_window(window, &size).unwrap().check().unwrap();
    }

    /// What a window shows in its upper left corner: red, green, blue.
    pub fn pixels(&self, window: Window, (width, height): (u32, u32)) -> Option<Vec<[u8; 3]>> {
        let (width, height) = (width as u16, height as u16);
        let image = self.connection.get_image(ImageFormat::Z_PIXMAP, window, 0, 0, width, height, !0).unwrap();
        let data = image.reply().ok()?.data;
        Some(data.as_chunks().0.iter().map(|&[blue, green, red, _]| [red, green, blue]).collect())
    }

    fn fake(&self, kind: u8, detail: u8, x: i16, y: i16) {
        self.connection.xtest_fake_input(kind, detail, 0, self.root, x, y, 0).unwrap().check().unwrap();
        self.connection.sync().unwrap();
        // A frame of the window lies between what a hand does.
        thread::sleep(Duration::from_millis(30));
    }

    /// Presses a key and lets it go.
    pub fn press(&self, symbol: u32) {
        self.fake(KEY_PRESS_EVENT, self.code(symbol), 0, 0);
        self.fake(KEY_RELEASE_EVENT, self.code(symbol), 0, 0);
    }

    /// The same with ctrl held.
    pub fn press_with_ctrl(&self, symbol: u32) {
        self.fake(KEY_PRESS_EVENT, self.code(CTRL), 0, 0);
        self.press(symbol);
        self.fake(KEY_RELEASE_EVENT, self.code(CTRL), 0, 0);
    }

    fn code(&self, symbol: u32) -> u8 {
        let setup = self.connection.setup();
        let (first, count) = (setup.min_keycode, setup.max_keycode - setup.min_keycode + 1);
        let map = self.connection.get_keyboard_mapping(first, count).unwrap().reply().unwrap();
        let place = map.keysyms.chunks(map.keysyms_per_keycode.into()).position(|keys| keys[0] == symbol);
        first + u8::try_from(place.expect("the keyboard has the key")).unwrap()
    }

    /// Puts the mouse somewhere.
    pub fn point(&self, x: i16, y: i16) {
        self.fake(MOTION_NOTIFY_EVENT, 0, x, y);
    }

    /// Presses the first button and lets it go.
    pub fn click(&self, x: i16, y: i16) {
        self.drag((x, y), (x, y));
    }

    /// Drags with the first button, in steps.
    pub fn drag(&self, from: (i16, i16), to: (i16, i16)) {
        self.point(from.0, from.1);
        self.fake(BUTTON_PRESS_EVENT, 1, 0, 0);
        if from != to {
            for step in 1..=4 {
                self.point(from.0 + (to.0 - from.0) * step / 4, from.1 + (to.1 - from.1) * step / 4);
            }
        }
        self.fake(BUTTON_RELEASE_EVENT, 1, 0, 0);
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// Asks until there is an answer.
pub fn until<T>(what: &str, mut ask: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(answer) = ask() {
            return answer;
        }
        assert!(start.elapsed() < PATIENCE, "there is still no {what}");
        thread::sleep(Duration::from_millis(30));
    }
}
