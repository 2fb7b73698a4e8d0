//! One layer of an OpenEXR file, of this program or of another.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Seek};
use std::path::Path;

use ::exr::block::lines::LineRef;
use ::exr::block::reader::{ChunksReader, Reader};
use ::exr::error::Result as Decoded;
use ::exr::io::Data;
use ::exr::math::Vec2;
use ::exr::meta::attribute::SampleType;
use ::exr::meta::header::Header;
use ::exr::prelude::f16;
use image::ImageFormat;

use super::bounded::{Allowance, Bounded};
use super::parts;
use super::read::{MOST_HEADER, distrusting, most_per_pixel, open, room, unreadable};
use crate::choice::Named;
use crate::error::{Error, Result};
use crate::layers::Layer;
use crate::picture::Picture;

/// What an OpenEXR file begins with.
const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
/// A picture's three floats.
const MEMORY_PER_PIXEL: u64 = 12;
/// Whole numbers up to this one have a float each.
const MOST_NUMBER: u32 = 1 << 24;
/// No more layers are listed.
const MOST_LISTED: usize = 20;

/// Reads a layer of an OpenEXR file, as [`decode_layer`].
///
/// # Errors
/// What is missing, unreadable, empty or not a regular file, and those of [`decode_layer`]. They name the file.
pub fn read_layer(path: &Path, name: &str) -> Result<Picture> {
    decode_layer(BufReader::new(open(path)?), name).map_err(|error| error.of(path))
}

/// Decodes a layer of an OpenEXR file: the channels whose names are the layer's, a point and `R`, `G` and `B`, or `X`, `Y`
/// and `Z`; or the one channel that the layer has, which becomes three equal ones. Alpha is ignored. The layer `colour` is of the
/// channels `R`, `G` and `B`, or `Y`, without a name before them. In a file of several parts a part's name stands for one.
///
/// # Errors
/// What is no OpenEXR file, damaged, truncated, or larger than a picture may be; a layer that is not there, or of other channels.
/// They name no file.
pub fn decode_layer(mut reader: impl BufRead + Seek, name: &str) -> Result<Picture> {
    distrusting(|| {
        if !is_exr(&mut reader)? {
            return Err(Error::new("is not an EXR image, and only these have layers; name one"));
        }
        let allowance = Allowance::new(MOST_HEADER);
        let file = Reader::read_from_buffered(Bounded::new(reader, allowance.clone()), false).map_err(parts::fault)?;
        parts::check(file.headers())?;
        let layers = layers(file.headers());
        let Some((&(_, part), channels)) = layers.iter().find(|((layer, _), _)| layer == name) else {
            return Err(Error::new(format!("has no layer {name:?}; {}", listed(&layers))));
        };
        let channels = three(channels).ok_or_else(|| {
            let endings: Vec<&str> = channels.iter().map(|channel| channel.ending.as_str()).collect();
            let rule = "a layer that is read has R, G and B, or X, Y and Z, or one channel";
            Error::new(format!("has a layer {name:?} of the channels {}; {rule}", endings.join(", ")))
        })?;
        pixels(file, &allowance, part, channels)
    })
}

/// The picture of an OpenEXR file that has light without colours: a channel `Y` and neither `R`, `G` and `B` nor differences of
/// colours. None of any other file, whose fault another reader tells.
pub(super) fn grey(reader: &mut (impl BufRead + Seek)) -> Result<Option<Picture>> {
    if !is_exr(reader)? {
        return Ok(None);
    }
    let parts = parts::headers(&mut Bounded::new(&mut *reader, Allowance::new(MOST_HEADER)));
    reader.rewind().map_err(unreadable)?;
    let has_colours = |parts: &[Header]| ["R", "RY", "BY"].iter().any(|&name| parts::have(parts, &[name]));
    let Some(parts) = parts.ok().filter(|parts| !has_colours(parts)) else { return Ok(None) };
    let of = |part: &Header| part.channels.list.iter().position(|channel| channel.name.eq("Y"));
    let found = parts.iter().enumerate().filter(|(_, part)| !part.deep).find_map(|(i, part)| Some((i, of(part)?)));
    let Some((part, channel)) = found else { return Ok(None) };
    parts::check(&parts)?;
    let allowance = Allowance::new(MOST_HEADER);
    let file = Reader::read_from_buffered(Bounded::new(reader, allowance.clone()), false).map_err(parts::fault)?;
    pixels(file, &allowance, part, [channel; 3]).map(Some)
}

fn is_exr(reader: &mut impl BufRead) -> Result<bool> {
    Ok(reader.fill_buf().map_err(unreadable)?.starts_with(&MAGIC))
}

/// A channel of a layer.
struct Channel {
    /// Its name without the layer's.
    ending: String,
    /// Its place among the channels of its part.
    index: usize,
}

/// The channels of every layer, by its name and the part that it is in.
type Layers = BTreeMap<(String, usize), Vec<Channel>>;

fn layers(parts: &[Header]) -> Layers {
    let mut layers = Layers::new();
    for (number, part) in parts.iter().enumerate().filter(|(_, part)| !part.deep) {
        let own = part.own_attributes.layer_name.as_ref().filter(|_| parts.len() > 1).map(ToString::to_string);
        for (index, channel) in part.channels.list.iter().enumerate() {
            let (layer, ending) = named(&channel.name.to_string(), own.as_deref());
            layers.entry((layer, number)).or_default().push(Channel { ending, index });
        }
    }
    layers
}

/// The layer of a channel in a part of this name, and what is left of the channel's name.
fn named(channel: &str, part: Option<&str>) -> (String, String) {
    let is_colour = ["R", "G", "B", "A", "Y"].contains(&channel);
    let (layer, ending) = match (channel.rsplit_once('.'), part) {
        (Some(parted), _) => parted,
        (None, Some(part)) => (part, channel),
        (None, None) if is_colour => (Layer::Colour.name(), channel),
        (None, None) => (channel, ""),
    };
    (layer.to_owned(), ending.to_owned())
}

/// The three channels that a picture of a layer has, by their places.
fn three(channels: &[Channel]) -> Option<[usize; 3]> {
    let of = |ending: &str| channels.iter().find(|channel| channel.ending.eq_ignore_ascii_case(ending));
    let all = |[a, b, c]: [&str; 3]| Some([of(a)?, of(b)?, of(c)?].map(|channel| channel.index));
    let mut single = channels.iter().filter(|channel| !channel.ending.eq_ignore_ascii_case("A"));
    all(["R", "G", "B"]).or_else(|| all(["X", "Y", "Z"])).or_else(|| match (single.next(), single.next()) {
        (Some(channel), None) => Some([channel.index; 3]),
        _ => None,
    })
}

/// Which layers there are, for one who asked for another.
fn listed(layers: &Layers) -> String {
    let mut names: Vec<&str> = layers.keys().map(|(name, _)| name.as_str()).collect();
    names.dedup();
    let more = names.len().saturating_sub(MOST_LISTED);
    names.truncate(MOST_LISTED);
    match (names.is_empty(), more) {
        (true, _) => "it has none that is read".to_owned(),
        (_, 0) => format!("it has {}", names.join(", ")),
        (_, more) => format!("it has {} and {more} more", names.join(", ")),
    }
}

/// Decodes three channels of a part, and nothing else of the file.
fn pixels(
    file: Reader<Bounded<impl BufRead + Seek>>,
    allowance: &Allowance,
    part: usize,
    channels: [usize; 3],
) -> Result<Picture> {
    let header = file.headers()[part].clone();
    let mut frame = Frame::of(&header)?;
    let kinds = channels.map(|channel| &header.channels.list[channel]);
    if kinds.iter().any(|channel| channel.sampling != Vec2(1, 1)) {
        return Err(Error::new("has channels with fewer samples than pixels, which are not read; write all of them"));
    }
    let most = most_per_pixel(ImageFormat::OpenExr).unwrap_or(0);
    allowance.add(file.headers().iter().map(|part| part.layer_size.area() as u64 * most).sum());
    let blocks = file.filter_chunks(false, |_, tile, block| block.layer == part && tile.level_index == Vec2(0, 0));
    let mut blocks = blocks.map_err(parts::fault)?.sequential_decompressor(false);
    while let Some(block) = blocks.decompress_next_block() {
        let block = block.map_err(parts::fault)?;
        if block.index.layer != part || block.index.level != Vec2(0, 0) {
            return Err(Error::new("is damaged; write the image again"));
        }
        for line in block.lines(&header.channels) {
            let index = line.location.channel;
            if channels.contains(&index) {
                let values = values(&line, header.channels.list[index].sample_type)?;
                let places = (0..3).filter(|&i| channels[i] == index);
                places.for_each(|i| frame.put(&line, i, &values));
            }
        }
    }
    Ok(frame.picture)
}

/// The values of a line as floats.
fn values(line: &LineRef<'_>, kind: SampleType) -> Result<Vec<f32>> {
    fn all<T: Data>(line: &LineRef<'_>) -> Result<Vec<T>> {
        line.read_samples::<T>().collect::<Decoded<Vec<T>>>().map_err(parts::fault)
    }
    Ok(match kind {
        SampleType::F32 => all(line)?,
        SampleType::F16 => all::<f16>(line)?.into_iter().map(f16::to_f32).collect(),
        SampleType::U32 => {
            let numbers = all::<u32>(line)?;
            if let Some(number) = numbers.iter().find(|&&number| number > MOST_NUMBER) {
                let fault = format!("has the number {number}; those above {MOST_NUMBER} are not read: write floats");
                return Err(Error::new(fault));
            }
            numbers.into_iter().map(|number| number as f32).collect()
        }
    })
}

/// A picture of a file's display, and where a part's data lie in it. What the data leave out is black.
struct Frame {
    picture: Picture,
    left: i64,
    top: i64,
}

impl Frame {
    fn of(part: &Header) -> Result<Self> {
        let display = part.shared_attributes.display_window;
        let [width, height] = [display.size.0, display.size.1].map(|side| u32::try_from(side).unwrap_or(u32::MAX));
        Picture::check_size(width, height)?;
        room(width, height, MEMORY_PER_PIXEL)?;
        let data = part.own_attributes.layer_position;
        let [left, top] = [(data.0, display.position.0), (data.1, display.position.1)]
            .map(|(data, display)| i64::from(data) - i64::from(display));
        Ok(Frame { picture: Picture::new(width, height)?, left, top })
    }

    /// Takes the values of a line for a channel of the picture.
    fn put(&mut self, line: &LineRef<'_>, channel: usize, values: &[f32]) {
        let Vec2(x, y) = line.location.position;
        let (left, y) = (x as i64 + self.left, y as i64 + self.top);
        let width = i64::from(self.picture.width);
        if !(0..i64::from(self.picture.height)).contains(&y) {
            return;
        }
        for (x, value) in (left..).zip(values).filter(|(x, _)| (0..width).contains(x)) {
            self.picture.pixels[(y * width + x) as usize][channel] = *value;
        }
    }
}
