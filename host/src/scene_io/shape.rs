//! Meshes of the shapes that a scene file names.

use std::collections::HashMap;

use glam::Vec2;
use glam::{DVec3, Vec3};

use crate::math;
use crate::scene::{Disk, Mesh, Sphere};

/// Spheres: icosahedra whose triangles are split in four `steps` times, 20 * 4^n of them each, with the spheres' own
/// normals. Neighbours share their vertices, so that there is no crack.
pub fn spheres(spheres: &[Sphere], steps: u32) -> Mesh {
    let (mut points, mut triangles) = icosahedron();
    for _ in 0..steps {
        triangles = split(&mut points, &triangles);
    }
    let place = |sphere: &Sphere| {
        let (center, radius) = (sphere.center.as_dvec3(), f64::from(sphere.radius));
        points.iter().map(move |point| (center + *point * radius).as_vec3())
    };
    let normals = spheres.iter().flat_map(|_| points.iter().map(|point| point.as_vec3()));
    let firsts = (0..spheres.len()).map(|number| (number * points.len()) as u32);
    let shifted = firsts.flat_map(|first| triangles.iter().map(move |triangle| triangle.map(|vertex| first + vertex)));
    Mesh { positions: spheres.iter().flat_map(place).collect(), normals: normals.collect(), ..flat(shifted.collect()) }
}

/// How many triangles and vertices [`spheres`] makes.
pub fn spheres_size(count: usize, steps: u32) -> (usize, usize) {
    let triangles = 20 << (2 * steps);
    (count * triangles, count * (triangles / 2 + 2))
}

/// A disk: a fan of triangles around its center, whose corners lie on the rim.
pub fn disk(disk: &Disk, triangles: u32) -> Mesh {
    let (center, normal) = (disk.center.as_dvec3(), disk.normal.as_dvec3().normalize());
    let right = normal.any_orthonormal_vector();
    let (right, up) = (right * f64::from(disk.radius), normal.cross(right) * f64::from(disk.radius));
    let rim = (0..triangles).map(|corner| {
        let (sine, cosine) = math::sin_cos(std::f64::consts::TAU * f64::from(corner) / f64::from(triangles));
        (center + right * cosine + up * sine).as_vec3()
    });
    let fan = (1..=triangles).map(|corner| [0, corner, corner % triangles + 1]);
    Mesh { positions: std::iter::once(disk.center).chain(rim).collect(), ..flat(fan.collect()) }
}

/// Texture coordinates of a quad's corners: a picture stands upright where the first corner is its lower left.
const UPRIGHT: [Vec2; 4] = [Vec2::new(0.0, 1.0), Vec2::ONE, Vec2::new(1.0, 0.0), Vec2::ZERO];

/// A parallelogram or any flat convex quadrilateral, from its corners counter-clockwise.
pub fn quad(corners: [Vec3; 4]) -> Mesh {
    let coordinates = [UPRIGHT.to_vec(), Vec::new()];
    Mesh { positions: corners.to_vec(), coordinates, ..flat(vec![[0, 1, 2], [0, 2, 3]]) }
}

/// The corners of each side of a box: bit 0 of a corner's number is x, bit 1 is y, bit 2 is z.
const SIDES: [[u32; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
/// Which of [`UPRIGHT`] is the first corner's, so that pictures are upright on the four sides around, and their lower edges in front on
/// top.
const TURNS: [usize; 6] = [0, 1, 0, 3, 1, 0];

/// A box along the axes from its least to its greatest corner, seen from outside.
pub fn cuboid(min: Vec3, max: Vec3) -> Mesh {
    let corner = |bits: u32| {
        let side = |axis: usize| [min[axis], max[axis]][(bits >> axis & 1) as usize];
        Vec3::new(side(0), side(1), side(2))
    };
    let halves = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
    Mesh { positions: (0..8).map(corner).collect(), ..flat(SIDES.into_iter().flat_map(halves).collect()) }
}

/// The same whose sides have corners and texture coordinates of their own.
pub fn covered_cuboid(min: Vec3, max: Vec3) -> Mesh {
    let shared = cuboid(min, max);
    let positions = SIDES.as_flattened().iter().map(|&corner| shared.positions[corner as usize]);
    let coordinates = TURNS.iter().flat_map(|turn| (0..4).map(move |corner| UPRIGHT[(corner + turn) % 4]));
    let triangles =
        (0..SIDES.len() as u32).flat_map(|side| [[0, 1, 2], [0, 2, 3]].map(|half| half.map(|k| 4 * side + k)));
    let coordinates = [coordinates.collect(), Vec::new()];
    Mesh { positions: positions.collect(), coordinates, ..flat(triangles.collect()) }
}

/// Triangles of one material.
fn flat(triangles: Vec<[u32; 3]>) -> Mesh {
    Mesh { materials: vec![0; triangles.len()], triangles, ..Mesh::default() }
}

/// Unit vectors and triangles, counter-clockwise seen from outside.
fn icosahedron() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let mut points = Vec::new();
    for (one, long) in [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)] {
        points.push(DVec3::new(one, long, 0.0).normalize());
    }
    for (one, long) in [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)] {
        points.push(DVec3::new(0.0, one, long).normalize());
    }
    for (one, long) in [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)] {
        points.push(DVec3::new(long, 0.0, one).normalize());
    }
    let triangles = vec![
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    (points, triangles)
}

/// Splits every triangle in four; an edge's middle is made once and moved out to the sphere.
fn split(points: &mut Vec<DVec3>, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut middles = HashMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            points.push((points[a as usize] + points[b as usize]).normalize());
            points.len() as u32 - 1
        })
    };
    let mut parts = Vec::with_capacity(4 * triangles.len());
    for &[a, b, c] in triangles {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        parts.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    parts
}
