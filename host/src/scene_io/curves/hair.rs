//! The binary files of Cem Yuksel's hair models (<http://www.cemyuksel.com/research/hairmodels/>): a header of 128 bytes, then arrays, of
//! numbers of little endian.
//!
//! | bytes | are |
//! |---|---|
//! | 0 to 3 | `HAIR` |
//! | 4 to 15 | numbers of 32 bits: strands, points of all, and which arrays there are |
//! | 16 to 19 | how many segments a strand has, one less than points, without an array of that |
//! | 20 to 39 | floats: thickness, transparency and color without arrays of them |
//! | 40 to 127 | text |

use glam::{Vec3, Vec4};

use super::listed::{self, Listed};
use crate::scene::Unplaced;
use crate::scene::curves::{ControlPoint, Strand, Strands};
use crate::scene_io::budget::Budget;
use crate::scene_io::grid::bytes::Bytes;

const MAGIC: &[u8] = b"HAIR";
const HEADER: u64 = 128;

/// Bits of the arrays that there are, in their order: of 16 bits a strand, then of so many floats a point.
const SEGMENTS: u32 = 1;
const POINTS: u32 = 2;
const THICKNESS: u32 = 4;
const TRANSPARENCY: u32 = 8;
const COLOURS: u32 = 16;

/// Is it such a file by its first bytes?
pub fn is(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// The strands of a file. A radius takes the place of its thicknesses, which are twice that.
///
/// # Errors
/// A file that is cut off, whose numbers contradict each other, or for whose points there is no room.
pub fn parse(bytes: &[u8], radius: Option<f32>, budget: Budget) -> Unplaced<Listed> {
    let file = Hair::read(Bytes(bytes))?;
    listed::check_room(file.point_count.into(), budget)?;
    let mut strands = Strands::default();
    let (mut points, mut colours) = (Vec::new(), Vec::new());
    let mut next = 0;
    for number in 0..file.strand_count as usize {
        let range = next..next + file.points_of(number);
        next = range.end;
        points.clear();
        points.extend(range.clone().map(|point| file.point(point, radius)));
        colours.clear();
        if file.has_colours() {
            colours.extend(range.map(|point| file.colour(point)));
        }
        strands.push(Strand { points: &points, ups: &[], colours: &colours });
    }
    let places = (1..=strands.len()).collect();
    Ok(Listed { strands, places, has_lines: false, warning: None })
}

/// A file's numbers, in place.
struct Hair<'b> {
    strand_count: u32,
    point_count: u32,
    /// Of every strand without an array of them.
    default_segments: u32,
    default_thickness: f32,
    default_transparency: f32,
    default_colour: [f32; 3],
    segments: &'b [u8],
    points: &'b [u8],
    thickness: &'b [u8],
    transparency: &'b [u8],
    colours: &'b [u8],
}

impl<'b> Hair<'b> {
    fn read(bytes: Bytes<'b>) -> Unplaced<Hair<'b>> {
        bytes.part(0, HEADER)?;
        let (strand_count, point_count, arrays) = (bytes.u32(4)?, bytes.u32(8)?, bytes.u32(12)?);
        if strand_count == 0 || arrays & POINTS == 0 {
            return Err("there is no strand in it; was it written to the end?".into());
        }
        let mut at = HEADER;
        let mut array = |bit: u32, size: u64| {
            let count = if arrays & bit == 0 { 0 } else { size };
            let part = bytes.part(at, count)?;
            at += count;
            Ok::<_, String>(part.0)
        };
        let (per_strand, per_point) = (u64::from(strand_count), 4 * u64::from(point_count));
        let hair = Hair {
            strand_count,
            point_count,
            default_segments: bytes.u32(16)?,
            default_thickness: bytes.f32(20)?,
            default_transparency: bytes.f32(24)?,
            default_colour: [bytes.f32(28)?, bytes.f32(32)?, bytes.f32(36)?],
            segments: array(SEGMENTS, 2 * per_strand)?,
            points: array(POINTS, 3 * per_point)?,
            thickness: array(THICKNESS, per_point)?,
            transparency: array(TRANSPARENCY, per_point)?,
            colours: array(COLOURS, 3 * per_point)?,
        };
        hair.check_count()?;
        Ok(hair)
    }

    /// Refuses strands that have other points together than there are.
    fn check_count(&self) -> Unplaced<()> {
        let strands = u64::from(self.strand_count);
        let segments = match self.segments {
            [] => strands * u64::from(self.default_segments),
            own => own.chunks_exact(2).map(|own| u64::from(u16::from_le_bytes([own[0], own[1]]))).sum(),
        };
        let (wanted, points) = (strands + segments, self.point_count);
        if wanted == u64::from(points) {
            return Ok(());
        }
        Err(format!(
            "its {strands} strands have {wanted} points by their segments, but it says {points}; write it again"
        ))
    }

    fn points_of(&self, strand: usize) -> usize {
        let own = self.segments.get(2 * strand..2 * strand + 2);
        1 + own.map_or(self.default_segments as usize, |own| usize::from(u16::from_le_bytes([own[0], own[1]])))
    }

    fn point(&self, number: usize, radius: Option<f32>) -> ControlPoint {
        let position = [0, 1, 2].map(|axis| float(self.points, 3 * number + axis).unwrap_or_default());
        let thickness = float(self.thickness, number).unwrap_or(self.default_thickness);
        ControlPoint { position: Vec3::from(position), radius: radius.unwrap_or(0.5 * thickness) }
    }

    /// Have its strands another look than opaque white?
    fn has_colours(&self) -> bool {
        let is_clear = !self.transparency.is_empty() || self.default_transparency != 0.0;
        is_clear || !self.colours.is_empty() || self.default_colour != [1.0; 3]
    }

    fn colour(&self, number: usize) -> Vec4 {
        let channel = |at: usize| float(self.colours, 3 * number + at).unwrap_or(self.default_colour[at]);
        let clear = float(self.transparency, number).unwrap_or(self.default_transparency);
        let share = |of: f32, none: f32| if of.is_finite() { of.clamp(0.0, 1.0) } else { none };
        let [red, green, blue] = [0, 1, 2].map(|at| share(channel(at), 1.0));
        Vec4::new(red, green, blue, 1.0 - share(clear, 0.0))
    }
}

/// The float of this number, of an array that is there.
fn float(array: &[u8], number: usize) -> Option<f32> {
    let bytes = array.get(4 * number..4 * number + 4)?;
    Some(f32::from_le_bytes(bytes.try_into().ok()?))
}
