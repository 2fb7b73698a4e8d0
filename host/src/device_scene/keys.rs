//! What moves while the shutter is open, as kernels know it: keys of copies of meshes and of cameras, and the triangles of meshes in
//! each of their shapes.

use std::ops::Range;

use eyerays_shader::data::{BOX_PADDING, Instance as Record, Launch, Light as LightRecord, Normals, Primitive, pack};
use glam::{DMat3, DQuat, DVec3, UVec4, Vec3};
use rayon::prelude::*;

use super::normalisation::{Normalisation, flushed};
use super::{records, tangents};
use crate::error::{Error, Result};
use crate::scene::{Camera, Light, Scene};

/// The slots of a mesh in one of its later shapes.
struct Bend {
    /// Those of its first.
    slots: Range<usize>,
    /// The first of its own.
    own: usize,
    /// The number of the pose.
    pose: usize,
}

/// The triangles of meshes in their later shapes: behind those of all others, in slots of their own.
#[derive(Default)]
pub(super) struct Bends(Vec<Bend>);

impl Bends {
    /// Adds the slots of a mesh in its shapes at so many poses. Returns how far the slots of each are behind its first.
    pub fn add(&mut self, slots: Range<usize>, poses: usize, order: &mut Vec<u32>) -> Vec<u32> {
        let add = |pose| {
            let own = order.len();
            order.extend_from_within(slots.clone());
            self.0.push(Bend { slots: slots.clone(), own, pose });
            (own - slots.start) as u32
        };
        (0..poses).map(add).collect()
    }

    /// Gives what lies in these slots its shapes.
    pub fn shape(
        &self,
        (scene, normalisation): (&Scene, &Normalisation),
        order: &[u32],
        (primitives, normals, axes): (&mut [Primitive], &mut [Normals], &mut [Normals]),
    ) {
        if self.0.is_empty() {
            return;
        }
        let poses = scene.motion.iter().flat_map(|motion| motion.poses.iter().enumerate());
        let cubes: Vec<Normalisation> = (0..scene.shared.len()).map(|mesh| super::copies::cube(scene, mesh)).collect();
        for (number, pose) in poses {
            let bends: Vec<&Bend> = self.0.iter().filter(|bend| bend.pose == number).collect();
            let at = scene.at(pose);
            let all = records::primitives(&at, normalisation, &cubes);
            for bend in bends {
                let (order, own) = (&order[bend.slots.clone()], bend.own..bend.own + bend.slots.len());
                primitives[own.clone()].par_iter_mut().zip(order).for_each(|(to, &from)| *to = all[from as usize]);
                if !normals.is_empty() {
                    normals[own.clone()].copy_from_slice(&records::normals(&at, order));
                }
                if !axes.is_empty() {
                    axes[own].copy_from_slice(&tangents::tangents(&at, order));
                }
            }
        }
    }
}

/// Boxes around the triangles of a mesh in all its shapes, in its cube: what its hierarchy is built over.
pub(super) fn boxes(scene: &Scene, mesh: usize, cube: &Normalisation) -> Vec<Primitive> {
    let shared = &scene.shared[mesh];
    let poses = scene.motion.iter().flat_map(|motion| &motion.poses);
    let shapes: Vec<&[Vec3]> = poses
        .flat_map(|pose| &pose.shapes)
        .filter(|(number, _)| *number as usize == mesh)
        .map(|(_, shape)| &shape.positions[..])
        .chain([&scene.mesh.positions[shared.vertices.clone()]])
        .collect();
    // More than vertices are off that kernels find between two shapes, in [-1, 1].
    let room = Vec3::splat(BOX_PADDING * 1.25);
    let most = Vec3::splat(1.0 + BOX_PADDING);
    let around = |(number, corners): (usize, &[u32; 3])| {
        let places =
            shapes.iter().flat_map(|shape| corners.map(|vertex| shape[vertex as usize - shared.vertices.start]));
        let nothing = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        let [least, greatest] = places
            .map(|place| cube.place(place))
            .fold(nothing, |[least, greatest], place| [least.min(place), greatest.max(place)]);
        Primitive::instance((least - room).max(-most), (greatest + room).min(most), number as u32)
    };
    scene.mesh.triangles[shared.triangles.clone()].par_iter().enumerate().map(around).collect()
}

/// How a light without extent moves.
pub(crate) struct Way {
    /// Its place in the scene's lights.
    pub light: usize,
    /// That of its first key among the records of copies.
    pub first: u32,
    /// The least and the greatest corner around all its places.
    pub bounds: [Vec3; 2],
}

impl Way {
    /// Adds the keys of a light to the records.
    ///
    /// # Errors
    /// It is too far away at one of them, or there are too many.
    fn new(light: u32, keys: Option<Vec<Record>>, records: &mut Vec<Record>) -> Result<Way> {
        let most = (u32::MAX >> LightRecord::KEYS) as usize;
        let keys = keys.filter(|keys| records.len() + keys.len() < most).ok_or_else(|| {
            Error::new(format!(
                "light {} goes too far away while the shutter is open: move it nearer to the scene",
                light + 1
            ))
        })?;
        let places = keys.iter().map(|key| key.transform().translation);
        let nothing = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        let bounds = places.fold(nothing, |[least, greatest], place| [least.min(place), greatest.max(place)]);
        let first = records.len() as u32;
        records.extend(keys);
        Ok(Way { light: light as usize, first, bounds })
    }
}

/// What moves of a scene.
pub(crate) struct Movement {
    /// Steps of the shutter's time, 0 if nothing moves.
    pub steps: u32,
    /// For which share of it each row is exposed.
    pub exposure: f32,
    /// Do copies of meshes move, or lights?
    things_move: bool,
    /// Lights that move.
    pub ways: Vec<Way>,
    /// Cameras that move, each with the place of its first key among the records of copies.
    cameras: Vec<(Camera, u32)>,
}

impl Movement {
    /// Nothing does.
    const STILL: Movement =
        Movement { steps: 0, exposure: 1.0, things_move: false, ways: Vec::new(), cameras: Vec::new() };

    /// Adds the keys of cameras and lights to the records.
    ///
    /// # Errors
    /// One is too far away.
    pub(super) fn new(scene: &Scene, normalisation: &Normalisation, records: &mut Vec<Record>) -> Result<Movement> {
        let Some(motion) = &scene.motion else { return Ok(Movement::STILL) };
        let mut movement = Movement {
            steps: motion.poses.len() as u32,
            exposure: motion.exposure,
            things_move: !motion.lights.is_empty() || records.iter().any(Record::moves),
            ways: Vec::new(),
            cameras: Vec::new(),
        };
        for (number, camera) in motion.cameras.iter().enumerate() {
            let later = motion.poses.iter().map(|pose| &pose.cameras[number]);
            movement.cameras.push((camera.clone(), records.len() as u32));
            for other in [camera].into_iter().chain(later) {
                records.push(key(camera, other, normalisation)?);
            }
        }
        for (number, &light) in motion.lights.iter().enumerate() {
            let first = &scene.lights[light as usize];
            let later = motion.poses.iter().map(|pose| &pose.lights[number]);
            let keys = [first].into_iter().chain(later).map(|other| light_key(first, other, normalisation));
            movement.ways.push(Way::new(light, keys.collect(), records)?);
        }
        Ok(movement)
    }

    /// Bits of the constant of kernels.
    pub fn bits(&self) -> u32 {
        let moving = if self.things_move { Launch::MOVING } else { 0 };
        moving | if self.cameras.is_empty() { 0 } else { Launch::PANNED }
    }

    /// The first key of a camera, if it is one of the scene that moves.
    pub fn keys(&self, camera: &Camera) -> Option<u32> {
        let is = |(own, _): &&(Camera, u32)| own.name == camera.name && own.stands_as(camera);
        self.cameras.iter().find(is).map(|&(_, first)| first)
    }
}

/// How a light is turned against its first key, by the least turn, and where it is.
fn light_key(first: &Light, light: &Light, normalisation: &Normalisation) -> Option<Record> {
    let ((_, from), (place, to)) = (first.stance(), light.stance());
    let turn = from.zip(to).map_or(DQuat::IDENTITY, |(from, to)| DQuat::from_rotation_arc(from, to));
    let rows = DMat3::from_quat(turn).transpose();
    Some(turned([rows.x_axis, rows.y_axis, rows.z_axis], normalisation.place_anywhere(place)?))
}

/// The record of what is turned by a matrix of these rows, at a place.
fn turned(rows: [DVec3; 3], place: Vec3) -> Record {
    let record = |axis: usize| pack(flushed(rows[axis].as_vec3()), place[axis].to_bits());
    Record { x: record(0), y: record(1), z: record(2), mesh: UVec4::ZERO }
}

/// How a camera is turned against its first key, and where it is.
fn key(first: &Camera, camera: &Camera, normalisation: &Normalisation) -> Result<Record> {
    let eye = normalisation.place_anywhere(camera.eye).ok_or_else(|| {
        let name = &camera.name;
        Error::new(format!("camera {name:?} goes too far away while the shutter is open: move it nearer to the scene"))
    })?;
    let (from, to) = (first.axes(), camera.axes());
    let row = |axis: usize| from.iter().zip(&to).map(|(from, to)| *from * to[axis]).sum::<DVec3>();
    Ok(turned([0, 1, 2].map(row), eye))
}
