//! Wavefront files, written as the triangles are made.

use std::io::{self, Write};

use glam::DVec3;

use super::model::{Finish, Model, Piece};
use super::patch::Sink;

/// A coordinate's steps a unit. Single precision tells them apart in every scene here.
const STEPS: f64 = 1e5;
/// A normal's steps a unit.
const NORMAL_STEPS: f64 = 1e3;

/// Writes exactly `triangles` of the model as an OBJ that names its material file.
pub fn write_mesh(model: &Model, triangles: u64, materials: &str, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "mtllib {materials}")?;
    let mut writer = Writer { out, vertices: 0, normals: 0, text: String::new(), fault: None };
    let mut now = ("", "");
    for (piece, count) in model.deal(triangles) {
        writer.head(piece, &mut now);
        piece.cut(count, &mut writer);
        if let Some(fault) = writer.fault.take() {
            return Err(fault);
        }
    }
    writer.flush();
    writer.fault.map_or(Ok(()), Err)
}

/// Writes the model's materials as an MTL.
pub fn write_materials(model: &Model, out: &mut dyn Write) -> io::Result<()> {
    for material in &model.materials {
        let [r, g, b] = material.diffuse;
        writeln!(out, "\nnewmtl {}", material.name)?;
        match material.finish {
            Finish::Glass => writeln!(out, "Kd 0 0 0\nTf {r} {g} {b}\nNi 1.5\nillum 7")?,
            Finish::Mirror => writeln!(out, "Kd {r} {g} {b}\nillum 3")?,
            Finish::Dull => writeln!(out, "Kd {r} {g} {b}\nillum 2")?,
        }
        let specular = material.specular;
        writeln!(out, "Ks {specular} {specular} {specular}\nNs {}", material.shininess)?;
    }
    Ok(())
}

/// Writes what a sheet is cut into; the first fault waits for the piece's end.
struct Writer<'w> {
    out: &'w mut dyn Write,
    vertices: u64,
    normals: u64,
    text: String,
    fault: Option<io::Error>,
}

impl Writer<'_> {
    fn head(&mut self, piece: &Piece, now: &mut (&'static str, &'static str)) {
        if now.0 != piece.group {
            self.line(&["g ", piece.group]);
        }
        if now.1 != piece.material {
            self.line(&["usemtl ", piece.material]);
        }
        *now = (piece.group, piece.material);
    }

    fn line(&mut self, words: &[&str]) {
        self.text.extend(words.iter().copied());
        self.end();
    }

    fn end(&mut self) {
        const BLOCK: usize = 1 << 16;
        self.text.push('\n');
        if self.text.len() >= BLOCK {
            self.flush();
        }
    }

    fn flush(&mut self) {
        if self.fault.is_none() {
            self.fault = self.out.write_all(self.text.as_bytes()).err();
        }
        self.text.clear();
    }

    fn vector(&mut self, key: &str, vector: DVec3, steps: f64) {
        self.text.push_str(key);
        for number in vector.to_array() {
            self.text.push(' ');
            decimal(&mut self.text, number, steps);
        }
        self.end();
    }
}

impl Sink for Writer<'_> {
    fn vertex(&mut self, position: DVec3, normal: Option<DVec3>) -> u64 {
        self.vector("v", position, STEPS);
        self.vertices += 1;
        if let Some(normal) = normal {
            self.vector("vn", normal, NORMAL_STEPS);
            self.normals += 1;
        }
        self.vertices
    }

    fn triangle(&mut self, corners: [u64; 3], normals: bool) {
        self.text.push('f');
        for corner in corners {
            self.text.push(' ');
            integer(&mut self.text, corner);
            if normals {
                self.text.push_str("//");
                // Both were last numbered by the same vertex, and a sheet has normals at all or none.
                integer(&mut self.text, self.normals - (self.vertices - corner));
            }
        }
        self.end();
    }
}

/// A number with as few digits as its steps need.
pub(super) fn decimal(text: &mut String, number: f64, steps: f64) {
    let whole = (number * steps).round() as i64;
    if whole < 0 {
        text.push('-');
    }
    let (mut part, mut unit) = (whole.unsigned_abs(), steps as u64);
    integer(text, part / unit);
    part %= unit;
    if part > 0 {
        text.push('.');
    }
    while part > 0 {
        unit /= 10;
        text.push(char::from(b'0' + (part / unit) as u8));
        part %= unit;
    }
}

/// Half of the time went to the standard library's formatting.
fn integer(text: &mut String, number: u64) {
    if number >= 10 {
        integer(text, number / 10);
    }
    text.push(char::from(b'0' + (number % 10) as u8));
}

#[cfg(test)]
mod tests {
    use super::decimal;

    #[test]
    fn numbers_are_short_and_round_to_the_nearest_step() {
        for (number, expected) in [
            (0.0, "0"),
            (-0.000_004, "0"),
            (1.5, "1.5"),
            (-0.05, "-0.05"),
            (12.345_678, "12.34568"),
            (-3.0, "-3"),
            (100.000_01, "100.00001"),
        ] {
            let mut text = String::new();
            decimal(&mut text, number, 1e5);
            assert_eq!(text, expected);
        }
    }
}
