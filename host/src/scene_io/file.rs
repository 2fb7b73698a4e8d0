//! Opening what a user named.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::Path;

use crate::memory::Room;
use crate::scene::Unplaced;

/// The largest mesh file that is read, in bytes.
pub const MOST_MESH: u64 = 4 << 30;
/// The largest scene or material file that is read, in bytes.
pub const MOST_TEXT: u64 = 64 << 20;

/// Files of no more bytes are read without asking how much memory there is.
const SMALL: u64 = 1 << 20;

/// A file as it was when it was opened: what is appended later is not read, and an end that comes earlier is an error.
///
/// Files are read and never mapped: a mapped file that another process cuts ends the process that looks at it.
#[derive(Debug)]
pub struct Opened {
    file: File,
    length: u64,
    left: u64,
}

impl Opened {
    /// How many bytes it has.
    pub fn length(&self) -> u64 {
        self.length
    }

    /// So many of its first bytes, or all if it has fewer.
    ///
    /// # Errors
    /// What keeps a file from being read.
    pub fn start(&mut self, count: usize) -> Unplaced<Vec<u8>> {
        let mut bytes = Vec::new();
        let most = self.length.min(count as u64);
        let read = self.by_ref().take(most).read_to_end(&mut bytes);
        read.map_err(|error| explain(&error))?;
        Ok(bytes)
    }

    /// All of its bytes, for which there is room.
    ///
    /// # Errors
    /// Too little memory, and what keeps a file from being read.
    pub fn whole(self) -> Unplaced<Vec<u8>> {
        self.whole_after(Vec::new())
    }

    /// The same, of which the first were read already.
    ///
    /// # Errors
    /// Those of [`Opened::whole`].
    pub fn whole_after(mut self, mut bytes: Vec<u8>) -> Unplaced<Vec<u8>> {
        let count = self.left;
        let none = |why: String| format!("its {count} bytes {why}; end other programs or split the file");
        if count > SMALL {
            Room::now().check(count).map_err(none)?;
        }
        let reserved = bytes.try_reserve_exact(usize::try_from(count).unwrap_or(usize::MAX));
        reserved.map_err(|_| none("find no memory".to_owned()))?;
        self.read_to_end(&mut bytes).map_err(|error| explain(&error))?;
        Ok(bytes)
    }
}

impl Read for Opened {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let most = into.len().min(usize::try_from(self.left).unwrap_or(usize::MAX));
        let count = self.file.read(&mut into[..most])?;
        if count == 0 && most > 0 {
            let (read, length) = (self.length - self.left, self.length);
            let fault = format!("it was cut from {length} to {read} bytes meanwhile; wait until it is written");
            return Err(io::Error::other(fault));
        }
        self.left -= count as u64;
        Ok(count)
    }
}

/// Opens a regular file of 1 to `most` bytes. The error is a fault and its remedy, for the caller
/// to say whose line named the file.
///
/// The kind is asked for before the file is opened, since opening a pipe would wait for a writer.
pub fn open(path: &Path, most: u64) -> Unplaced<Opened> {
    let kind = fs::metadata(path).map_err(|error| explain(&error))?;
    if kind.is_dir() {
        return Err("this is a folder; name a file in it".into());
    }
    if !kind.is_file() {
        return Err("this is no regular file; copy its contents into one".into());
    }
    if kind.len() == 0 {
        return Err("the file is empty; was it written to the end?".into());
    }
    if kind.len() > most {
        return Err(format!("the file holds {} bytes and {most} is the most that is read; split it", kind.len()));
    }
    let file = File::open(path).map_err(|error| explain(&error))?;
    Ok(Opened { file, length: kind.len(), left: kind.len() })
}

/// The bytes of a file that [`open`] accepts.
pub fn read(path: &Path, most: u64) -> Unplaced<Vec<u8>> {
    open(path, most)?.whole()
}

/// The 1 to `most` bytes of what is no file, such as standard input.
pub fn read_stream(stream: impl Read, most: u64) -> Unplaced<Vec<u8>> {
    let mut bytes = Vec::new();
    stream.take(most + 1).read_to_end(&mut bytes).map_err(|error| explain(&error))?;
    match bytes.len() as u64 {
        0 => Err("it is empty; write a scene to it".into()),
        count if count > most => {
            Err(format!("it holds more than {most} bytes, which is the most that is read; split it"))
        }
        _ => Ok(bytes),
    }
}

/// An operating system's error as a fault and a remedy.
pub fn explain(error: &std::io::Error) -> String {
    match error.kind() {
        ErrorKind::NotFound => "there is no such file; check the path".into(),
        ErrorKind::PermissionDenied => "no permission to read it; change its mode or owner".into(),
        _ => format!("it cannot be read: {error}"),
    }
}

/// The folder of a file; a bare name lies in the working directory.
pub fn folder(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_cut_while_it_is_read_is_an_error_and_one_that_grows_is_read_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        let opened = |then: u64| {
            fs::write(&path, [7; 5000]).unwrap();
            let opened = open(&path, 5000).unwrap();
            File::options().write(true).open(&path).unwrap().set_len(then).unwrap();
            opened.whole()
        };
        assert_eq!(opened(9000), Ok(vec![7; 5000]));
        let fault = opened(1234).unwrap_err();
        assert!(fault.contains("it was cut from 5000 to 1234 bytes"), "{fault}");
    }

    #[test]
    fn what_there_is_no_memory_for_is_refused_before_it_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        // A hole of the file system's: no disk is taken.
        let file = File::create(&path).unwrap();
        if file.set_len(1 << 42).is_err() {
            return eprintln!("skipped: this file system has no files of 4 TiB");
        }
        let fault = read(&path, u64::MAX).unwrap_err();
        assert!(fault.starts_with("its 4398046511104 bytes take about 4398.0 GB of memory, and "), "{fault}");
    }
}
