use glam::{Vec2, Vec3};

use super::*;

fn subdivided(mesh: &Mesh, faces: &[u32], how: Subdivision) -> Mesh {
    super::subdivided(Cage::of(mesh, faces), mesh, how)
}

fn size(mesh: &Mesh, faces: &[u32], levels: u32) -> (usize, usize) {
    super::size(&Cage::of(mesh, faces), levels)
}

/// A cube of edge 2 in the middle, of quads that share their vertices.
fn cube() -> (Mesh, Vec<u32>) {
    let corner =
        |i: u32| Vec3::new([-1.0, 1.0][i as usize & 1], [-1.0, 1.0][i as usize >> 1 & 1], [-1.0, 1.0][i as usize >> 2]);
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles: Vec<[u32; 3]> = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let mesh = Mesh {
        positions: (0..8).map(corner).collect(),
        materials: (0..12).map(|i| i / 2).collect(),
        triangles,
        ..Mesh::default()
    };
    (mesh, vec![2; 6])
}

fn smooth(levels: u32) -> Subdivision {
    Subdivision { levels, crease: None }
}

/// A flat grid of quads, with its place as texture coordinates.
fn grid(count: u32) -> (Mesh, Vec<u32>) {
    let at = |i: u32| Vec2::new((i % (count + 1)) as f32, (i / (count + 1)) as f32);
    let quad = |i: u32| {
        let a = i / count * (count + 1) + i % count;
        [[a, a + 1, a + count + 2], [a, a + count + 2, a + count + 1]]
    };
    let mesh = Mesh {
        positions: (0..(count + 1).pow(2)).map(|i| at(i).extend(0.0)).collect(),
        coordinates: [(0..(count + 1).pow(2)).map(at).collect(), Vec::new()],
        triangles: (0..count * count).flat_map(quad).collect(),
        materials: vec![0; 2 * (count * count) as usize],
        ..Mesh::default()
    };
    (mesh, vec![2; (count * count) as usize])
}

/// Where a cube's corners, edges and faces come to does not depend on how often it was divided, and is known: the masks of Halstead and
/// others, by hand.
#[test]
fn the_surface_of_a_cube_goes_through_places_that_are_known() {
    let (mesh, faces) = cube();
    // (9 v + 4 (three neighbours) + (three opposite)) / 24 of the cube that was divided once: its vertex at 5/9, edges at (0, 3/4, 3/4),
    // faces at (0, 0, 1).
    let corner = Vec3::splat((9.0 * 5.0 / 9.0 + 4.0 * 1.5 + 1.0) as f32 / 24.0);
    for levels in 1..5 {
        let fine = subdivided(&mesh, &faces, smooth(levels));
        assert_eq!(fine.triangles.len(), 2 * 24 * 4_usize.pow(levels - 1));
        assert_eq!(size(&mesh, &faces, levels).0, fine.triangles.len());
        assert!(fine.positions.len() <= size(&mesh, &faces, levels).1);
        let nearest = |to: Vec3| fine.positions.iter().map(|at| at.distance(to)).fold(f32::INFINITY, f32::min);
        assert!(nearest(corner) < 1e-6, "{levels}: {}", nearest(corner));
        // (16 v + 4 (four neighbours) + (four opposite)) / 36 of a face's middle.
        let face = Vec3::new(0.0, 0.0, (16.0 + 4.0 * 4.0 * 0.75 + 4.0 * 5.0 / 9.0) as f32 / 36.0);
        assert!(nearest(face) < 1e-6, "{levels}: {}", nearest(face));
    }
}

#[test]
fn normals_lead_outwards_and_are_those_of_a_round_thing() {
    let (mesh, faces) = cube();
    let fine = subdivided(&mesh, &faces, smooth(4));
    // A cube's surface is nearly a ball.
    for (position, normal) in fine.positions.iter().zip(&fine.normals) {
        assert!(normal.is_normalized() && normal.dot(position.normalize()) > 0.97, "{position} {normal}");
    }
    assert!(fine.materials.iter().all(|&material| material < 6));
}

#[test]
fn a_cube_of_sharp_edges_is_a_cube_with_its_normals() {
    let (mesh, faces) = cube();
    let fine = subdivided(&mesh, &faces, Subdivision { levels: 3, crease: Some(45.0) });
    for (position, normal) in fine.positions.iter().zip(&fine.normals) {
        assert_eq!(position.abs().max_element(), 1.0, "{position}");
        assert_eq!(normal.abs().max_element(), 1.0, "{normal}");
        assert!(position.dot(*normal) > 0.999, "{position} {normal}");
    }
    let area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|vertex| fine.positions[vertex as usize]);
        0.5 * (b - a).cross(c - a).length()
    };
    assert!((fine.triangles.iter().map(area).sum::<f32>() - 24.0).abs() < 1e-4);
    // An angle that none of its edges has is none.
    let round = subdivided(&mesh, &faces, Subdivision { levels: 3, crease: Some(91.0) });
    assert_eq!(round, subdivided(&mesh, &faces, smooth(3)));
}

#[test]
fn a_flat_grid_stays_flat_keeps_its_outline_and_its_coordinates_lie_where_they_did() {
    let (mesh, faces) = grid(3);
    let fine = subdivided(&mesh, &faces, smooth(3));
    assert!(fine.positions.iter().all(|at| at.z == 0.0));
    assert!(fine.normals.iter().all(|&normal| normal == Vec3::Z));
    let bounds = fine.bounds();
    assert!(bounds[0].abs_diff_eq(Vec3::ZERO, 1e-6) && bounds[1].abs_diff_eq(Vec3::new(3.0, 3.0, 0.0), 1e-6));
    // In the middle face, far from the outline.
    let inner = fine
        .positions
        .iter()
        .zip(&fine.coordinates[0])
        .filter(|(at, _)| (at.truncate() - 1.5).abs().max_element() < 0.2);
    let mut count = 0;
    for (at, coordinates) in inner {
        assert!(at.truncate().abs_diff_eq(*coordinates, 0.02), "{at} {coordinates}");
        count += 1;
    }
    assert!(count > 4);
}

/// Whatever the order of its faces, the same surface: sums are of few terms, so that they differ in their last bits at most.
#[test]
fn faces_in_another_order_are_the_same_surface() {
    let (mesh, faces) = cube();
    let mut other = mesh.clone();
    other.triangles.rotate_left(4);
    other.materials.rotate_left(4);
    let sorted = |mesh: &Mesh| {
        let mut all: Vec<[i64; 3]> =
            mesh.positions.iter().map(|at| at.to_array().map(|c| (f64::from(c) * 1e5).round() as i64)).collect();
        all.sort_unstable();
        all
    };
    assert_eq!(sorted(&subdivided(&mesh, &faces, smooth(2))), sorted(&subdivided(&other, &faces, smooth(2))));
}

#[test]
fn edges_of_three_faces_points_and_folds_are_no_trouble() {
    // Three triangles at one edge; one that is a line; one that is a point; and a vertex where two others touch.
    let mesh = Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, -Vec3::Y, Vec3::splat(5.0), Vec3::splat(6.0)],
        triangles: vec![[0, 1, 2], [0, 1, 3], [1, 0, 4], [0, 1, 0], [5, 5, 5], [5, 6, 1]],
        materials: vec![0; 6],
        ..Mesh::default()
    };
    for crease in [None, Some(30.0)] {
        let fine = subdivided(&mesh, &[], Subdivision { levels: 3, crease });
        assert!(fine.positions.iter().all(|at| at.is_finite()));
        assert_eq!(fine.triangles.len(), size(&mesh, &[], 3).0);
    }
}
