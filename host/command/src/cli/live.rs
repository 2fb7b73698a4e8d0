//! Pictures that somebody watches while they are rendered: sent to tev by its protocol
//! (<https://github.com/Tom94/tev>, `src/python/ipc.py` there), or to a window of this program, which speaks it, too.

use std::cell::{Cell, RefCell};
use std::io::{self, Write};
#[cfg(feature = "view")]
use std::io::{BufRead, BufReader, Read};
use std::net::{TcpStream, ToSocketAddrs};
#[cfg(feature = "view")]
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use super::look::Look;
use crate::error::{Error, Result};
use eyerays::picture::Picture;

/// What stands for a window of this program.
pub(super) const WINDOW: &str = "window";

/// Between two pictures.
const EVERY: Duration = Duration::from_millis(250);
/// A viewer that takes nothing for so long has gone.
const PATIENCE: Duration = Duration::from_secs(5);
/// Pictures are sent in bands of about so many bytes.
const BAND: usize = 4 << 20;

/// Kinds of packets.
const CREATE: u8 = 4;
const UPDATE: u8 = 6;

/// A viewer that pictures are sent to, until it goes.
pub(super) struct Live {
    stream: RefCell<Option<TcpStream>>,
    /// By that name users know it.
    viewer: String,
    /// The picture that was sent last, with its size.
    shown: RefCell<Option<(String, (u32, u32))>>,
    sent: Cell<Option<Instant>>,
}

/// Reads what is written after `--live`.
pub(super) fn viewer(text: &str) -> std::result::Result<String, String> {
    let has_port = text.rsplit_once(':').is_some_and(|(host, port)| !host.is_empty() && port.parse::<u16>().is_ok());
    if has_port || text == WINDOW {
        return Ok(text.to_owned());
    }
    Err(format!("{text:?} is no HOST:PORT: name one, such as localhost:14158, or write --live last for a window"))
}

impl Live {
    /// Of a viewer as [`viewer`] reads it, for pictures of a size if that is known.
    ///
    /// # Errors
    /// There is none.
    pub fn open(viewer: &str, look: &Look, size: Option<(u32, u32)>) -> Result<Live> {
        if viewer == WINDOW { Live::window(look, size) } else { Live::connect(viewer) }
    }

    /// Of a viewer that listens at HOST:PORT.
    ///
    /// # Errors
    /// Nobody does.
    fn connect(viewer: &str) -> Result<Live> {
        let refused = |why: &dyn std::fmt::Display| {
            Error::new(format!("--live {viewer}: {why}: start tev there, which listens at port 14158, or leave it out"))
        };
        let addresses = viewer.to_socket_addrs().map_err(|error| refused(&error))?;
        let mut last = io::Error::other("no such host");
        for address in addresses {
            match TcpStream::connect_timeout(&address, PATIENCE) {
                Ok(stream) => {
                    stream.set_write_timeout(Some(PATIENCE)).map_err(|error| refused(&error))?;
                    return Ok(Live::of(stream, viewer));
                }
                Err(error) => last = error,
            }
        }
        Err(refused(&last))
    }

    fn of(stream: TcpStream, viewer: &str) -> Live {
        let (shown, sent) = Default::default();
        Live { stream: RefCell::new(Some(stream)), viewer: viewer.to_owned(), shown, sent }
    }

    /// A window of this program, in a process of its own: it stays open when the rendering is done.
    #[cfg(feature = "view")]
    fn window(look: &Look, size: Option<(u32, u32)>) -> Result<Live> {
        let cannot = |error: io::Error| Error::new(format!("--live: the window can't be opened: {error}"));
        let mut command = Command::new(std::env::current_exe().map_err(cannot)?);
        command.args(["listen", "127.0.0.1:0"]).args(look.arguments());
        command.args(size.map(|(width, height)| format!("--size={width}x{height}")));
        // What ends the rendering leaves the window open.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut window = command.spawn().map_err(cannot)?;
        let (said, mut wrong) =
            (window.stdout.take().expect("it is piped"), window.stderr.take().expect("it is piped"));
        let mut place = String::new();
        BufReader::new(said).read_line(&mut place).map_err(cannot)?;
        if place.is_empty() {
            let mut why = String::new();
            wrong.read_to_string(&mut why).map_err(cannot)?;
            let why = why.trim().trim_start_matches("error: ").to_owned();
            return Err(Error::new(format!("--live: {why}; tev shows pictures, too: name its HOST:PORT")));
        }
        Live::connect(place.trim()).map(|live| Live { viewer: WINDOW.to_owned(), ..live })
    }

    #[cfg(not(feature = "view"))]
    fn window(_: &Look, _: Option<(u32, u32)>) -> Result<Live> {
        Err(Error::new(
            "--live: this program was built without its window: name tev as HOST:PORT, or build it with the feature view",
        ))
    }

    /// Is it time for another picture?
    pub fn is_due(&self) -> bool {
        self.stream.borrow().is_some() && self.sent.get().is_none_or(|sent| sent.elapsed() >= EVERY)
    }

    /// Sends a picture by its name.
    ///
    /// # Errors
    /// The viewer has gone. That is said once; nothing is sent to it any more.
    pub fn send(&self, name: &str, picture: &Picture) -> Result<()> {
        let Some(mut stream) = self.stream.take() else { return Ok(()) };
        if let Err(error) = self.put(&mut stream, name, picture) {
            // Who closes our window knows that.
            let is_window = self.viewer == WINDOW;
            let gone = || Error::new(format!("--live {}: {error}; the rendering goes on without it", self.viewer));
            return if is_window { Ok(()) } else { Err(gone()) };
        }
        self.sent.set(Some(Instant::now()));
        self.stream.replace(Some(stream));
        Ok(())
    }

    fn put(&self, stream: &mut impl Write, name: &str, picture: &Picture) -> io::Result<()> {
        // A name ends at its first 0.
        let name = name.replace('\0', "");
        let channels = if picture.alpha.is_some() { &["R", "G", "B", "A"][..] } else { &["R", "G", "B"] };
        let now = Some((name.clone(), (picture.width, picture.height)));
        if *self.shown.borrow() != now {
            stream.write_all(&created(&name, (picture.width, picture.height), channels))?;
            self.shown.replace(now);
        }
        let rows = (BAND / (4 * channels.len() * picture.width as usize)).clamp(1, picture.height as usize);
        for top in (0..picture.height as usize).step_by(rows) {
            let band = top..(top + rows).min(picture.height as usize);
            stream.write_all(&updated(&name, picture, band, channels))?;
        }
        stream.flush()
    }
}

/// A packet under way: its length stands first.
struct Packet(Vec<u8>);

impl Packet {
    fn new(kind: u8, name: &str) -> Packet {
        let focus = u8::from(kind == CREATE);
        Packet(vec![0, 0, 0, 0, kind, focus]).text(name)
    }

    fn text(mut self, text: &str) -> Packet {
        self.0.extend_from_slice(text.as_bytes());
        self.0.push(0);
        self
    }

    fn int(mut self, value: usize) -> Packet {
        self.0.extend_from_slice(&(value as i32).to_le_bytes());
        self
    }

    fn long(mut self, value: usize) -> Packet {
        self.0.extend_from_slice(&(value as i64).to_le_bytes());
        self
    }

    fn done(mut self) -> Vec<u8> {
        let length = self.0.len() as u32;
        self.0[..4].copy_from_slice(&length.to_le_bytes());
        self.0
    }
}

fn created(name: &str, (width, height): (u32, u32), channels: &[&str]) -> Vec<u8> {
    let packet = Packet::new(CREATE, name).int(width as usize).int(height as usize).int(channels.len());
    channels.iter().fold(packet, |packet, channel| packet.text(channel)).done()
}

/// Some rows of a picture, its channels side by side.
fn updated(name: &str, picture: &Picture, rows: std::ops::Range<usize>, channels: &[&str]) -> Vec<u8> {
    let (width, count) = (picture.width as usize, channels.len());
    let packet = channels.iter().fold(Packet::new(UPDATE, name).int(count), |packet, channel| packet.text(channel));
    let packet = packet.int(0).int(rows.start).int(width).int(rows.len());
    let packet = (0..count).fold(packet, Packet::long);
    let mut packet = (0..count).fold(packet, |packet, _| packet.long(count));
    for at in rows.start * width..rows.end * width {
        let alpha = picture.alpha.as_ref().map(|alpha| alpha[at]);
        for value in picture.pixels[at].into_iter().chain(alpha) {
            packet.0.extend_from_slice(&value.to_le_bytes());
        }
    }
    packet.done()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packets_have_the_bytes_of_the_protocol() {
        let picture = Picture::from_pixels(1, 2, vec![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]).unwrap();
        let channels = ["R", "G", "B"];
        let mut wanted = vec![27, 0, 0, 0, 4, 1, b'a', 0, 1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0];
        wanted.extend(b"R\0G\0B\0");
        wanted[0] = wanted.len() as u8;
        assert_eq!(created("a", (1, 2), &channels), wanted);
        let mut wanted = vec![0, 0, 0, 0, 6, 0, b'a', 0, 3, 0, 0, 0];
        wanted.extend(b"R\0G\0B\0");
        // The second row alone.
        wanted.extend([0, 1, 1, 1].map(i32::to_le_bytes).concat());
        wanted.extend([0, 1, 2, 3, 3, 3].map(i64::to_le_bytes).concat());
        wanted.extend([4.0, 5.0, 6.0].map(f32::to_le_bytes).concat());
        wanted[0] = wanted.len() as u8;
        assert_eq!(updated("a", &picture, 1..2, &channels), wanted);
    }
}
