//! Meshes whose neighbours share their vertices.

use std::f64::consts::{PI, TAU};

use eyerays::job::Job;
use eyerays::scene::Scene;
use eyerays_bvh::Quality;
use eyerays_shader::data::Primitive;
use glam::{DVec3, Vec3};

use crate::model::{add, empty, matt};

/// Vertices, and three of their numbers a triangle.
#[derive(Debug, Clone, Default)]
pub struct Surface {
    /// World units, rounded last of all.
    pub positions: Vec<Vec3>,
    /// Counter-clockwise from outside or above.
    pub triangles: Vec<[u32; 3]>,
}

impl Surface {
    /// A sphere of `rings` parts from pole to pole and twice as many around: 4 * rings * (rings - 1) triangles.
    pub fn sphere(centre: DVec3, radius: f64, rings: u32) -> Self {
        let around = 2 * rings;
        let place = |ring: u32, part: u32| {
            let (theta, phi) = (PI * f64::from(ring) / f64::from(rings), TAU * f64::from(part) / f64::from(around));
            let (high, wide) = (theta.cos(), theta.sin());
            (centre + radius * DVec3::new(wide * phi.cos(), high, wide * phi.sin())).as_vec3()
        };
        let mut positions = vec![place(0, 0), place(rings, 0)];
        for ring in 1..rings {
            positions.extend((0..around).map(|part| place(ring, part)));
        }
        let number = |ring: u32, part: u32| match ring {
            0 => 0,
            _ if ring == rings => 1,
            _ => 2 + (ring - 1) * around + part % around,
        };
        let mut triangles = Vec::new();
        for (ring, part) in (0..rings).flat_map(|ring| (0..around).map(move |part| (ring, part))) {
            let [a, b] = [number(ring, part), number(ring, part + 1)];
            let [c, d] = [number(ring + 1, part), number(ring + 1, part + 1)];
            if ring > 0 {
                triangles.push([a, b, d]);
            }
            if ring + 1 < rings {
                triangles.push([a, d, c]);
            }
        }
        Surface { positions, triangles }
    }

    /// A square of this edge that faces up, of `cells` x `cells` cells.
    pub fn plane(centre: DVec3, edge: f64, cells: u32) -> Self {
        let place = |i: u32| edge * (f64::from(i) / f64::from(cells) - 0.5);
        let rows = (0..=cells).flat_map(|z| (0..=cells).map(move |x| (x, z)));
        let positions = rows.map(|(x, z)| (centre + DVec3::new(place(x), 0.0, place(z))).as_vec3()).collect();
        let number = |x: u32, z: u32| z * (cells + 1) + x;
        let halves = |(x, z): (u32, u32)| {
            let [a, b, c, d] = [number(x, z), number(x, z + 1), number(x + 1, z + 1), number(x + 1, z)];
            [[a, b, c], [a, c, d]]
        };
        let triangles = (0..cells).flat_map(|z| (0..cells).map(move |x| (x, z))).flat_map(halves).collect();
        Surface { positions, triangles }
    }

    /// Two cones on one rim: closed fans of `spokes` around a hub above and one below.
    pub fn bipyramid(centre: DVec3, radius: f64, height: f64, spokes: u32) -> Self {
        let rim = |k: u32| {
            let angle = TAU * f64::from(k) / f64::from(spokes);
            centre + radius * DVec3::new(angle.cos(), 0.0, angle.sin())
        };
        let hubs = [centre + DVec3::Y * height, centre - DVec3::Y * height];
        let positions = hubs.into_iter().chain((0..spokes).map(rim)).map(|p| p.as_vec3()).collect();
        let spoke = |k: u32| {
            let (a, b) = (2 + k, 2 + (k + 1) % spokes);
            [[0, b, a], [1, a, b]]
        };
        Surface { positions, triangles: (0..spokes).flat_map(spoke).collect() }
    }

    /// A matt scene of it.
    pub fn scene(&self) -> Scene {
        let mut scene = empty();
        add(&mut scene, matt(Vec3::ONE), &self.positions, &self.triangles);
        scene
    }

    /// The scene packed.
    ///
    /// # Panics
    /// If no device could hold it.
    pub fn pack(&self) -> Job {
        let scene = self.scene();
        Job::with_wide_nodes(&scene, scene.settings, Quality::Medium).unwrap_or_else(|e| panic!("{e}"))
    }

    /// The scene packed, with a place in world units that it reaches to: a triangle without extent, the last, which no ray
    /// meets.
    ///
    /// # Panics
    /// If no device could hold it.
    pub fn pack_up_to(&self, end: Vec3) -> Job {
        let mut scene = self.scene();
        add(&mut scene, matt(Vec3::ONE), &[end], &[[0, 0, 0]]);
        Job::with_wide_nodes(&scene, scene.settings, Quality::Medium).unwrap_or_else(|e| panic!("{e}"))
    }
}

/// The triangles of a packed scene, each once and in the scene's order, which no hierarchy changes.
pub fn triangles(packed: &Job) -> Vec<Primitive> {
    let mut triangles = packed.primitives().to_vec();
    triangles.sort_by_key(Primitive::number);
    triangles.dedup_by_key(|triangle| triangle.number());
    triangles
}
