//! How large a scene may be: as many primitives as can be numbered, and as a rendering has memory for.

use super::geometry::Geometry;
use crate::memory::Room;
use crate::scene::{MAX_PRIMITIVES, Mesh, Unplaced};

/// What is left for geometry, beside that which is placed.
#[derive(Debug, Clone, Copy)]
pub struct Budget {
    room: Room,
    triangles: usize,
    vertices: usize,
    round: usize,
}

/// What a triangle takes of memory from its file to the picture, in bytes. The most that a process held at once, on a CPU, a triangle,
/// less what its vertices count: 306 to 330 for a hall and a forest of 1 million by each `--bvh`, 292 and 298 for a hall of 4 million;
/// a sphere, 343 of 1 million with what is of no sphere.
const PRIMITIVE: u64 = 340;
/// What a triangle or a sphere takes that is packed of a scene in memory, in bytes, beside that: at most 185 of 9.7 million, measured as above
/// by each `--bvh`.
const PACKED: u64 = 220;
/// What a vertex takes, used or not: its numbers while it is read, in a list that doubles as it grows.
const VERTEX: u64 = 36;
/// What a byte of a texture takes: itself, and its levels twice, as colours and as numbers, with a third more than the finest.
const TEXEL: u64 = 4;

impl Budget {
    /// All of the room there is.
    pub fn new(room: Room) -> Self {
        Budget { room, triangles: 0, vertices: 0, round: 0 }
    }

    /// Refuses so many triangles more, of so many vertices, before anything is allocated for them.
    ///
    /// # Errors
    /// How many triangles there would be, and what they would take of what there is.
    pub fn check(&self, triangles: usize, vertices: usize) -> Unplaced<()> {
        let all = Budget {
            triangles: self.triangles.saturating_add(triangles),
            vertices: self.vertices.saturating_add(vertices),
            ..*self
        };
        let Budget { triangles, vertices, .. } = all;
        all.fits().map_err(|why| format!("{triangles} triangles with {vertices} vertices {why}; use fewer"))
    }

    /// Refuses so many spheres and disks more.
    ///
    /// # Errors
    /// How many of them there would be, and what they would take of what there is.
    pub fn check_round(&self, count: usize) -> Unplaced<()> {
        let all = Budget { round: self.round.saturating_add(count), ..*self };
        all.fits().map_err(|why| format!("{} spheres and disks {why}; use fewer", all.round))
    }

    /// Refuses textures of so many bytes.
    ///
    /// # Errors
    /// What they would take of what there is.
    pub fn check_textures(&self, bytes: u64) -> Unplaced<()> {
        let fits = self.room.check(bytes.saturating_mul(TEXEL));
        fits.map_err(|why| format!("textures of {bytes} bytes {why}; use smaller ones"))
    }

    /// Refuses a scene of so many primitives that takes so many bytes in memory, without being read from text.
    ///
    /// # Errors
    /// How many there are, and what they would take of what there is.
    pub fn check_packed(&self, primitives: usize, bytes: u64) -> Unplaced<()> {
        if primitives > MAX_PRIMITIVES {
            return Err(format!("{primitives} are more than the {MAX_PRIMITIVES} primitives that a scene may have"));
        }
        let fits = self.room.check(bytes.saturating_add(PACKED * primitives as u64));
        fits.map_err(|why| format!("{primitives} primitives {why}; end other programs or use a smaller scene"))
    }

    /// Refuses so many bytes for anything else.
    ///
    /// # Errors
    /// What they would take of what there is.
    pub fn check_bytes(&self, bytes: u64) -> Unplaced<()> {
        self.room.check(bytes)
    }

    fn fits(&self) -> Unplaced<()> {
        let primitives = self.triangles.saturating_add(self.round);
        if primitives > MAX_PRIMITIVES {
            return Err(format!("are more than the {MAX_PRIMITIVES} primitives that a scene may have"));
        }
        let vertices = VERTEX.saturating_mul(self.vertices as u64);
        self.room.check((PRIMITIVE * primitives as u64).saturating_add(vertices))
    }

    /// Counts a mesh.
    pub fn take_mesh(&mut self, mesh: &Mesh) {
        self.triangles += mesh.triangles.len();
        self.vertices += mesh.positions.len();
    }

    /// Counts what is placed.
    pub fn take(&mut self, geometry: &Geometry) {
        match geometry {
            Geometry::Mesh(mesh) => self.take_mesh(mesh),
            Geometry::Spheres(spheres) => self.round += spheres.len(),
            Geometry::Disks(disks) => self.round += disks.len(),
        }
    }
}
