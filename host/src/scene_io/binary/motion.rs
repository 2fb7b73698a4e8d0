//! What moves while the shutter is open: numbers of poses as they are, all else in the description.

use bytemuck::Pod;
use serde::{Deserialize, Serialize};

use super::header::AGAIN;
use crate::scene::hierarchy::records;
use crate::scene::{Camera, Instance, Light, Motion, Pose, Scene, Shape, Unplaced};

/// What the description says of it.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shutter {
    exposure: f32,
    /// Shared meshes that change their shape.
    bent: Vec<u32>,
    cameras: Vec<Camera>,
    lights: Vec<u32>,
    poses: Vec<Seen>,
}

/// Cameras and lights of a pose.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Seen {
    cameras: Vec<Camera>,
    lights: Vec<Light>,
}

fn seen(pose: &Pose) -> Seen {
    Seen { cameras: pose.cameras.clone(), lights: pose.lights.clone() }
}

impl Shutter {
    pub fn of(motion: &Motion) -> Self {
        Shutter {
            exposure: motion.exposure,
            bent: motion.bent().map(|mesh| mesh as u32).collect(),
            cameras: motion.cameras.clone(),
            lights: motion.lights.clone(),
            poses: motion.poses.iter().map(seen).collect(),
        }
    }

    /// The motion of a scene by the bytes of its poses, of which nothing is checked yet.
    ///
    /// # Errors
    /// They are not of such a scene.
    pub fn motion(self, scene: &Scene, bytes: &[u8]) -> Unplaced<Motion> {
        let Shutter { exposure, bent, cameras, lights, poses } = self;
        let mut rest = Some(bytes);
        let mesh = &scene.mesh;
        let pose = |seen: Seen| {
            let instances = taken(&mut rest, scene.instances.len())?;
            let shape = |&number: &u32| {
                let vertices = scene.shared.get(number as usize)?.vertices.len();
                let count = |has_none: bool| if has_none { 0 } else { vertices };
                let shape = Shape {
                    positions: taken(&mut rest, vertices)?,
                    normals: taken(&mut rest, count(mesh.normals.is_empty()))?,
                    tangents: taken(&mut rest, count(mesh.tangents.is_empty()))?,
                };
                Some((number, shape))
            };
            let shapes = bent.iter().map(shape).collect::<Option<_>>()?;
            Some(Pose { instances, shapes, cameras: seen.cameras, lights: seen.lights })
        };
        let poses = poses.into_iter().map(pose).collect::<Option<Vec<_>>>();
        let poses = poses.filter(|_| rest.is_some_and(<[u8]>::is_empty));
        let poses = poses.ok_or_else(|| format!("its motion is not of as many things as its scene has; {AGAIN}"))?;
        Ok(Motion { poses, cameras, lights, exposure })
    }
}

/// So many records from the start of what is left.
fn taken<T: Pod + Send>(rest: &mut Option<&[u8]>, count: usize) -> Option<Vec<T>> {
    let (start, after) = (*rest)?.split_at_checked(count.checked_mul(size_of::<T>())?)?;
    *rest = Some(after);
    Some(records(start))
}

/// The numbers of all poses: copies of meshes, then the positions, normals and tangents of each that bends.
pub fn bytes(motion: Option<&Motion>) -> Vec<u8> {
    let mut all = Vec::new();
    for Pose { instances, shapes, .. } in motion.iter().flat_map(|motion| &motion.poses) {
        all.extend_from_slice(bytemuck::cast_slice::<Instance, u8>(instances));
        for (_, Shape { positions, normals, tangents }) in shapes {
            all.extend_from_slice(bytemuck::cast_slice(positions));
            all.extend_from_slice(bytemuck::cast_slice(normals));
            all.extend_from_slice(bytemuck::cast_slice(tangents));
        }
    }
    all
}
