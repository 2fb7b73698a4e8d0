//! The surface of a strand, of either kind.

use glam::{DVec3, Vec2, Vec3, Vec4};

use super::basis::{Value, bezier};
use super::ribbon::Ribbon;
use super::stations::Station;
use super::tube::Tube;
use super::{CurveKind, Curves, Strand};
use crate::scene::Mesh;
use crate::scene::normal::unit;

/// What becomes of a strand.
pub struct Outline<'s> {
    curves: &'s Curves,
    strand: Strand<'s>,
    of: Kind,
}

enum Kind {
    Tube(Tube),
    Ribbon(Ribbon),
}

impl<'s> Outline<'s> {
    pub fn of(curves: &'s Curves, strand: Strand<'s>) -> Outline<'s> {
        let of = match curves.kind {
            CurveKind::Round => Kind::Tube(Tube::of(curves, &strand)),
            CurveKind::Ribbon => Kind::Ribbon(Ribbon { up: curves.up.map(Vec3::as_dvec3) }),
        };
        Outline { curves, strand, of }
    }

    /// The most triangles and vertices that there are at a station and on the way from the one before.
    pub fn station_size(&self) -> (usize, usize) {
        match &self.of {
            Kind::Tube(tube) => tube.station_size(),
            Kind::Ribbon(_) => Ribbon::STATION,
        }
    }

    /// The same of both ends together.
    pub fn ends_size(&self) -> (usize, usize) {
        match &self.of {
            Kind::Tube(tube) => tube.ends_size(),
            Kind::Ribbon(_) => (0, 0),
        }
    }

    /// Adds it to a mesh.
    pub fn add(&self, mesh: &mut Mesh, stations: &[Station]) {
        let Outline { curves, strand, .. } = *self;
        let mut skin = Skin { mesh, curves, strand, along: 0.0, colour: None };
        match &self.of {
            Kind::Tube(tube) => tube.add(&mut skin, stations),
            Kind::Ribbon(ribbon) => ribbon.add(&mut skin, stations),
        }
    }
}

/// The stations with the shares of the strand's length at which they are.
pub fn along(stations: &[Station]) -> impl Iterator<Item = (&Station, f64)> {
    let steps = stations.windows(2).map(|pair| pair[0].center.distance(pair[1].center));
    let whole: f64 = steps.clone().sum();
    let shares = std::iter::once(0.0).chain(steps.scan(0.0, move |length, step| {
        *length += step;
        Some(if whole > 0.0 { *length / whole } else { 0.0 })
    }));
    stations.iter().zip(shares)
}

/// A vertex of a strand, but for what all of a station have.
pub struct Vertex {
    pub place: DVec3,
    pub normal: DVec3,
    pub tangent: DVec3,
    /// The second texture coordinate.
    pub across: f64,
}

/// The part of a mesh that is a strand.
pub struct Skin<'m> {
    mesh: &'m mut Mesh,
    pub curves: &'m Curves,
    strand: Strand<'m>,
    along: f64,
    colour: Option<Vec4>,
}

impl Skin<'_> {
    /// The next vertices are at this station, at this share of the length.
    pub fn go_to(&mut self, station: &Station, along: f64) {
        self.along = along;
        let colour = self.at(self.strand.colours, station, |colour: Vec4| colour.as_dvec4());
        // Splines may go beyond their points.
        self.colour = colour.map(|colour| colour.as_vec4().clamp(Vec4::ZERO, Vec4::ONE));
    }

    /// What the strand says of where it faces there.
    pub fn up(&self, station: &Station) -> Option<DVec3> {
        self.at(self.strand.ups, station, |up: Vec3| up.as_dvec3())
    }

    /// The value of control points at a station.
    fn at<T: Copy, V: Value>(&self, all: &[T], station: &Station, value: impl Fn(T) -> V) -> Option<V> {
        if all.is_empty() {
            return None;
        }
        let piece = self.curves.basis.piece(station.piece, all.len(), |at| value(all[at]));
        Some(bezier(piece, station.share))
    }

    /// The number of the vertex that will be added next.
    pub fn next_number(&self) -> u32 {
        self.mesh.positions.len() as u32
    }

    /// Adds a vertex and returns its number.
    pub fn vertex(&mut self, vertex: &Vertex) -> u32 {
        let number = self.next_number();
        let Skin { mesh, curves, along, colour, .. } = self;
        mesh.positions.push(vertex.place.as_vec3());
        mesh.normals.push(unit(vertex.normal));
        if curves.has_coordinates {
            mesh.coordinates[0].push(Vec2::new(*along as f32, vertex.across as f32));
        }
        if curves.has_tangents {
            // The second coordinate leads down, and so against the bitangent.
            mesh.tangents.push(unit(vertex.tangent).extend(1.0));
        }
        mesh.colours.extend(*colour);
        number
    }

    /// Adds a triangle, unless two of its corners are at one place, as at a tip: then its neighbours meet there.
    pub fn triangle(&mut self, corners: [u32; 3]) {
        let [a, b, c] = corners.map(|vertex| self.mesh.positions[vertex as usize]);
        if a != b && b != c && c != a {
            self.mesh.triangles.push(corners);
        }
    }
}
