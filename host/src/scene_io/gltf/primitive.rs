//! A part of a mesh: its triangles, and of its vertices those in use.

use std::collections::HashMap;

use glam::{Vec2, Vec3, Vec4};

use super::accessor::{Accessors, Elements};
use super::document;
use super::skin::Bond;
use super::vertices::Vertices;
use crate::scene::Unplaced;

/// One in the units of its mesh. Each list of vertices has as many elements as `positions`, or none at all.
pub struct Primitive {
    pub positions: Vec<Vec3>,
    pub normals: Vec<Vec3>,
    pub tangents: Vec<Vec4>,
    pub coordinates: [Vec<Vec2>; 2],
    pub colours: Vec<Vec4>,
    /// The joints that its vertices follow at a node with a skin.
    pub bond: Bond,
    pub triangles: Vec<[u32; 3]>,
}

/// How corners make triangles.
#[derive(Clone, Copy)]
pub enum Mode {
    Triangles,
    Strip,
    Fan,
}

/// What shape a primitive has at its nodes.
pub struct Shape<'d> {
    /// Of its morph targets.
    pub weights: &'d [f64],
    /// Does it follow joints anywhere?
    pub is_skinned: bool,
}

/// What is asked of a file before anything is read.
pub struct Plan<'f> {
    mode: Mode,
    positions: Elements<'f>,
    indices: Option<Elements<'f>>,
    /// At most as many as will be read.
    pub triangles: usize,
    /// Likewise.
    pub vertices: usize,
}

impl Mode {
    /// By the number that glTF has for it; `None` for points and lines.
    ///
    /// # Errors
    /// There is no such mode.
    pub fn from_code(code: Option<u64>) -> Unplaced<Option<Self>> {
        match code.unwrap_or(4) {
            0..=3 => Ok(None),
            4 => Ok(Some(Mode::Triangles)),
            5 => Ok(Some(Mode::Strip)),
            6 => Ok(Some(Mode::Fan)),
            other => Err(format!("mode: {other} is none of 0 to 6; write the file again")),
        }
    }

    fn triangles(self, corners: usize) -> usize {
        match self {
            Mode::Triangles => corners / 3,
            Mode::Strip | Mode::Fan => corners.saturating_sub(2),
        }
    }

    /// The corners of a triangle, turned so that all show the same side.
    fn corners(self, triangle: usize) -> [usize; 3] {
        match self {
            Mode::Triangles => [0, 1, 2].map(|corner| 3 * triangle + corner),
            Mode::Strip => [triangle, triangle + 1 + triangle % 2, triangle + 2 - triangle % 2],
            Mode::Fan => [triangle + 1, triangle + 2, 0],
        }
    }
}

impl<'f> Plan<'f> {
    /// Looks at a primitive whose positions are the list of a number; `owner` is its JSON path.
    ///
    /// # Errors
    /// Those of [`Accessors::open`].
    pub fn new(
        of: &document::Primitive,
        positions: usize,
        mode: Mode,
        accessors: &Accessors<'f>,
        owner: &str,
    ) -> Unplaced<Self> {
        let positions = accessors.open(positions, &[3], &format!("{owner}.attributes.POSITION"))?;
        let indices = of.indices.map(|number| accessors.indices(number, &format!("{owner}.indices"))).transpose()?;
        let corners = indices.as_ref().map_or(positions.count, |indices| indices.count);
        let triangles = mode.triangles(corners);
        let vertices = positions.count.min(3 * triangles);
        Ok(Plan { mode, positions, indices, triangles, vertices })
    }

    /// Reads it. Of what is not finite, positions are refused; a normal or tangent becomes none, and a coordinate zero.
    ///
    /// # Errors
    /// An index or a position that makes no sense, or an attribute of another length.
    pub fn read(
        &self,
        of: &document::Primitive,
        shape: &Shape,
        accessors: &Accessors<'f>,
        owner: &str,
    ) -> Unplaced<Primitive> {
        let (triangles, used) = self.triangles(owner)?;
        let vertices = Vertices { used: &used, count: self.positions.count, accessors, owner };
        let attribute = |key: &str, widths: &[usize]| vertices.attribute(&of.attributes, key, widths, "attributes");
        let normals = attribute("NORMAL", &[3])?;
        // Without normals, a file's tangents mean nothing.
        let tangents = if normals.is_some() { attribute("TANGENT", &[4])? } else { None };
        let pair = |pair| finite(Vec2::from_array(pair), Vec2::is_finite, Vec2::ZERO);
        let mut primitive = Primitive {
            positions: self.positions(&used, owner)?,
            normals: vertices.list(normals, |normal| finite(Vec3::from_array(normal), Vec3::is_finite, Vec3::ZERO)),
            tangents: vertices.list(tangents, |tangent| finite(Vec4::from_array(tangent), Vec4::is_finite, Vec4::ZERO)),
            coordinates: [
                vertices.list(attribute("TEXCOORD_0", &[2])?, pair),
                vertices.list(attribute("TEXCOORD_1", &[2])?, pair),
            ],
            colours: colours(attribute("COLOR_0", &[3, 4])?, &vertices),
            bond: if shape.is_skinned { Bond::of(of, &vertices)? } else { Bond::default() },
            triangles,
        };
        primitive.morph(of, shape.weights, &vertices)?;
        Ok(primitive)
    }

    fn positions(&self, used: &[u32], owner: &str) -> Unplaced<Vec<Vec3>> {
        let position = |&number: &u32| {
            let position = Vec3::from_array(self.positions.vector(number as usize));
            let fault = || {
                format!(
                    "{owner}.attributes.POSITION: vertex {number} is at {position}, which is no place; repair the mesh"
                )
            };
            if position.is_finite() { Ok(position) } else { Err(fault()) }
        };
        used.iter().map(position).collect()
    }

    /// The triangles, by the places of their vertices among those in use, and these.
    fn triangles(&self, owner: &str) -> Unplaced<(Vec<[u32; 3]>, Vec<u32>)> {
        let mut used = Vec::new();
        let mut places = HashMap::new();
        let mut place = |corner: usize| {
            let vertex = match &self.indices {
                Some(indices) => indices.whole(corner),
                None => u32::try_from(corner).unwrap_or(u32::MAX),
            };
            if vertex as usize >= self.positions.count {
                let count = self.positions.count;
                return Err(format!(
                    "{owner}.indices: corner {corner} names vertex {vertex} of {count}; repair the mesh"
                ));
            }
            let next = used.len() as u32;
            Ok(*places.entry(vertex).or_insert_with(|| {
                used.push(vertex);
                next
            }))
        };
        let mut triangles = Vec::with_capacity(self.triangles);
        for triangle in 0..self.triangles {
            let [a, b, c] = self.mode.corners(triangle);
            triangles.push([place(a)?, place(b)?, place(c)?]);
        }
        Ok((triangles, used))
    }
}

fn colours(elements: Option<Elements>, vertices: &Vertices) -> Vec<Vec4> {
    let is_opaque = elements.as_ref().is_some_and(|elements| elements.width == 3);
    vertices.list(elements, |colour| {
        let colour = finite(Vec4::from_array(colour), Vec4::is_finite, Vec4::ONE).clamp(Vec4::ZERO, Vec4::ONE);
        if is_opaque { colour.with_w(1.0) } else { colour }
    })
}

fn finite<T: Copy>(vector: T, is_finite: fn(T) -> bool, otherwise: T) -> T {
    if is_finite(vector) { vector } else { otherwise }
}
