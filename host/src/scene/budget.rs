//! How large a scene may be: as many triangles as can be numbered, and as a rendering has memory for.

use super::{MAX_TRIANGLES, Mesh, Unplaced};
use crate::memory::Room;

/// What is left for meshes, beside those that are placed.
#[derive(Debug, Clone, Copy)]
pub struct Budget {
    room: Room,
    triangles: usize,
    vertices: usize,
}

/// What a triangle takes of memory from its file to the picture, in bytes. The most that a process held at once,
/// on a CPU, a triangle: 654 to 687 for halls and forests of 1 and 4 million, 721 for a hall with `--bvh high`,
/// 646 to 664 for spheres of 1.3 and 3.9 million with either quality.
const TRIANGLE: u64 = 720;
/// What a vertex takes, used or not: its numbers here and in tobj, whose list doubles as it grows.
const VERTEX: u64 = 36;

impl Budget {
    /// All of the room there is.
    pub fn new(room: Room) -> Self {
        Budget { room, triangles: 0, vertices: 0 }
    }

    /// Refuses so many triangles more, of so many vertices, before anything is allocated for them.
    ///
    /// # Errors
    /// How many triangles there would be, and what they would take of what there is.
    pub fn check(&self, triangles: usize, vertices: usize) -> Unplaced<()> {
        let (triangles, vertices) = (self.triangles + triangles, self.vertices + vertices);
        if triangles > MAX_TRIANGLES {
            return Err(format!("the scene has more than {MAX_TRIANGLES} triangles; simplify its meshes"));
        }
        let bytes = TRIANGLE * triangles as u64 + VERTEX * vertices as u64;
        let refused = |why| format!("{triangles} triangles with {vertices} vertices {why}; use fewer");
        self.room.check(bytes).map_err(refused)
    }

    /// Counts a mesh that is placed.
    pub fn take(&mut self, mesh: &Mesh) {
        self.triangles += mesh.triangles.len();
        self.vertices += mesh.positions.len();
    }
}
