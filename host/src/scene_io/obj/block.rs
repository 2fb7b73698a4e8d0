//! The statements of a block, checked one by one.

use std::borrow::Cow;
use std::path::Path;

use glam::{DVec3, Vec2, Vec3};

use crate::image::srgb_to_linear;

use super::super::Warning;
use super::super::WarningKind::{Changed, LeftOut};
use super::super::lines::{self, Lines, NOT_UTF8};
use super::super::tally::Tally;
use super::face::Faces;
use crate::error::{Error, Result};
use crate::scene::Unplaced;
use crate::scene::normal::unit;

/// How many lines and vertices there are before a block.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub(super) struct Before {
    pub lines: usize,
    pub positions: usize,
    pub textures: usize,
    pub normals: usize,
}

impl Before {
    /// How many a block has; a file's first may begin with a mark.
    pub fn count(path: &Path, text: &[u8], is_first: bool) -> Self {
        let (mut count, before) = (Before::default(), usize::from(!is_first));
        let mut lines = Lines::after(path, text, before);
        // A block that cannot be read to its end is the last.
        while let Ok(Some((_, line))) = lines.advance() {
            match lines::split(&lines::text(line)).map_or("", |(key, _)| key) {
                "v" => count.positions += 1,
                "vt" => count.textures += 1,
                "vn" => count.normals += 1,
                _ => {}
            }
        }
        Before { lines: lines.count() - before, ..count }
    }

    /// With so many more.
    pub fn and(self, more: Self) -> Self {
        Before {
            lines: self.lines + more.lines,
            positions: self.positions + more.positions,
            textures: self.textures + more.textures,
            normals: self.normals + more.normals,
        }
    }
}

/// A statement about materials, and how many of the block's faces precede it.
pub(super) struct Event {
    pub line: usize,
    pub face: usize,
    pub what: About,
}

/// What a statement about materials names.
pub(super) enum About {
    Material(String),
    Libraries(String),
    /// The smoothing group of the next faces, 0 for flat ones.
    Smoothing(u32),
}

/// What is ignored of a file.
#[derive(Default)]
pub(super) struct Notes {
    latin: Tally,
    unknown: Tally,
    bad: Tally,
    absent: Tally,
    lost: Tally,
    crossing: Tally,
}

impl Notes {
    /// Adds those of the next block.
    pub fn append(&mut self, notes: Notes, faces: Faces) {
        self.latin.append(notes.latin);
        self.unknown.append(notes.unknown);
        self.bad.append(notes.bad);
        self.absent.append(faces.absent);
        self.lost.append(faces.lost);
        self.crossing.append(faces.crossing);
    }

    /// Why there is no face, if any was left out.
    pub fn no_face(&self, path: &Path) -> Option<Error> {
        self.bad.fault(path, "left out, and no face is left").or_else(|| self.crossing(path))
    }

    fn crossing(&self, path: &Path) -> Option<Error> {
        self.crossing.fault(path, "left out: the outline crosses itself; split it into simple polygons")
    }

    /// One warning each.
    pub fn warnings(&self, path: &Path) -> [Option<Warning>; 6] {
        [
            self.latin.warn(Changed, path, NOT_UTF8),
            self.unknown.warn(LeftOut, path, "ignored: only polygons are read"),
            self.bad.warn(LeftOut, path, "left out"),
            self.absent.warn(LeftOut, path, "ignored: none of this number precedes the face"),
            self.lost.warn(LeftOut, path, "left out: a vertex of it makes no sense"),
            self.crossing(path).map(|fault| Warning::of(LeftOut, &fault)),
        ]
    }
}

/// What a block holds.
pub(super) struct Block {
    pub positions: Vec<Vec3>,
    /// Linear RGB of the vertices, white for those without; none at all as long as no vertex has one.
    pub colours: Vec<Vec3>,
    pub normals: Vec<Vec3>,
    /// Of textures, down.
    pub coordinates: Vec<Vec2>,
    pub faces: Faces,
    pub events: Vec<Event>,
    pub notes: Notes,
    /// What cannot be read ends a block.
    pub fault: Option<Error>,
}

impl Block {
    /// Reads a block that has so much before it.
    pub fn read(path: &Path, text: &[u8], before: Before) -> Self {
        let mut block = Block {
            positions: Vec::new(),
            colours: Vec::new(),
            normals: Vec::new(),
            coordinates: Vec::new(),
            faces: Faces::after(before),
            events: Vec::new(),
            notes: Notes::default(),
            fault: None,
        };
        block.fault = block.lines(Lines::after(path, text, before.lines)).err();
        block
    }

    fn lines(&mut self, mut lines: Lines<'_, &[u8]>) -> Result<()> {
        while let Some((number, line)) = lines.advance()? {
            self.line(number, line);
        }
        Ok(())
    }

    fn line(&mut self, line: usize, bytes: &[u8]) {
        let text = lines::text(bytes);
        if let Cow::Owned(_) = text {
            self.notes.latin.add(line, "line");
        }
        let Some((key, rest)) = lines::split(&text) else {
            return;
        };
        let event = |what| Event { line, face: self.faces.len(), what };
        match key {
            "v" => {
                // The place of one that makes no sense is kept: faces count them.
                let position = self.good(line, key, position(rest)).unwrap_or(Vec3::NAN);
                self.positions.push(position);
                self.add_colour(rest);
                self.faces.before.positions += 1;
            }
            "vn" => {
                let normal = self.good(line, key, normal(rest)).unwrap_or(Vec3::ZERO);
                self.normals.push(normal);
                self.faces.before.normals += 1;
            }
            "vt" => {
                let coordinates = self.good(line, key, coordinates(rest)).unwrap_or(Vec2::ZERO);
                self.coordinates.push(coordinates);
                self.faces.before.textures += 1;
            }
            "f" | "fo" => {
                let read = self.faces.read(line, rest);
                self.good(line, key, read);
            }
            "usemtl" => self.events.push(event(About::Material(rest.to_owned()))),
            "mtllib" => self.events.push(event(About::Libraries(rest.to_owned()))),
            "s" => self.events.push(event(About::Smoothing(group(rest)))),
            "o" | "g" | "l" | "p" => {}
            _ => self.notes.unknown.add(line, format_args!("statement {key:?}")),
        }
    }

    /// What a statement says, or nothing where it makes no sense.
    fn good<T>(&mut self, line: usize, key: &str, read: Unplaced<T>) -> Option<T> {
        read.map_err(|fault| self.notes.bad.add(line, format_args!("{key} ({fault})"))).ok()
    }

    /// The colour of the vertex that was read last, if it has one.
    fn add_colour(&mut self, rest: &str) {
        let colour = colour(rest);
        if colour.is_some() || !self.colours.is_empty() {
            self.colours.resize(self.positions.len() - 1, Vec3::ONE);
            self.colours.push(colour.unwrap_or(Vec3::ONE));
        }
    }

    /// Ends the block at the line from which on so many of its triangles and vertices do not fit.
    pub fn end_where_full(
        &mut self,
        path: &Path,
        text: &[u8],
        before: Before,
        fits: impl Fn(usize, usize) -> Unplaced<()>,
    ) {
        let (mut faces, mut positions) = (0, 0);
        let mut lines = Lines::after(path, text, before.lines);
        while let Ok(Some((number, line))) = lines.advance() {
            match lines::split(&lines::text(line)).map_or("", |(key, _)| key) {
                "v" => positions += 1,
                "f" | "fo" => faces += 1,
                _ => continue,
            }
            // A fault has ended it already.
            if faces > self.faces.len() || positions > self.positions.len() {
                return;
            }
            if let Err(fault) = fits(self.faces.triangles_before(faces), positions) {
                self.events.retain(|event| event.line < number);
                self.fault = Some(Error::line(path, number, fault));
                return;
            }
        }
    }
}

fn position(rest: &str) -> Unplaced<Vec3> {
    // What follows is a weight or a colour.
    let [x, y, z] = three("v", rest)?.map(|word| lines::number("v", word));
    Ok(Vec3::new(x?, y?, z?))
}

/// Three numbers behind a position are an sRGB colour (a single one is a weight), which stands for itself if it is one.
fn colour(rest: &str) -> Option<Vec3> {
    let mut words = lines::words(rest).skip(3);
    let rgb = [words.next()?, words.next()?, words.next()?];
    let mut linear = [0.0; 3];
    for (word, to) in rgb.into_iter().zip(&mut linear) {
        *to = srgb_to_linear(f64::from(lines::number("v", word).ok()?.clamp(0.0, 1.0))) as f32;
    }
    Some(linear.into())
}

/// A smoothing group; `off` is 0.
fn group(rest: &str) -> u32 {
    match lines::words(rest).next() {
        Some("on") => 1,
        word => word.and_then(|word| word.parse().ok()).unwrap_or(0),
    }
}

/// A normal of unit length, or zero.
fn normal(rest: &str) -> Unplaced<Vec3> {
    let mut xyz = [0.0; 3];
    for (word, to) in three("vn", rest)?.into_iter().zip(&mut xyz) {
        match word.parse::<f32>() {
            Ok(number) => *to = f64::from(number),
            Err(_) => return lines::number("vn", word).map(|_| Vec3::ZERO),
        }
    }
    // Exporters write NaN for the normal of a face without area: it is flat.
    Ok(unit(DVec3::from(xyz)))
}

/// Texture coordinates: up in a file, down in a mesh. A third one is of textures with depth.
fn coordinates(rest: &str) -> Unplaced<Vec2> {
    let mut words = lines::words(rest);
    let Some(u) = words.next() else {
        return Err(format!("vt takes two numbers, not {rest:?}; add what is missing"));
    };
    // One is enough of textures that are a line.
    let v = words.next().map_or(Ok(0.0), |word| lines::number("vt", word));
    Ok(Vec2::new(lines::number("vt", u)?, 1.0 - v?))
}

fn three<'r>(key: &str, rest: &'r str) -> Unplaced<[&'r str; 3]> {
    let mut words = lines::words(rest);
    match (words.next(), words.next(), words.next()) {
        (Some(x), Some(y), Some(z)) => Ok([x, y, z]),
        _ => Err(format!("{key} takes three numbers, not {rest:?}; add what is missing")),
    }
}
