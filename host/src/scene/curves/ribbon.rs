//! Strands as flat ribbons, which are seen from both sides.

use glam::DVec3;

use super::frame::Frame;
use super::outline::{Skin, Vertex, along};
use super::stations::Station;

/// A ribbon of one width, along which there are two vertices at each station.
pub struct Ribbon {
    /// Where its front faces where the strand says nothing.
    pub up: Option<DVec3>,
}

impl Ribbon {
    /// Triangles and vertices.
    pub const STATION: (usize, usize) = (2, 2);

    /// Adds it to a mesh.
    pub fn add(&self, skin: &mut Skin, stations: &[Station]) {
        let mut frame = Frame::default();
        let mut last = None;
        for (station, along) in along(stations) {
            skin.go_to(station, along);
            let own = skin.up(station).filter(|&up| up != DVec3::ZERO);
            let normal = frame.normal(station, own.or(self.up));
            let left = normal.cross(station.tangent) * station.radius;
            let edge = |aside: DVec3, across: f64| Vertex {
                place: station.center + aside,
                normal,
                tangent: station.tangent,
                across,
            };
            let edges = [skin.vertex(&edge(left, 0.0)), skin.vertex(&edge(-left, 1.0))];
            if let Some([a, b]) = last.replace(edges) {
                let [d, c] = edges;
                skin.triangle([a, b, c]);
                skin.triangle([a, c, d]);
            }
        }
    }
}
