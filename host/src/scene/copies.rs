//! How far copies of meshes reach, to the bit: a scene is normalised by it.

use std::collections::HashMap;

use eyerays_shader::geometry::Transform;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::{Instance, Object, Scene, SharedMesh, extent};

/// What a copy may reach on an axis, at most, and its number.
struct Reach {
    least: f64,
    greatest: f64,
    instance: usize,
}

/// What a place of a copy is a sum of on an axis.
fn row(instance: &Instance, axis: usize) -> (Vec3, f32) {
    (instance.rows[axis], instance.translation[axis])
}

impl Reach {
    /// That of a copy of a mesh between two corners.
    fn of(instance: usize, (row, added): (Vec3, f32), [low, high]: [DVec3; 2]) -> Self {
        /// More than what the copy's vertices are rounded by.
        const ROUNDING: f64 = 1e-6;
        let (row, added) = (row.as_dvec3(), f64::from(added));
        let (middle, half) = ((low + high) / 2.0, (high - low) / 2.0);
        let room = row.abs().dot(half) + ROUNDING * (row.abs().dot(low.abs().max(high.abs())) + added.abs());
        let at = row.dot(middle) + added;
        Reach { least: at - room, greatest: at + room, instance }
    }
}

/// Copies of a scene's meshes, and the corners of these.
struct Copies<'s> {
    scene: &'s Scene,
    instances: &'s [Instance],
    corners: &'s [[DVec3; 2]],
}

/// Extremes on an axis of copies that were asked: those of rows that are alike, as where all stand upright, once.
struct Asked<'s> {
    copies: &'s Copies<'s>,
    axis: usize,
    rows: HashMap<(u32, [u32; 4]), [f32; 2]>,
    extremes: [f32; 2],
}

impl Asked<'_> {
    fn ask(&mut self, instance: usize) {
        let (scene, instance) = (self.copies.scene, &self.copies.instances[instance]);
        let (mesh, (row, added)) = (instance.mesh, row(instance, self.axis));
        let key = (mesh, [row.x, row.y, row.z, added].map(f32::to_bits));
        let of_mesh = || {
            let only = Transform { x: row, translation: Vec3::splat(added), ..Transform::IDENTITY };
            let places = scene.mesh.positions[scene.shared[mesh as usize].vertices.clone()].par_iter();
            places.map(|&place| only.place(place).x).map(|x| [x, x]).reduce(|| NOTHING, wider)
        };
        self.extremes = wider(self.extremes, *self.rows.entry(key).or_insert_with(of_mesh));
    }
}

const NOTHING: [f32; 2] = [f32::INFINITY, f32::NEG_INFINITY];

fn wider([least, greatest]: [f32; 2], [low, high]: [f32; 2]) -> [f32; 2] {
    [least.min(low), greatest.max(high)]
}

impl Copies<'_> {
    /// Least and greatest corner in the world; none where there is no copy.
    fn bounds(&self) -> Option<[Vec3; 2]> {
        let [x, y, z] = [0, 1, 2].map(|axis| self.extremes(axis));
        let corner = |side: usize| Vec3::new(x[side], y[side], z[side]);
        (x[0] <= x[1]).then(|| [corner(0), corner(1)])
    }

    /// On an axis. Copies that may reach farthest are asked first, until none could reach farther than those.
    fn extremes(&self, axis: usize) -> [f32; 2] {
        let reach = |(number, instance): (usize, &Instance)| {
            Reach::of(number, row(instance, axis), self.corners[instance.mesh as usize])
        };
        let mut reaches: Vec<Reach> = self.instances.par_iter().enumerate().map(reach).collect();
        let mut asked = Asked { copies: self, axis, rows: HashMap::new(), extremes: NOTHING };
        reaches.par_sort_unstable_by(|a, b| a.least.total_cmp(&b.least));
        for reach in &reaches {
            if reach.least > f64::from(asked.extremes[0]) {
                break;
            }
            asked.ask(reach.instance);
        }
        reaches.par_sort_unstable_by(|a, b| b.greatest.total_cmp(&a.greatest));
        for reach in &reaches {
            if reach.greatest < f64::from(asked.extremes[1]) {
                break;
            }
            asked.ask(reach.instance);
        }
        asked.extremes
    }

    /// How far they reach from a place at most.
    fn reach(&self, center: DVec3) -> f64 {
        let farthest = |(number, instance): (usize, &Instance)| {
            let [low, high] = self.corners[instance.mesh as usize];
            let rows = instance.rows.map(Vec3::as_dvec3);
            let moved = |p: DVec3| DVec3::from_array(rows.map(|row| row.dot(p)));
            let middle = moved((low + high) / 2.0) + instance.translation.as_dvec3();
            let half = DVec3::from_array(rows.map(|row| row.abs().dot((high - low) / 2.0)));
            ((middle.distance(center) + half.length()) * (1.0 + 1e-6), number)
        };
        let mut farthest: Vec<(f64, usize)> = self.instances.par_iter().enumerate().map(farthest).collect();
        farthest.par_sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
        let mut most = 0f64;
        for (reach, number) in farthest {
            if reach < most {
                break;
            }
            let instance = &self.instances[number];
            let (transform, shared) = (instance.transform(), &self.scene.shared[instance.mesh as usize]);
            let places = self.scene.mesh.positions[shared.vertices.clone()].par_iter();
            let own = places.map(|&place| transform.place(place).as_dvec3().distance(center)).reduce(|| 0.0, f64::max);
            most = most.max(own);
        }
        most
    }
}

/// Objects of so many copies are measured by all their vertices.
const FEW: usize = 16;

impl Scene {
    /// Least and greatest corner of each shared mesh in its units; none where nothing is copied.
    fn corners(&self) -> Vec<[DVec3; 2]> {
        let corners = |shared: &SharedMesh| {
            extent::of(self.mesh.positions[shared.vertices.clone()].iter().copied()).map(Vec3::as_dvec3)
        };
        if self.instances.is_empty() { Vec::new() } else { self.shared.par_iter().map(corners).collect() }
    }

    /// Corners of boxes around all copies that move, at each pose.
    pub(crate) fn motion_bounds(&self) -> Vec<Vec3> {
        let Some(motion) = &self.motion else { return Vec::new() };
        let mut corners = self.corners();
        for (mesh, shape) in motion.poses.iter().flat_map(|pose| &pose.shapes) {
            let [low, high] = extent::of(shape.positions.iter().copied()).map(Vec3::as_dvec3);
            let [least, greatest] = &mut corners[*mesh as usize];
            (*least, *greatest) = (least.min(low), greatest.max(high));
        }
        let around = |copy: &Instance| {
            let [low, high] = corners[copy.mesh as usize];
            let rows = copy.rows.map(Vec3::as_dvec3);
            let middle = DVec3::from_array(rows.map(|row| row.dot((low + high) / 2.0))) + copy.translation.as_dvec3();
            let half = DVec3::from_array(rows.map(|row| row.abs().dot((high - low) / 2.0)));
            // More than vertices are off that are moved in single precision.
            let half = half + (middle.abs() + half) * 1e-6;
            [(middle - half).as_vec3(), (middle + half).as_vec3()]
        };
        let moves =
            |(own, copy): (&Instance, &Instance)| (own != copy || motion.is_bent(copy.mesh)).then(|| around(copy));
        let of_pose = |pose: &super::Pose| {
            let boxes = self.instances.par_iter().zip(&pose.instances).filter_map(moves);
            boxes.reduce_with(|[a, b], [c, d]| [a.min(c), b.max(d)])
        };
        motion.poses.iter().filter_map(of_pose).flatten().collect()
    }

    /// Least and greatest corner of all copies in the world, as they are when they are flattened; none where there is none.
    pub(crate) fn copies_bounds(&self) -> Option<[Vec3; 2]> {
        Copies { scene: self, instances: &self.instances, corners: &self.corners() }.bounds()
    }

    /// Measures the bounds of objects that are copies.
    pub(crate) fn measure_copies(&mut self) {
        let corners = self.corners();
        let scene = &*self;
        let of = |object: &Object| match object.primitives.instances(&scene.instances) {
            [] => None,
            few if few.len() <= FEW => Some(extent::of(few.iter().flat_map(|copy| scene.places(copy)))),
            instances => Copies { scene, instances, corners: &corners }.bounds(),
        };
        let bounds: Vec<Option<[Vec3; 2]>> = scene.objects.par_iter().map(of).collect();
        for (object, bounds) in self.objects.iter_mut().zip(bounds) {
            object.bounds = bounds.unwrap_or(object.bounds);
        }
    }

    /// The vertices of a copy in the world.
    fn places(&self, copy: &Instance) -> impl Iterator<Item = Vec3> {
        let transform = copy.transform();
        let own = self.mesh.positions[self.shared[copy.mesh as usize].vertices.clone()].iter();
        own.map(move |&place| transform.place(place))
    }

    /// How far all copies reach from a place at most, in the world.
    pub(crate) fn copies_reach(&self, center: DVec3) -> f64 {
        Copies { scene: self, instances: &self.instances, corners: &self.corners() }.reach(center)
    }
}
