//! The pictures that were sent, and who receives them.

use std::collections::BTreeMap;
use std::io::{self, BufReader};
use std::net::{TcpListener, TcpStream};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;

use eyerays::picture::Picture;

use super::packet::{self, Packet, Update};

/// Pictures by their names.
#[derive(Default)]
pub(super) struct Desk(Mutex<Pictures>);

/// Which there are, and which is shown.
#[derive(Default)]
pub(super) struct Pictures {
    all: BTreeMap<String, Picture>,
    shown: String,
    /// How often something has changed.
    pub version: u64,
    /// What is wrong with what was sent last.
    pub fault: Option<String>,
}

impl Pictures {
    /// The one that is shown, with its name.
    pub fn shown(&self) -> Option<(&str, &Picture)> {
        self.all.get_key_value(&self.shown).map(|(name, picture)| (name.as_str(), picture))
    }

    fn take(&mut self, packet: Packet) -> io::Result<()> {
        match packet {
            Packet::Create { name, size: (width, height) } => {
                let pixels = vec![[0.0; 3]; width as usize * height as usize];
                let picture = Picture::from_pixels(width, height, pixels).map_err(io::Error::other)?;
                self.all.insert(name.clone(), picture);
                self.shown = name;
            }
            Packet::Update(update) => self.update(update)?,
            Packet::Close { name } => drop(self.all.remove(&name)),
            Packet::Other => return Ok(()),
        }
        self.version += 1;
        self.fault = None;
        Ok(())
    }

    fn update(&mut self, update: Update) -> io::Result<()> {
        let Update { name, left, top, size: (width, height), channels } = update;
        let Some(picture) = self.all.get_mut(&name) else {
            return Err(io::Error::other(format!("there is no picture {name:?}")));
        };
        let fits = |start: u32, length: u32, of: u32| start.checked_add(length).is_some_and(|end| end <= of);
        if !fits(left, width, picture.width) || !fits(top, height, picture.height) {
            return Err(io::Error::other(format!("pixels outside of the picture {name:?}")));
        }
        let columns = picture.width as usize;
        let place = |at: usize| {
            let (row, column) = (at / width as usize, at % width as usize);
            (top as usize + row) * columns + left as usize + column
        };
        for (channel, values) in channels {
            if channel == "A" {
                let alpha = picture.alpha.get_or_insert_with(|| vec![1.0; picture.pixels.len()]);
                values.into_iter().enumerate().for_each(|(at, value)| alpha[place(at)] = value);
            } else if let Some(number) = ["R", "G", "B"].iter().position(|&known| known == channel) {
                values.into_iter().enumerate().for_each(|(at, value)| picture.pixels[place(at)][number] = value);
            }
        }
        self.shown = name;
        Ok(())
    }
}

impl Desk {
    /// What is there now.
    pub fn look(&self) -> MutexGuard<'_, Pictures> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Receives from everybody who connects, on threads of their own, as long as the process lives. `repaint` is called whenever there is
    /// something to be seen.
    pub fn receive(self: &Arc<Self>, listener: TcpListener, repaint: impl Fn() + Clone + Send + 'static) {
        let desk = self.clone();
        thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                let (desk, repaint) = (desk.clone(), repaint.clone());
                thread::spawn(move || {
                    if let Err(error) = desk.hear(stream, &repaint) {
                        desk.look().fault = Some(format!("{error}: what was sent is no picture for tev"));
                        repaint();
                    }
                });
            }
        });
    }

    fn hear(&self, stream: TcpStream, repaint: &dyn Fn()) -> io::Result<()> {
        let mut stream = BufReader::new(stream);
        while let Some(packet) = packet::next(&mut stream)? {
            self.look().take(packet)?;
            repaint();
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn create(name: &str) -> Packet {
        Packet::Create { name: name.to_owned(), size: (3, 2) }
    }

    fn update(name: &str, (left, top): (u32, u32), channel: &str) -> Packet {
        let channels = vec![(channel.to_owned(), vec![1.0, 2.0])];
        Packet::Update(Update { name: name.to_owned(), left, top, size: (2, 1), channels })
    }

    #[test]
    fn pixels_are_put_where_they_belong() {
        let mut pictures = Pictures::default();
        for packet in [create("a"), create("b"), update("a", (1, 1), "G"), update("a", (0, 0), "A")] {
            pictures.take(packet).unwrap();
        }
        let (name, picture) = pictures.shown().unwrap();
        let greens: Vec<f32> = picture.pixels.iter().map(|pixel| pixel[1]).collect();
        assert_eq!((name, greens), ("a", vec![0.0, 0.0, 0.0, 0.0, 1.0, 2.0]));
        assert_eq!(picture.alpha, Some(vec![1.0, 2.0, 1.0, 1.0, 1.0, 1.0]));
        pictures.take(Packet::Close { name: "a".to_owned() }).unwrap();
        assert!(pictures.shown().is_none());
    }

    #[test]
    fn pixels_outside_and_of_no_picture_are_refused() {
        let mut pictures = Pictures::default();
        pictures.take(create("a")).unwrap();
        for wrong in [
            update("b", (0, 0), "R"),
            update("a", (2, 0), "R"),
            update("a", (0, 2), "R"),
            update("a", (u32::MAX, 0), "R"),
        ] {
            assert!(pictures.take(wrong).is_err());
        }
    }
}
