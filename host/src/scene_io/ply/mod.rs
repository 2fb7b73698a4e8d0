//! Meshes in the Polygon File Format, as text or binary numbers of either order.

mod element;
mod fault;
mod header;
mod records;

use std::collections::HashMap;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use glam::{DVec3, Vec2, Vec3};
use ply_rs_bw::ply::ElementDef;

use self::element::{Corners, Has, Ignored, Vertex};
use self::fault::Checked;
use self::records::Records;
use super::Warning;
use super::WarningKind::{self, LeftOut};
use super::budget::Budget;
use super::face_sizes::FaceSizes;
use super::file;
use super::polygon::{Cut, Effort};
use crate::error::{Error, Result};
use crate::scene::normal::unit;
use crate::scene::{Mesh, Unplaced};

/// A mesh, all of material 0, and what of its file is not drawn.
#[derive(Debug)]
pub struct Ply {
    pub mesh: Mesh,
    /// The faces that it is of.
    pub faces: FaceSizes,
    pub warnings: Vec<Warning>,
}

/// Reads a mesh file: the elements `vertex`, `face` and `tristrips`.
///
/// # Errors
/// A file that cannot be read, is no mesh, holds no triangle, or more than the budget has room for. A face that names what does
/// not exist is left out with a warning.
pub fn load(path: &Path, budget: Budget) -> Result<Ply> {
    let file = file::open(path, file::MOST_MESH).map_err(|fault| Error::file(path, fault))?;
    parse(path, file.take(file::MOST_MESH), budget)
}

/// The mesh in these bytes.
pub(super) fn parse(path: &Path, source: impl Read, budget: Budget) -> Result<Ply> {
    let mut found = Found::new(budget);
    found.read(BufReader::new(source)).map_err(|fault| fault.of(path))?;
    let said = std::mem::take(&mut found.warnings);
    let warnings = said.into_iter().map(|(kind, message)| Warning::new(kind, path, message)).collect();
    let faces = std::mem::take(&mut found.sizes);
    let mesh = found.mesh().map_err(|fault| Error::file(path, fault))?;
    Ok(Ply { mesh, faces, warnings })
}

/// What a file holds.
struct Found {
    budget: Budget,
    vertices: Vec<Vertex>,
    has: Has,
    triangles: Vec<[u32; 3]>,
    sizes: FaceSizes,
    /// Of every triangle, where faces have colours.
    colours: Vec<[f32; 4]>,
    /// Faces and strips, of which there may be none.
    faces: usize,
    /// Those that make no sense, and what is wrong with the first.
    bad: (usize, Option<String>),
    effort: Effort,
    /// Faces that no triangles fill.
    crossing: usize,
    /// Without the file's name.
    warnings: Vec<(WarningKind, String)>,
}

impl Found {
    fn new(budget: Budget) -> Self {
        let (vertices, triangles, warnings) = (Vec::new(), Vec::new(), Vec::new());
        let (has, effort) = (Has::default(), Effort::default());
        let (colours, bad, sizes) = (Vec::new(), (0, None), FaceSizes::default());
        Found { budget, vertices, has, triangles, sizes, colours, faces: 0, bad, effort, crossing: 0, warnings }
    }

    fn read(&mut self, mut reader: impl BufRead) -> Checked<()> {
        let header::Found { header, lines, stray } = header::read(&mut reader)?;
        self.warnings.extend(stray.map(|stray| (LeftOut, stray)));
        let count = |name: &str| header.elements.get(name).map_or(0, |element| element.count);
        // What a header claims is refused before there is room for it.
        self.budget.check(count("face").saturating_add(count("tristrips")), count("vertex"))?;
        let mut records = Records::new(reader, header.encoding, lines);
        // Vertices may follow the faces that name them.
        let mut early = Vec::new();
        let mut has_vertices = false;
        self.faces = count("face").saturating_add(count("tristrips"));
        for (name, element) in &header.elements {
            match name.as_str() {
                "vertex" => {
                    self.read_vertices(&mut records, element)?;
                    has_vertices = true;
                }
                "face" | "tristrips" => {
                    Corners::check(element)?;
                    let add = if name == "face" { Found::add_face } else { Found::add_strips };
                    self.has.face_colours |= name == "face" && Has::of(element).colours;
                    records.each(element, |number, corners: Corners| {
                        if has_vertices {
                            return Ok(add(self, number, &corners)?);
                        }
                        early.push((add, number, corners));
                        Ok(())
                    })?;
                }
                other => {
                    records.each(element, |_, _: Ignored| Ok(()))?;
                    self.warnings.push((LeftOut, format!("the element {other:?} is ignored: only polygons are read")));
                }
            }
        }
        for (add, number, corners) in early {
            add(self, number, &corners)?;
        }
        if let (count, Some(first)) = &self.bad {
            let more = if *count > 1 { format!(" and {} more", count - 1) } else { String::new() };
            self.warnings.push((LeftOut, format!("{first}{more}: left out")));
        }
        if self.crossing > 0 {
            let count = self.crossing;
            let why = "left out: the outline crosses itself; split it into simple polygons";
            self.warnings.push((LeftOut, format!("{count} faces {why}")));
        }
        Ok(())
    }

    fn read_vertices(&mut self, records: &mut Records<impl BufRead>, element: &ElementDef) -> Checked<()> {
        self.has = Has { face_colours: self.has.face_colours, ..Has::of(element) };
        if !Has::all(element, &["x", "y", "z"]) {
            return Err("its vertices have no numbers x, y and z; is it a mesh?".into());
        }
        if self.has.foreign_colours {
            let why = "the vertices' colours are ignored: make them uchar, or float between 0 and 1";
            self.warnings.push((LeftOut, why.into()));
        }
        records.each(element, |_, vertex| {
            self.vertices.push(vertex);
            Ok(())
        })
    }

    fn add_face(&mut self, number: usize, face: &Corners) -> Unplaced<()> {
        match self.face(number, &face.list) {
            Ok(corners) => self.cut(&corners)?,
            Err(fault) => self.leave_out(fault),
        }
        self.colour(face.colour);
        Ok(())
    }

    /// The corners of a face that makes sense.
    fn face(&self, number: usize, corners: &[i64]) -> Unplaced<Vec<u32>> {
        if corners.len() < 3 {
            return Err(format!("face {number} has {} corners, and a face has at least 3", corners.len()));
        }
        corners.iter().map(|&corner| self.vertex(corner, || format!("face {number}"))).collect()
    }

    fn leave_out(&mut self, fault: String) {
        self.bad.0 += 1;
        self.bad.1.get_or_insert(fault);
    }

    /// The colour of the triangles that were added last.
    fn colour(&mut self, colour: [f32; 4]) {
        if self.has.face_colours {
            self.colours.resize(self.triangles.len(), colour);
        }
    }

    fn cut(&mut self, corners: &[u32]) -> Unplaced<()> {
        let before = self.triangles.len();
        let place = |&corner: &u32| DVec3::from(self.vertices[corner as usize].position.map(f64::from));
        match self.effort.cut(&corners.iter().map(place).collect::<Vec<_>>()) {
            Cut::Fan => self.triangles.extend(corners[1..].windows(2).map(|edge| [corners[0], edge[0], edge[1]])),
            Cut::Triangles(all) => self.triangles.extend(all.iter().map(|t| t.map(|corner| corners[corner as usize]))),
            Cut::Impossible => self.crossing += 1,
        }
        self.sizes.push(self.triangles.len() - before);
        self.effort.check()?;
        self.budget.check(self.triangles.len(), self.vertices.len())
    }

    /// Strips, each of which ends where a number is -1: every corner makes a triangle with the two before, whose sides alternate.
    fn add_strips(&mut self, number: usize, strips: &Corners) -> Unplaced<()> {
        let what = || format!("strip {number}");
        for strip in strips.list.split(|&corner| corner == -1) {
            let strip = match strip.iter().map(|&corner| self.vertex(corner, what)).collect::<Unplaced<Vec<u32>>>() {
                Ok(strip) => strip,
                Err(fault) => {
                    self.leave_out(fault);
                    continue;
                }
            };
            for (place, corners) in strip.windows(3).enumerate() {
                let [a, b, c] = [corners[0], corners[1], corners[2]];
                // Strips turn by corners that come twice.
                if a != b && b != c && c != a {
                    self.triangles.push(if place % 2 == 0 { [a, b, c] } else { [b, a, c] });
                    self.sizes.push(1);
                }
            }
            self.budget.check(self.triangles.len(), self.vertices.len())?;
        }
        self.colour(strips.colour);
        Ok(())
    }

    /// The vertex of this number.
    fn vertex(&self, number: i64, what: impl Fn() -> String) -> Unplaced<u32> {
        let count = self.vertices.len();
        let found = u32::try_from(number).ok().filter(|&number| (number as usize) < count);
        found.ok_or_else(|| {
            format!("{} names vertex {number}, but {count} precede it, counted from 0; correct it", what())
        })
    }

    /// The mesh, with the vertices that triangles use.
    fn mesh(self) -> Unplaced<Mesh> {
        const UNUSED: u32 = u32::MAX;
        let Found { mut vertices, mut has, mut triangles, colours, faces, bad, .. } = self;
        if triangles.is_empty() {
            return Err(match (faces, bad.1) {
                (0, _) => format!("a point cloud: {} vertices and no faces; make a mesh of it", vertices.len()),
                (_, Some(fault)) => format!("{fault}, and no face is left; write the file again"),
                _ => "there is no face in it that can be drawn; is it a mesh?".into(),
            });
        }
        if has.face_colours && !has.colours {
            part_by_colours(&mut vertices, &mut triangles, &colours);
            has.colours = true;
        }
        let mut numbers = vec![UNUSED; vertices.len()];
        let mut mesh = Mesh { materials: vec![0; triangles.len()], ..Mesh::default() };
        for corner in triangles.as_flattened_mut() {
            let number = &mut numbers[*corner as usize];
            if *number == UNUSED {
                *number = mesh.positions.len() as u32;
                append(&mut mesh, &vertices[*corner as usize], has)
                    .map_err(|fault| format!("vertex {corner}, counted from 0, {fault}; correct it"))?;
            }
            *corner = *number;
        }
        if mesh.normals.iter().all(|&normal| normal == Vec3::ZERO) {
            mesh.normals.clear();
        }
        Ok(Mesh { triangles, ..mesh })
    }
}

/// Gives each vertex the colour of its faces, and faces of other colours vertices of their own.
fn part_by_colours(vertices: &mut Vec<Vertex>, triangles: &mut [[u32; 3]], colours: &[[f32; 4]]) {
    let mut parted: HashMap<(u32, [u32; 4]), u32> = HashMap::new();
    let before = std::mem::take(vertices);
    for (triangle, &colour) in triangles.iter_mut().zip(colours) {
        for corner in triangle {
            let next = vertices.len() as u32;
            let number = *parted.entry((*corner, colour.map(f32::to_bits))).or_insert(next);
            if number == next {
                vertices.push(Vertex { colour, ..before[*corner as usize] });
            }
            *corner = number;
        }
    }
}

/// Adds a vertex and what it has.
fn append(mesh: &mut Mesh, vertex: &Vertex, has: Has) -> Unplaced<()> {
    let Vertex { position, normal, coordinates, colour } = *vertex;
    if !position.iter().all(|number| number.is_finite()) {
        return Err(format!("is at {position:?}, which is nowhere"));
    }
    mesh.positions.push(Vec3::from(position));
    if has.normals {
        mesh.normals.push(unit(DVec3::from(normal.map(f64::from))));
    }
    if has.coordinates {
        let [u, v] = coordinates;
        if !(u.is_finite() && v.is_finite()) {
            return Err(format!("has the texture coordinates {coordinates:?}, which are not finite"));
        }
        // Up in a file, down in a mesh.
        mesh.coordinates[0].push(Vec2::new(u, 1.0 - v));
    }
    if has.colours {
        mesh.colours.push(colour.into());
    }
    Ok(())
}
