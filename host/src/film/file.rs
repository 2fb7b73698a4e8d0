//! Films in files: eight bytes, then blocks of zlib's, each with its length before it. The first holds the [`Header`] as JSON, the others
//! the sums, rows together. Films of pictures that end by their noise have a version of their own, since other programs would take the
//! squares of their blocks for those of samples.

use std::collections::HashSet;
use std::io::{self, ErrorKind, Read, Write};
use std::ops::Range;

use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{Cells, Coverage, Film, Identity, Part};
use crate::error::{Error, Result};
use crate::layers;
use crate::noise::{Target, whole_blocks};
use crate::picture::Picture;
use crate::scene::Settings;
use crate::view::Region;
use eyerays_shader::data::Launch;
use eyerays_shader::stage::{FilmWords, NOISY_FILM_WORDS, film_words};

/// No text begins like this; the last byte tells the version.
const MAGIC: [u8; 8] = *b"\x89EYFILM\x01";
/// Of a film whose cells noise decides about.
const MAGIC_OF_CELLS: [u8; 8] = *b"\x89EYFILM\x02";
/// Bytes of sums of a block.
const BLOCK: usize = 1 << 20;
/// The most bytes of a header.
const MOST_HEADER: u64 = 1 << 24;
/// The most parts of a coverage, each of which is compared with all others.
const MOST_PARTS: usize = 8192;

/// The most arbitrary output variables: more than there are, and groups of lamps.
const MOST_AOVS: u32 = 512;

fn is_none(count: &u32) -> bool {
    *count == 0
}

/// Are these names of layers, each once?
fn can_be_named(names: &[String]) -> bool {
    let is_known = |name: &String| layers::can_be_named(name);
    names.iter().all(is_known) && names.iter().collect::<HashSet<_>>().len() == names.len()
}

/// What a film is beside its sums.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    identity: Identity,
    size: (u32, u32),
    window: Region,
    /// Of the light of a pixel.
    words: u32,
    /// Arbitrary output variables of a pixel.
    #[serde(default, skip_serializing_if = "is_none")]
    aovs: u32,
    parts: Vec<Part>,
    secondary: u64,
    /// Whether sums follow: a film without samples has none.
    has_sums: bool,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    cells: Option<KeptCells>,
}

/// Which samples cells have, and when they have enough.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct KeptCells {
    noise: String,
    exposure: String,
    tone: String,
    most: u32,
    counts: Vec<u32>,
}

impl Film {
    /// How names of such files end.
    pub const ENDING: &str = "film";

    /// Writes it.
    ///
    /// # Errors
    /// What keeps `out` from being written.
    pub fn write(&self, out: &mut dyn Write) -> Result<()> {
        let header = Header {
            identity: self.identity.clone(),
            size: self.size,
            window: self.window,
            words: self.words.light,
            aovs: self.words.aovs,
            parts: self.coverage.parts().to_vec(),
            secondary: self.secondary,
            has_sums: !self.sums.is_empty(),
            cells: self.cells.as_ref().map(KeptCells::of),
        };
        let magic = if self.cells.is_some() { MAGIC_OF_CELLS } else { MAGIC };
        let header = serde_json::to_vec(&header).map_err(|error| Error::new(error.to_string()))?;
        let written = out.write_all(&magic).and_then(|()| write_block(&packed(&header)?, out));
        written.map_err(|error| Error::writing(&error))?;
        // A few at a time, so that there is never a second film in memory.
        let blocks: Vec<Range<usize>> = blocks(self.sums.len()).collect();
        for some in blocks.chunks(rayon::current_num_threads()) {
            let packed = some.par_iter().map(|block| packed(bytemuck::cast_slice(&self.sums[block.clone()])));
            for block in packed.collect::<Vec<_>>() {
                block.and_then(|block| write_block(&block, out)).map_err(|error| Error::writing(&error))?;
            }
        }
        Ok(())
    }

    /// Reads what [`Film::write`] wrote.
    ///
    /// # Errors
    /// Anything else, or too little memory.
    pub fn read(input: &mut dyn Read) -> Result<Film> {
        let mut magic = Vec::new();
        input.take(MAGIC.len() as u64).read_to_end(&mut magic).map_err(|error| unread(&error))?;
        if magic != MAGIC && magic != MAGIC_OF_CELLS {
            return Err(no_film(&magic));
        }
        let header = read_block(input, MOST_HEADER)?;
        let header: Header = serde_json::from_slice(&unpacked(&header, MOST_HEADER)?).map_err(|_| damaged())?;
        if header.cells.is_some() != (magic == MAGIC_OF_CELLS) {
            return Err(damaged());
        }
        let (mut film, count) = header.film()?;
        let blocks: Vec<Range<usize>> = blocks(count).collect();
        for some in blocks.chunks(rayon::current_num_threads()) {
            let packed = some.iter().map(|_| read_block(input, 2 * BLOCK as u64)).collect::<Result<Vec<_>>>()?;
            let unpacked = packed.par_iter().zip(some).map(|(packed, block)| {
                let bytes = unpacked(packed, 4 * block.len() as u64)?;
                if bytes.len() == 4 * block.len() { Ok(bytes) } else { Err(damaged()) }
            });
            // As they come: a file that is short takes no memory for what it only promises.
            for bytes in unpacked.collect::<Result<Vec<_>>>()? {
                film.sums.extend(bytemuck::pod_collect_to_vec::<u8, u32>(&bytes));
            }
        }
        match input.read(&mut [0]) {
            Ok(0) => Ok(film),
            Ok(_) => Err(damaged()),
            Err(error) => Err(unread(&error)),
        }
    }
}

impl Header {
    /// The film without its sums, if it can be one, and how many there are.
    fn film(self) -> Result<(Film, usize)> {
        let Header { identity, size, window, words, aovs, parts, secondary, has_sums, cells } = self;
        Picture::check_size(size.0, size.1).map_err(|_| damaged())?;
        let image = Region { x: 0, y: 0, width: size.0, height: size.1 };
        let is_within = |inner: Region, outer: Region| inner.pixels() > 0 && outer.around(inner) == outer;
        let kept = [0, Launch::CLEAR, Launch::CATCHER, Launch::CLEAR | Launch::CATCHER].map(Launch);
        let is_known = kept.iter().any(|&kept| [false, true].iter().any(|&noisy| film_words(kept, noisy) == words));
        let names = identity.layers();
        let is_named = aovs <= MOST_AOVS && (names.is_empty() || names.len() == aovs as usize && can_be_named(&names));
        if !is_within(window, image) || !is_known || !is_named || parts.len() > MOST_PARTS {
            return Err(damaged());
        }
        let cells = cells.map(|cells| cells.cells(size, window)).transpose()?;
        let has_some = cells.as_ref().map_or(!parts.is_empty(), |cells| cells.counts.iter().any(|&count| count > 0));
        if has_some != has_sums || cells.is_some() && (!parts.is_empty() || words < NOISY_FILM_WORDS) {
            return Err(damaged());
        }
        let mut coverage = Coverage::default();
        for part in parts {
            let is_some = !part.samples.is_empty() && part.samples.end <= Settings::MOST_SPP;
            if !is_some || !is_within(part.region, window) || coverage.add(part).is_err() {
                return Err(damaged());
            }
        }
        let words = FilmWords { light: words, aovs };
        let mut film = Film { size, window, words, sums: Vec::new(), coverage, cells, secondary, identity };
        let count = if has_sums { window.pixels() as usize * words.all() as usize } else { 0 };
        film.sums.try_reserve_exact(count).map_err(|_| Error::Memory { width: size.0, height: size.1 })?;
        Ok((film, count))
    }
}

impl KeptCells {
    fn of(cells: &Cells) -> KeptCells {
        let [noise, exposure, tone] = cells.target.entries().map(|(_, value)| value);
        KeptCells { noise, exposure, tone, most: cells.most, counts: cells.counts.clone() }
    }

    /// What was kept, if an image of this size can have it in this window.
    fn cells(self, size: (u32, u32), window: Region) -> Result<Cells> {
        let target = Target::of_entries([&self.noise, &self.exposure, &self.tone]).map_err(|_| damaged())?;
        let mut cells = Cells::new(size, target, self.most);
        let image = Region { x: 0, y: 0, width: size.0, height: size.1 };
        let is_outside = |cell: Region| window.around(cell) != window;
        let can_be = |(&count, cell): (&u32, Region)| {
            whole_blocks(count) == count && count <= self.most && (count == 0 || !is_outside(cell))
        };
        let is_sound = (Target::LEAST_SAMPLES..=Settings::MOST_SPP).contains(&self.most)
            && Target::around(window, size) == window
            && self.counts.len() == cells.counts.len()
            && self.counts.iter().zip(Target::cells(image)).all(can_be);
        if !is_sound {
            return Err(damaged());
        }
        cells.counts = self.counts;
        Ok(cells)
    }
}

/// The words of each block.
fn blocks(words: usize) -> impl Iterator<Item = Range<usize>> {
    (0..words).step_by(BLOCK / 4).map(move |first| first..(first + BLOCK / 4).min(words))
}

fn packed(bytes: &[u8]) -> io::Result<Vec<u8>> {
    // Better compression takes several times as long for a few percent.
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes)?;
    encoder.finish()
}

fn unpacked(block: &[u8], most: u64) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    // One more than allowed, so that what is too long shows.
    let read = ZlibDecoder::new(block).take(most + 1).read_to_end(&mut bytes);
    read.map_err(|_| damaged())?;
    Ok(bytes)
}

fn write_block(block: &[u8], out: &mut dyn Write) -> io::Result<()> {
    out.write_all(&(block.len() as u64).to_le_bytes())?;
    out.write_all(block)
}

fn read_block(input: &mut dyn Read, most: u64) -> Result<Vec<u8>> {
    let mut length = [0; 8];
    input.read_exact(&mut length).map_err(|error| unread(&error))?;
    let length = u64::from_le_bytes(length);
    if length > most {
        return Err(damaged());
    }
    let mut block = Vec::new();
    input.take(length).read_to_end(&mut block).map_err(|error| unread(&error))?;
    if block.len() as u64 == length { Ok(block) } else { Err(cut_off()) }
}

fn unread(error: &io::Error) -> Error {
    if error.kind() == ErrorKind::UnexpectedEof { cut_off() } else { Error::new(format!("cannot be read: {error}")) }
}

/// What begins like this and not as a film does.
fn no_film(start: &[u8]) -> Error {
    if MAGIC.starts_with(start) || MAGIC_OF_CELLS.starts_with(start) {
        cut_off()
    } else if start.starts_with(&MAGIC[..7]) {
        Error::new("a film of another version of this program, which that version goes on with")
    } else {
        Error::new("no film: give what render wrote to a .film file")
    }
}

fn cut_off() -> Error {
    Error::BrokenFilm("cut off")
}

fn damaged() -> Error {
    Error::BrokenFilm("damaged")
}
