//! Where things are while the shutter is open (thesis 3.4.7).

use std::ops::Range;

use glam::{Vec3, Vec4};

use super::{Camera, Instance, Light, Mesh, Primitives, Scene, SharedMesh};
use crate::device_scene::unfit_objects;
use crate::error::{Error, Result};

/// What moves of a scene while the shutter is open. The scene itself is as it opens.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// The scene at the ends of even steps of that time, the last as the shutter closes. Between two, everything goes straight.
    pub poses: Vec<Pose>,
    /// Those of the scene's cameras that move, as the shutter opens.
    pub cameras: Vec<Camera>,
    /// Those of the scene's lights that move, by their places in [`Scene::lights`], which rise.
    pub lights: Vec<u32>,
    /// The share of that time for which each row of a picture is exposed, from the top to the bottom: 1 for all rows at once.
    pub exposure: f32,
}

/// A scene at a moment.
#[derive(Debug, Clone, PartialEq)]
pub struct Pose {
    /// [`Scene::instances`], each of the same mesh.
    pub instances: Vec<Instance>,
    /// Meshes that have another shape, by their place in [`Scene::shared`]; the same ones in each pose, in their order.
    pub shapes: Vec<(u32, Shape)>,
    /// [`Motion::cameras`], where they are then and where they look.
    pub cameras: Vec<Camera>,
    /// Those of [`Motion::lights`], where they are then and where they shine.
    pub lights: Vec<Light>,
}

/// What changes of a mesh, by vertex.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// In units of the mesh.
    pub positions: Vec<Vec3>,
    /// None of a mesh without.
    pub normals: Vec<Vec3>,
    /// Likewise.
    pub tangents: Vec<Vec4>,
}

impl Motion {
    /// The most steps.
    pub const MOST_STEPS: usize = 64;

    /// Shared meshes that change their shape.
    pub fn bent(&self) -> impl Iterator<Item = usize> + '_ {
        self.poses.first().into_iter().flat_map(|pose| pose.shapes.iter().map(|&(mesh, _)| mesh as usize))
    }

    /// Does a shared mesh change its shape?
    pub fn is_bent(&self, mesh: u32) -> bool {
        self.poses.first().is_some_and(|pose| pose.shapes.binary_search_by_key(&mesh, |&(bent, _)| bent).is_ok())
    }

    /// Is a copy, by its number in [`Scene::instances`], elsewhere at some pose, or of a mesh that changes its shape?
    pub fn moves(&self, number: usize, copy: &Instance) -> bool {
        self.is_bent(copy.mesh) || self.poses.iter().any(|pose| pose.instances[number] != *copy)
    }
}

/// What a scene over some time has become, and what of it stands still though it should not.
#[derive(Debug)]
pub struct Moved {
    /// The scene as the shutter opens, with its motion if anything moves.
    pub scene: Scene,
    /// Names of objects that are no triangles, or that no copy could be of: they stand where they are as it opens.
    pub left: Vec<String>,
}

impl Scene {
    /// This scene with what others say of it at the ends of even steps of the time in which the shutter is open. They have its
    /// meshes, objects and cameras. What moves is held as an instance of a mesh, so that everything else is as it was.
    ///
    /// # Errors
    /// They are other scenes, or more than [`Motion::MOST_STEPS`].
    pub fn over(self, later: &[Scene], exposure: f32) -> Result<Moved> {
        if later.len() > Motion::MOST_STEPS {
            let most = Motion::MOST_STEPS;
            return Err(Error::new(format!("the shutter's time has {} steps; {most} are the most", later.len())));
        }
        if let Some(what) = later.iter().find_map(|other| self.differs(other)) {
            return Err(Error::new(format!("while the shutter is open the scene gets other {what}; close it earlier")));
        }
        let unfit = unfit_objects(&self);
        let moves = self.moving(later);
        let is_left = |object: usize| {
            let of = &self.objects[object];
            moves[object] && (unfit[object] || !of.primitives.can_move())
        };
        let left: Vec<String> =
            (0..self.objects.len()).filter(|&n| is_left(n)).map(|n| self.objects[n].name.clone()).collect();
        let moving: Vec<bool> = (0..self.objects.len()).map(|n| moves[n] && !is_left(n)).collect();
        let pans = |&camera: &usize| later.iter().any(|other| !other.cameras[camera].stands_as(&self.cameras[camera]));
        let panned: Vec<usize> = (0..self.cameras.len()).filter(pans).collect();
        let lit = |&light: &usize| later.iter().any(|other| !other.lights[light].stands_as(&self.lights[light]));
        let lit: Vec<usize> = (0..self.lights.len()).filter(lit).collect();
        let lights = |of: &Scene| lit.iter().map(|&light| of.lights[light].clone()).collect::<Vec<_>>();
        let cameras = |of: &Scene| panned.iter().map(|&camera| of.cameras[camera].clone()).collect::<Vec<_>>();
        if !moving.contains(&true) && panned.is_empty() && lit.is_empty() {
            return Ok(Moved { scene: self, left });
        }
        let scene = self.taken_apart(&moving);
        let later: Vec<Scene> = later.iter().map(|other| other.taken_apart(&moving)).collect();
        let bent = |mesh: &usize| later.iter().any(|other| scene.shape(*mesh) != other.shape(*mesh));
        let bent: Vec<usize> = (0..scene.shared.len()).filter(bent).collect();
        let pose = |other: &Scene| Pose {
            instances: scene.stood(&other.instances, &moving),
            shapes: bent.iter().map(|&mesh| (mesh as u32, other.shape(mesh))).collect(),
            cameras: cameras(other),
            lights: lights(other),
        };
        let motion = Motion {
            poses: later.iter().map(pose).collect(),
            cameras: cameras(&scene),
            lights: lit.iter().map(|&light| light as u32).collect(),
            exposure,
        };
        Ok(Moved { scene: Scene { motion: Some(motion), ..scene }, left })
    }

    /// Which of its objects stand elsewhere in other scenes, or have another shape there.
    pub(crate) fn moving(&self, later: &[Scene]) -> Vec<bool> {
        (0..self.objects.len()).map(|object| later.iter().any(|other| self.moves(other, object))).collect()
    }

    /// The scene at a pose of its own.
    pub(crate) fn at(&self, pose: &Pose) -> Scene {
        let mut mesh = self.mesh.clone();
        for (number, Shape { positions, normals, tangents }) in &pose.shapes {
            let Range { start, end } = self.shared[*number as usize].vertices;
            mesh.positions[start..end].copy_from_slice(positions);
            if !mesh.normals.is_empty() {
                mesh.normals[start..end].copy_from_slice(normals);
            }
            if !mesh.tangents.is_empty() {
                mesh.tangents[start..end].copy_from_slice(tangents);
            }
        }
        Scene { mesh, instances: pose.instances.clone(), motion: None, hierarchy: None, ..self.clone() }
    }

    /// What another scene has otherwise, if it is not this one at another moment.
    fn differs(&self, other: &Scene) -> Option<&'static str> {
        let meshes = |scene: &Scene| scene.instances.iter().map(|copy| copy.mesh).collect::<Vec<_>>();
        let objects = |scene: &Scene| scene.objects.iter().map(|of| of.primitives.clone()).collect::<Vec<_>>();
        let (a, b) = (&self.mesh, &other.mesh);
        let has_same_lists = a.positions.len() == b.positions.len()
            && a.normals.len() == b.normals.len()
            && a.tangents.len() == b.tangents.len();
        let all = [
            ("triangles", a.triangles == b.triangles && a.materials == b.materials && self.shared == other.shared),
            ("vertices", has_same_lists),
            ("copies of meshes", meshes(self) == meshes(other)),
            ("objects", objects(self) == objects(other)),
            ("cameras", self.cameras.len() == other.cameras.len()),
            ("lights", self.lights.len() == other.lights.len()),
        ];
        all.into_iter().find(|(_, is_same)| !is_same).map(|(what, _)| what)
    }

    /// Does an object stand elsewhere in another scene, or has it another shape?
    fn moves(&self, other: &Scene, object: usize) -> bool {
        match &self.objects[object].primitives {
            Primitives::Triangles(range) => {
                let corners = self.mesh.triangles[range.clone()].as_flattened();
                corners.iter().any(|&v| self.mesh.positions[v as usize] != other.mesh.positions[v as usize])
            }
            Primitives::Instances(range) => {
                let (own, others) = (&self.instances[range.clone()], &other.instances[range.clone()]);
                let is_bent = |copy: &Instance| self.shape(copy.mesh as usize) != other.shape(copy.mesh as usize);
                own != others || own.iter().any(is_bent)
            }
            Primitives::Spheres(range) => self.spheres[range.clone()] != other.spheres[range.clone()],
            Primitives::Disks(range) => self.disks[range.clone()] != other.disks[range.clone()],
        }
    }

    /// A shared mesh at this moment.
    fn shape(&self, mesh: usize) -> Shape {
        let range = &self.shared[mesh].vertices;
        let Mesh { positions, normals, tangents, .. } = &self.mesh;
        Shape {
            positions: positions[range.clone()].to_vec(),
            normals: normals.get(range.clone()).unwrap_or_default().to_vec(),
            tangents: tangents.get(range.clone()).unwrap_or_default().to_vec(),
        }
    }

    /// Copies at another moment, but for those of objects that stand still.
    fn stood(&self, others: &[Instance], moving: &[bool]) -> Vec<Instance> {
        let mut stood = self.instances.clone();
        for (object, _) in self.objects.iter().zip(moving).filter(|(_, moves)| **moves) {
            if let Primitives::Instances(range) = &object.primitives {
                stood[range.clone()].copy_from_slice(&others[range.clone()]);
            }
        }
        stood
    }

    /// The same scene with those objects that move as instances of meshes: each with triangles of its own is a mesh that is shared by
    /// nobody, where it is.
    fn taken_apart(&self, moving: &[bool]) -> Scene {
        let mut own = Mesh::default();
        let mut apart: Vec<Mesh> = Vec::new();
        let mut instances = self.instances.clone();
        let mut objects = self.objects.clone();
        let own_part = self.mesh.part(0..self.own_vertices(), 0..self.own_triangles());
        // Triangles of no object stay where they are, too.
        let mut is_apart = vec![false; self.own_triangles()];
        for (object, _) in objects.iter_mut().zip(moving).filter(|(_, moves)| **moves) {
            if let Primitives::Triangles(range) = &object.primitives {
                is_apart[range.clone()].fill(true);
                let number = self.shared.len() + apart.len();
                apart.push(own_part.picked(range.clone()));
                object.primitives = Primitives::Instances(instances.len()..instances.len() + 1);
                instances.push(Instance {
                    mesh: number as u32,
                    rows: [Vec3::X, Vec3::Y, Vec3::Z],
                    translation: Vec3::ZERO,
                });
            }
        }
        if apart.is_empty() {
            return self.clone();
        }
        let still: Vec<usize> = (0..is_apart.len()).filter(|&triangle| !is_apart[triangle]).collect();
        for object in &mut objects {
            if let Primitives::Triangles(range) = &mut object.primitives {
                let place = |triangle: usize| still.partition_point(|&own| own < triangle);
                *range = place(range.start)..place(range.end);
            }
        }
        own.append(&own_part.kept(&still), 0);
        let mut shared = Vec::with_capacity(self.shared.len() + apart.len());
        let before = self.shared.iter().map(|of| self.mesh.part(of.vertices.clone(), of.triangles.clone()));
        for mesh in before.chain(apart) {
            let (vertex, triangle) = (own.positions.len(), own.triangles.len());
            own.append(&mesh, vertex);
            shared.push(SharedMesh { vertices: vertex..own.positions.len(), triangles: triangle..own.triangles.len() });
        }
        Scene { mesh: own, shared, instances, objects, hierarchy: None, ..self.clone() }
    }
}

impl Primitives {
    /// Can they be a mesh that moves?
    fn can_move(&self) -> bool {
        matches!(self, Primitives::Triangles(_) | Primitives::Instances(_))
    }
}
