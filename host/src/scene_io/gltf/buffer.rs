//! The bytes that a file brings along or names, and the views of them.

use std::collections::HashMap;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

use super::document::{Buffer, BufferView, Document, pick};
use super::uri::{self, Target};
use crate::scene::Unplaced;
use crate::scene_io::file;
use crate::scene_io::neighbours::Neighbours;

/// All buffers of a file, read once.
pub struct Buffers<'f> {
    views: &'f [BufferView],
    bytes: Vec<Bytes<'f>>,
    /// The files that were read for them.
    pub paths: Vec<PathBuf>,
}

enum Bytes<'f> {
    Chunk(&'f [u8]),
    Own(Arc<Vec<u8>>),
    /// Extensions leave buffers empty that only readers without them fill.
    Missing,
}

impl Bytes<'_> {
    fn get(&self) -> Option<&[u8]> {
        match self {
            Bytes::Chunk(bytes) => Some(bytes),
            Bytes::Own(bytes) => Some(bytes),
            Bytes::Missing => None,
        }
    }
}

impl<'f> Buffers<'f> {
    /// Reads those of a file, whose binary chunk is the first.
    ///
    /// # Errors
    /// A URI that leads nowhere, a buffer shorter than it claims, or more than [`file::MOST_MESH`] bytes in all.
    pub fn read(document: &'f Document, chunk: Option<&'f [u8]>, neighbours: &Neighbours) -> Unplaced<Self> {
        let mut files = HashMap::new();
        let mut buffers = Buffers { views: &document.buffer_views, bytes: Vec::new(), paths: Vec::new() };
        let mut left = file::MOST_MESH;
        for (number, buffer) in document.buffers.iter().enumerate() {
            let owner = format!("buffers[{number}]");
            let chunk = chunk.filter(|_| number == 0);
            let bytes = buffers.bytes_of(buffer, chunk, neighbours, &mut files, &mut left);
            let bytes = bytes.map_err(|fault| format!("{owner}.uri: {fault}"))?;
            check_length(&bytes, buffer).map_err(|fault| format!("{owner}.byteLength: {fault}"))?;
            buffers.bytes.push(bytes);
        }
        Ok(buffers)
    }

    fn bytes_of(
        &mut self,
        buffer: &Buffer,
        chunk: Option<&'f [u8]>,
        neighbours: &Neighbours,
        files: &mut HashMap<PathBuf, Arc<Vec<u8>>>,
        left: &mut u64,
    ) -> Unplaced<Bytes<'f>> {
        let Some(uri) = &buffer.uri else { return Ok(chunk.map_or(Bytes::Missing, Bytes::Chunk)) };
        let path = match uri::follow(uri, neighbours)? {
            Target::Bytes(bytes) => return Ok(Bytes::Own(Arc::new(bytes))),
            Target::File(path) => path,
            Target::Missing(name) => return Err(uri::missing(&name)),
        };
        if let Some(bytes) = files.get(&path) {
            return Ok(Bytes::Own(bytes.clone()));
        }
        let bytes = Arc::new(file::read(&path, *left).map_err(|fault| format!("{uri:?}: {fault}"))?);
        *left -= bytes.len() as u64;
        self.paths.push(path.clone());
        files.insert(path, bytes.clone());
        Ok(Bytes::Own(bytes))
    }

    /// The bytes of a view, and from the start of one element to the next where it says so.
    ///
    /// # Errors
    /// There is no such view, or its buffer ends before it.
    pub fn view(&self, number: usize, owner: &str) -> Unplaced<(&[u8], Option<usize>)> {
        let view = pick(self.views, number, owner, "buffer view")?;
        let here = format!("bufferViews[{number}]");
        let bytes = pick(&self.bytes, view.buffer, &format!("{here}.buffer"), "buffer")?;
        let Some(bytes) = bytes.get() else {
            return Err(format!("buffers[{}]: there is no uri and no binary chunk; write the file again", view.buffer));
        };
        let range = range(view.byte_offset, view.byte_length);
        let part = range.and_then(|range| bytes.get(range)).ok_or_else(|| {
            let BufferView { byte_offset, byte_length, buffer, .. } = view;
            let count = bytes.len();
            format!("{here}: {byte_length} bytes from {byte_offset} are more than the {count} of buffer {buffer}; write the file again")
        })?;
        // Old writers have 0 for none.
        Ok((part, view.byte_stride.filter(|&stride| stride > 0)))
    }
}

fn range(start: usize, length: usize) -> Option<Range<usize>> {
    Some(start..start.checked_add(length)?)
}

fn check_length(bytes: &Bytes, buffer: &Buffer) -> Unplaced<()> {
    match (bytes.get(), buffer.byte_length) {
        (Some(bytes), Some(claimed)) if bytes.len() < claimed => {
            Err(format!("it claims {claimed} bytes and there are {}; was it written to the end?", bytes.len()))
        }
        _ => Ok(()),
    }
}
