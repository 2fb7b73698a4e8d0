mod known;
mod random;

use std::collections::HashMap;

use glam::DVec3;

use super::*;
use crate::scene::normal;

fn point(position: DVec3, radius: f64) -> ControlPoint {
    ControlPoint { position: position.as_vec3(), radius: radius as f32 }
}

fn strands(points: &[ControlPoint]) -> Strands {
    let mut strands = Strands::default();
    strands.push(Strand { points, ups: &[], colours: &[] });
    strands
}

fn mesh(curves: &Curves, points: &[ControlPoint]) -> Mesh {
    curves.mesh(&strands(points))
}

fn round(basis: Basis, tolerance: f32) -> Curves {
    Curves { basis, tolerance: Some(tolerance), ..Curves::default() }
}

fn corners(mesh: &Mesh) -> impl Iterator<Item = [DVec3; 3]> {
    mesh.triangles.iter().map(|corners| corners.map(|vertex| mesh.positions[vertex as usize].as_dvec3()))
}

/// How often there is an edge from one place to another, each way.
fn edges(mesh: &Mesh) -> Vec<[u32; 2]> {
    let mut edges: HashMap<_, u32> = HashMap::new();
    let place = |vertex: u32| normal::place(mesh.positions[vertex as usize]);
    for [a, b, c] in mesh.triangles.iter().map(|corners| corners.map(place)) {
        [(a, b), (b, c), (c, a)].into_iter().for_each(|edge| *edges.entry(edge).or_default() += 1);
    }
    edges.iter().map(|(&(a, b), &count)| [count, edges.get(&(b, a)).copied().unwrap_or_default()]).collect()
}

/// Every edge once each way.
fn assert_closed(mesh: &Mesh) {
    assert!(!mesh.triangles.is_empty());
    assert!(edges(mesh).iter().all(|&counts| counts == [1, 1]), "an edge is open, or there more than once");
}

fn assert_sound(mesh: &Mesh) {
    assert!(mesh.positions.iter().all(|place| place.is_finite()));
    assert!(mesh.normals.iter().all(|normal| normal.is_normalized()), "a normal is none");
    assert!(
        mesh.tangents
            .iter()
            .zip(&mesh.normals)
            .all(|(t, n)| { t.truncate().is_normalized() && t.truncate().dot(*n).abs() < 1e-6 && t.w == 1.0 })
    );
    assert!(mesh.coordinates[0].iter().all(|place| place.cmpge(glam::Vec2::ZERO).all() && place.max_element() <= 1.0));
    let count = mesh.positions.len();
    assert!(mesh.normals.len() == count && mesh.triangles.len() == mesh.materials.len());
    assert!(mesh.triangles.iter().flatten().all(|&vertex| (vertex as usize) < count));
}
