//! Strands as text, as Mitsuba reads them: a line holds a control point's three coordinates and its radius, and an empty line is between two
//! strands.

use std::path::Path;

use glam::Vec3;

use super::listed::{self, LEFT_OUT, Listed, NONE_LEFT};
use crate::error::{Error, Result};
use crate::scene::curves::{ControlPoint, Strand, Strands};
use crate::scene::{Range, Unplaced};
use crate::scene_io::budget::Budget;
use crate::scene_io::tally::Tally;
use crate::scene_io::{WarningKind, lines};

/// The strand that is being read.
#[derive(Default)]
struct Open {
    /// The line of its first point.
    line: usize,
    points: Vec<ControlPoint>,
    /// What is wrong with a line of it, and which.
    fault: Option<(usize, String)>,
}

/// The strands of a text.
///
/// # Errors
/// There is none, or there is no room for them. One with a line that is no control point is left out with a warning.
pub fn parse(path: &Path, bytes: &[u8], radius: Option<f32>, budget: Budget) -> Result<Listed> {
    let mut listed = Listed { strands: Strands::default(), places: Vec::new(), has_lines: true, warning: None };
    let (mut tally, mut open, mut count) = (Tally::default(), Open::default(), 0);
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    for (number, line) in (1..).zip(bytes.split(|&byte| byte == b'\n')) {
        let line = line.trim_ascii();
        if line.is_empty() {
            close(&mut open, &mut listed, &mut tally);
        } else if !line.starts_with(b"#") {
            count += 1;
            listed::check_room(count, budget).map_err(|fault| Error::line(path, number, fault))?;
            add(&mut open, number, point(&lines::text(line), radius));
        }
    }
    close(&mut open, &mut listed, &mut tally);
    if listed.strands.is_empty() {
        let none = "there is no strand in it; write a control point a line, as x y z radius, and an empty line between strands";
        return Err(tally.fault(path, NONE_LEFT).unwrap_or_else(|| Error::file(path, none)));
    }
    listed.warning = tally.warn(WarningKind::LeftOut, path, LEFT_OUT);
    Ok(listed)
}

fn add(open: &mut Open, line: usize, point: Unplaced<ControlPoint>) {
    if open.points.is_empty() && open.fault.is_none() {
        open.line = line;
    }
    match point {
        Ok(point) => open.points.push(point),
        Err(fault) => {
            open.fault.get_or_insert((line, fault));
        }
    }
}

fn close(open: &mut Open, listed: &mut Listed, tally: &mut Tally) {
    match open.fault.take() {
        Some((line, fault)) => tally.add(line, format!("strand ({fault})")),
        None if open.points.is_empty() => {}
        None => {
            listed.strands.push(Strand { points: &open.points, ups: &[], colours: &[] });
            listed.places.push(open.line);
        }
    }
    open.points.clear();
}

/// The control point of a line.
fn point(line: &str, radius: Option<f32>) -> Unplaced<ControlPoint> {
    let mut words = lines::words(line);
    let [x, y, z, own] = [(); 4].map(|()| words.next());
    let (Some(x), Some(y), Some(z), None) = (x, y, z, words.next()) else {
        let count = lines::words(line).count();
        return Err(format!("a control point is x y z radius, not {count} numbers; correct the line"));
    };
    let position = Vec3::new(number(x)?, number(y)?, number(z)?);
    let own = own.map(number).transpose()?;
    let Some(radius) = own.or(radius) else {
        return Err("the control point has no radius; add a fourth number, or \"radius\" to the [[mesh]]".into());
    };
    if !Range::AMOUNT.holds(radius) {
        return Err(format!("the radius must be {}, not {radius}; correct it", Range::AMOUNT.says()));
    }
    Ok(ControlPoint { position, radius })
}

fn number(word: &str) -> Unplaced<f32> {
    // What is no text at all may have words of any length.
    let start = word.char_indices().nth(40).map_or(word, |(end, _)| &word[..end]);
    lines::number("a control point", start)
}
