//! Subdivision surfaces: smooth ones, of which a mesh is the cage.

mod cage;
mod edges;
mod fineness;
#[cfg(test)]
mod tests;

use std::collections::HashMap;

use glam::{DVec3, Vec3};

pub use self::cage::Cage;
use self::cage::Corner;
use self::edges::{Around, Edges, Kind};
pub use self::fineness::{Eye, Fineness};
use super::Mesh;
use super::normal::unit;

/// How a cage becomes a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Subdivision {
    /// How often each face is divided, at least once: into as many quads as it has corners, and each of those into four each time.
    pub levels: u32,
    /// Edges of the cage whose faces turn by more than this angle stay sharp, in degrees; none without.
    pub crease: Option<f32>,
}

/// The Catmull-Clark surface of a cage as triangles, with smooth normals but over sharp edges: vertices lie on the surface itself, at its
/// limit. It has texture coordinates and colours where the mesh has them that the cage is of, interpolated linearly.
///
/// # Panics
/// If there are no levels.
pub fn subdivided(mut cage: Cage, of: &Mesh, how: Subdivision) -> Mesh {
    assert!(how.levels > 0, "a surface is divided once at least");
    if let Some(angle) = how.crease {
        cage.sharp = sharp(&cage, angle);
    }
    for _ in 0..how.levels {
        cage = cage.refined();
    }
    let edges = Edges::of(&cage);
    let normals = normals(&cage, &edges);
    cage.positions = limits(&cage, &edges);
    triangles(&cage, &normals, of)
}

/// How many triangles and, at most, vertices there will be.
pub fn size(cage: &Cage, levels: u32) -> (usize, usize) {
    let quads = cage.corners.len().saturating_mul(1_usize.checked_shl(2 * (levels - 1)).unwrap_or(usize::MAX));
    (quads.saturating_mul(2), quads.saturating_mul(4))
}

/// The edges where faces turn by more than an angle.
fn sharp(cage: &Cage, angle: f32) -> Vec<[u32; 2]> {
    let least = f64::from(angle).to_radians();
    let normal = |face: &[Corner]| {
        let place = |corner: &Corner| cage.positions[corner.vertex as usize];
        let spokes = face[1..].iter().map(|corner| place(corner) - place(&face[0]));
        spokes.clone().zip(spokes.skip(1)).map(|(a, b)| a.cross(b)).sum::<DVec3>()
    };
    let normals: Vec<DVec3> = cage.faces().map(normal).collect();
    let turns = |[a, b]: [u32; 2]| {
        let (a, b) = (normals[a as usize], normals[b as usize]);
        crate::math::atan2(a.cross(b).length(), a.dot(b)) > least
    };
    let edges = Edges::of(cage).all;
    let mut sharp: Vec<_> = edges.iter().filter(|e| e.count == 2 && turns(e.faces)).map(|e| e.vertices).collect();
    sharp.sort_unstable();
    sharp
}

/// Where the vertices of quads come to, were they divided for ever (Halstead, Kass and DeRose, Efficient, fair interpolation using
/// Catmull-Clark surfaces, 1993).
fn limits(cage: &Cage, edges: &Edges) -> Vec<DVec3> {
    let mut around = vec![Around::default(); cage.positions.len()];
    for face in cage.faces() {
        for (at, corner) in face.iter().enumerate() {
            let opposite = face[(at + 2) % face.len()].vertex;
            let around = &mut around[corner.vertex as usize];
            around.faces += cage.positions[opposite as usize];
            around.face_count += 1;
        }
    }
    edges.ends(cage, &mut around);
    let limit = |(&at, around): (&DVec3, &Around)| match around.kind() {
        Kind::Stays => at,
        Kind::Crease => (4.0 * at + around.creased) / 6.0,
        Kind::Smooth => {
            let count = f64::from(around.edges);
            (count * count * at + 4.0 * around.neighbours + around.faces) / (count * (count + 5.0))
        }
    };
    cage.positions.iter().zip(&around).map(limit).collect()
}

/// The normal of each corner: the mean of the faces around it up to the next creases, weighted by their areas.
fn normals(cage: &Cage, edges: &Edges) -> Vec<Vec3> {
    let mut groups: Vec<u32> = (0..cage.corners.len() as u32).collect();
    let next = |corner: u32| if corner % 4 == 3 { corner - 3 } else { corner + 1 };
    let mut sides = vec![None; edges.all.len()];
    for (corner, &edge) in (0..).zip(&edges.of_corners) {
        if edges.all[edge as usize].smooth().is_none() {
            continue;
        }
        let Some(other) = sides[edge as usize].replace(corner) else { continue };
        // Faces that are turned alike pass their common edge in opposite ways.
        let starts_alike = cage.corners[other as usize].vertex == cage.corners[corner as usize].vertex;
        let pairs = match starts_alike {
            true => [(corner, other), (next(corner), next(other))],
            false => [(corner, next(other)), (next(corner), other)],
        };
        pairs.into_iter().for_each(|(a, b)| join(&mut groups, a, b));
    }
    let place = |corner: usize| cage.positions[cage.corners[corner].vertex as usize];
    let mut sums = vec![DVec3::ZERO; groups.len()];
    for corner in 0..groups.len() {
        let (before, after) = (corner / 4 * 4 + (corner + 3) % 4, corner / 4 * 4 + (corner + 1) % 4);
        let area = (place(after) - place(corner)).cross(place(before) - place(corner));
        sums[root(&mut groups, corner as u32) as usize] += area;
    }
    (0..groups.len() as u32).map(|corner| unit(sums[root(&mut groups, corner) as usize])).collect()
}

fn root(groups: &mut [u32], of: u32) -> u32 {
    let mut at = of;
    while groups[at as usize] != at {
        groups[at as usize] = groups[groups[at as usize] as usize];
        at = groups[at as usize];
    }
    at
}

fn join(groups: &mut [u32], a: u32, b: u32) {
    let (a, b) = (root(groups, a), root(groups, b));
    groups[a.max(b) as usize] = a.min(b);
}

/// Two triangles a quad, whose vertices are those that are used, each once; with what the mesh has.
fn triangles(cage: &Cage, normals: &[Vec3], of: &Mesh) -> Mesh {
    let mut mesh = Mesh::default();
    let mut known: HashMap<[u32; 12], u32> = HashMap::new();
    let mut vertex = |corner: usize| {
        let (Corner { vertex, coordinates: [first, second], colour }, normal) = (cage.corners[corner], normals[corner]);
        let n = normal.to_array();
        let values = [n[0], n[1], n[2], first.x, first.y, second.x, second.y, colour.x, colour.y, colour.z, colour.w];
        let mut key = [vertex; 12];
        key[1..].copy_from_slice(&values.map(f32::to_bits));
        *known.entry(key).or_insert_with(|| {
            mesh.positions.push(cage.positions[vertex as usize].as_vec3());
            mesh.normals.push(normal);
            for (set, coordinates) in [first, second].into_iter().enumerate() {
                mesh.coordinates[set].extend((!of.coordinates[set].is_empty()).then_some(coordinates));
            }
            mesh.colours.extend((!of.colours.is_empty()).then_some(colour));
            mesh.positions.len() as u32 - 1
        })
    };
    let mut all = Vec::with_capacity(cage.corners.len() / 2);
    for quad in 0..cage.ends.len() {
        let [a, b, c, d] = [0, 1, 2, 3].map(|corner| vertex(4 * quad + corner));
        all.extend([[a, b, c], [a, c, d]]);
    }
    mesh.triangles = all;
    mesh.materials = cage.materials.iter().flat_map(|&material| [material; 2]).collect();
    mesh
}
