//! Packets of the protocol by which renderers send pictures to tev (<https://github.com/Tom94/tev>, `src/python/ipc.py` there): their
//! length in bytes, their kind, and what that takes, all little-endian; texts end with a zero.

use std::io::{self, Read};

/// No picture's band is as large.
const MOST_BYTES: u32 = 1 << 30;
/// Nor has a picture as many columns or rows.
const MOST_EDGE: u32 = 1 << 16;
/// Or pixels.
const MOST_PIXELS: u64 = 1 << 28;
/// Or channels.
const MOST_CHANNELS: u32 = 1024;

/// What is asked for.
#[derive(Debug, PartialEq)]
pub(super) enum Packet {
    /// A picture that is black so far.
    Create { name: String, size: (u32, u32) },
    /// Some of its pixels.
    Update(Update),
    /// It is no longer shown.
    Close { name: String },
    /// Something else, which there is no need for.
    Other,
}

/// Pixels of a part of a picture.
#[derive(Debug, PartialEq)]
pub(super) struct Update {
    pub name: String,
    pub left: u32,
    pub top: u32,
    pub size: (u32, u32),
    /// Each by its name, with its values row by row.
    pub channels: Vec<(String, Vec<f32>)>,
}

/// The next packet; none at the end.
pub(super) fn next(stream: &mut impl Read) -> io::Result<Option<Packet>> {
    let mut length = [0; 4];
    match stream.read_exact(&mut length) {
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => return Ok(None),
        other => other?,
    }
    let length = u32::from_le_bytes(length);
    if !(5..=MOST_BYTES).contains(&length) {
        return Err(wrong(format!("a packet of {length} bytes")));
    }
    let mut bytes = Vec::new();
    // As much memory as there are bytes, whatever is promised.
    stream.take(u64::from(length) - 4).read_to_end(&mut bytes)?;
    if bytes.len() as u32 != length - 4 {
        return Err(wrong(format!("a packet that ends after {} of {length} bytes", bytes.len() + 4)));
    }
    Reader(&bytes).packet().map(Some)
}

fn wrong(what: impl Into<String>) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, what.into())
}

/// What is left of a packet.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn packet(mut self) -> io::Result<Packet> {
        match self.bytes()? {
            [2] => Ok(Packet::Close { name: self.text()? }),
            [4] => {
                let [_] = self.bytes()?;
                let (name, size) = (self.text()?, (self.int()?, self.int()?));
                check(size)?;
                Ok(Packet::Create { name, size })
            }
            [6] => Ok(Packet::Update(self.update()?)),
            _ => Ok(Packet::Other),
        }
    }

    fn update(&mut self) -> io::Result<Update> {
        let [_] = self.bytes()?;
        let (name, count) = (self.text()?, self.int()?);
        if count > MOST_CHANNELS {
            return Err(wrong(format!("{count} channels")));
        }
        let names = (0..count).map(|_| self.text()).collect::<io::Result<Vec<_>>>()?;
        let [left, top, width, height] = [self.int()?, self.int()?, self.int()?, self.int()?];
        check((width, height))?;
        let mut places = || (0..count).map(|_| self.long()).collect::<io::Result<Vec<_>>>();
        let (offsets, strides) = (places()?, places()?);
        let values: Vec<f32> = self.0.as_chunks().0.iter().map(|&bytes| f32::from_le_bytes(bytes)).collect();
        let pixels = width as usize * height as usize;
        let of = |((name, offset), stride): ((String, usize), usize)| {
            let at = |pixel: usize| pixel.checked_mul(stride)?.checked_add(offset);
            let channel = (0..pixels).map(|pixel| at(pixel).and_then(|at| values.get(at)).copied());
            let channel =
                channel.collect::<Option<Vec<f32>>>().ok_or_else(|| wrong(format!("too few values of {name}")));
            Ok((name, channel?))
        };
        let channels = names.into_iter().zip(offsets).zip(strides).map(of).collect::<io::Result<_>>()?;
        Ok(Update { name, left, top, size: (width, height), channels })
    }

    fn bytes<const N: usize>(&mut self) -> io::Result<[u8; N]> {
        let (bytes, rest) = self.0.split_first_chunk().ok_or_else(|| wrong("a packet that is too short"))?;
        self.0 = rest;
        Ok(*bytes)
    }

    /// A number that is not below zero.
    fn int(&mut self) -> io::Result<u32> {
        let number = i32::from_le_bytes(self.bytes()?);
        u32::try_from(number).map_err(|_| wrong(format!("{number} for a size or a place")))
    }

    fn long(&mut self) -> io::Result<usize> {
        let number = i64::from_le_bytes(self.bytes()?);
        usize::try_from(number).map_err(|_| wrong(format!("{number} for the place of a channel")))
    }

    fn text(&mut self) -> io::Result<String> {
        let end = self.0.iter().position(|&byte| byte == 0).ok_or_else(|| wrong("a text without an end"))?;
        let text = String::from_utf8_lossy(&self.0[..end]).into_owned();
        self.0 = &self.0[end + 1..];
        Ok(text)
    }
}

fn check((width, height): (u32, u32)) -> io::Result<()> {
    let is_picture = |edge: u32| (1..=MOST_EDGE).contains(&edge);
    if is_picture(width) && is_picture(height) && u64::from(width) * u64::from(height) <= MOST_PIXELS {
        return Ok(());
    }
    Err(wrong(format!("a picture of {width}x{height} pixels")))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn packet(body: &[&[u8]]) -> Vec<u8> {
        let body = body.concat();
        [&(body.len() as u32 + 4).to_le_bytes()[..], &body].concat()
    }

    fn ints(of: &[i32]) -> Vec<u8> {
        of.iter().flat_map(|number| number.to_le_bytes()).collect()
    }

    /// One row of two pixels, of which one channel lies before the other.
    fn update() -> Vec<u8> {
        let places: Vec<u8> = [0_i64, 2, 1, 1].iter().flat_map(|number| number.to_le_bytes()).collect();
        let values: Vec<u8> = [1.0_f32, 2.0, 3.0, 4.0].iter().flat_map(|value| value.to_le_bytes()).collect();
        packet(&[&[6, 0], b"a\0", &ints(&[2]), b"R\0G\0", &ints(&[5, 7, 2, 1]), &places, &values])
    }

    #[test]
    fn packets_are_read_as_they_were_written() {
        let create = packet(&[&[4, 1], b"a\0", &ints(&[3, 2, 1]), b"R\0"]);
        let all = [create, update(), packet(&[&[2], b"a\0"]), packet(&[&[0], b"x"])].concat();
        let mut stream = &all[..];
        let read: Vec<Packet> = std::iter::from_fn(|| next(&mut stream).unwrap()).collect();
        let channels = vec![("R".to_owned(), vec![1.0, 2.0]), ("G".to_owned(), vec![3.0, 4.0])];
        let update = Update { name: "a".to_owned(), left: 5, top: 7, size: (2, 1), channels };
        let name = || "a".to_owned();
        let wanted = [
            Packet::Create { name: name(), size: (3, 2) },
            Packet::Update(update),
            Packet::Close { name: name() },
            Packet::Other,
        ];
        assert_eq!(read, wanted);
    }

    #[test]
    fn sizes_that_no_picture_has_are_refused() {
        for size in [[0, 1], [-1, 4], [1 << 17, 1], [1 << 16, 1 << 16], [i32::MAX, i32::MAX]] {
            let create = packet(&[&[4, 1], b"a\0", &ints(&size), &ints(&[0])]);
            assert!(next(&mut &create[..]).is_err(), "{size:?}");
        }
        assert!(next(&mut &u32::MAX.to_le_bytes()[..]).is_err());
    }

    proptest! {
        #[test]
        fn no_bytes_whatever_are_too_much(cut in 0..80_usize, at in 0..80_usize, byte: u8) {
            let mut bytes = update();
            bytes.truncate(bytes.len().saturating_sub(cut));
            if let Some(place) = bytes.get_mut(at) {
                *place = byte;
            }
            let mut stream = &bytes[..];
            while let Ok(Some(_)) = next(&mut stream) {}
        }
    }
}
