//! Meshes that stand in several places.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use eyerays_shader::geometry::Transform;
use glam::{Vec3, Vec4};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{Material, Mesh, Object, Primitives, Scene};
use crate::device_scene::{flushed, made_tangents};

/// A part of [`Scene::mesh`] that stands nowhere by itself, but wherever an [`Instance`] puts it. Its vertices are in units of its own.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SharedMesh {
    /// Its vertices, which no other triangles have.
    pub vertices: Range<usize>,
    /// Its triangles, which have no other vertices. They are wound as they are to be seen where it stands: a mesh for mirrors is one
    /// of its own, whose triangles are turned around and whose tangents have the other sign.
    pub triangles: Range<usize>,
}

/// A copy of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Instance {
    /// An index into [`Scene::shared`].
    pub mesh: u32,
    /// From the mesh's units to the world's: what each axis is a sum of.
    pub rows: [Vec3; 3],
    /// What is added then.
    pub translation: Vec3,
}

impl Instance {
    /// Where its vertices go.
    pub fn transform(&self) -> Transform {
        Transform::new(self.rows, self.translation)
    }
}

impl Scene {
    /// Triangles at the start of [`Scene::mesh`] that stand where they are.
    pub fn own_triangles(&self) -> usize {
        self.shared.first().map_or(self.mesh.triangles.len(), |first| first.triangles.start)
    }

    /// Vertices at the start of [`Scene::mesh`] that are of those triangles.
    pub fn own_vertices(&self) -> usize {
        self.shared.first().map_or(self.mesh.positions.len(), |first| first.vertices.start)
    }

    /// Triangles of all copies.
    pub fn copied_triangles(&self) -> u64 {
        self.triangles_of(&self.instances)
    }

    /// Triangles of some copies.
    pub fn triangles_of(&self, copies: &[Instance]) -> u64 {
        copies.iter().map(|copy| self.shared[copy.mesh as usize].triangles.len() as u64).sum()
    }

    /// The first triangle's number of each copy among all primitives, and the number after the last: copies follow the triangles that
    /// stand where they are.
    pub(crate) fn first_numbers(&self) -> Vec<u64> {
        let mut next = self.own_triangles() as u64;
        let mut firsts = Vec::with_capacity(self.instances.len() + 1);
        for instance in &self.instances {
            firsts.push(next);
            next += self.triangles_of(std::slice::from_ref(instance));
        }
        firsts.push(next);
        firsts
    }

    /// The same scene without instances: each copy is moved to where it stands, by the operations of kernels, so that pictures of both
    /// have the same bits. Which object is made of what stays.
    pub fn flattened(&self) -> Scene {
        Scene { shared: Vec::new(), ..self.flattened_where(&vec![true; self.objects.len()]) }
    }

    /// The same with those objects flattened that `is` says.
    pub(crate) fn flattened_where(&self, is: &[bool]) -> Scene {
        let has_axes = self.materials.iter().any(Material::has_axes);
        let meshes: Vec<Mesh> = self.shared.par_iter().map(|shared| self.alone(shared, has_axes)).collect();
        let mut own = self.mesh.part(0..self.own_vertices(), 0..self.own_triangles());
        let mut instances = Vec::new();
        let mut put = |range: &Range<usize>, is_flat: bool| {
            let copies = &self.instances[range.clone()];
            let first = if is_flat { own.triangles.len() } else { instances.len() };
            if !is_flat {
                instances.extend_from_slice(copies);
                return Primitives::Instances(first..instances.len());
            }
            copies.iter().for_each(|copy| own.append_moved(&meshes[copy.mesh as usize], &copy.transform()));
            Primitives::Triangles(first..own.triangles.len())
        };
        let objects = self.objects.iter().zip(is).map(|(object, &is_flat)| {
            let primitives = match &object.primitives {
                Primitives::Instances(range) => put(range, is_flat),
                other => other.clone(),
            };
            Object { primitives, ..object.clone() }
        });
        let objects = objects.collect();
        let shared = self.keep(&mut own, &mut instances);
        Scene { mesh: own, objects, shared, instances, hierarchy: None, ..self.clone() }
    }

    /// Adds those shared meshes to another mesh that some instances are copies of, which get their new numbers.
    fn keep(&self, own: &mut Mesh, instances: &mut [Instance]) -> Vec<SharedMesh> {
        let mut numbers = vec![None; self.shared.len()];
        let mut shared = Vec::new();
        for instance in instances {
            let SharedMesh { vertices, triangles } = &self.shared[instance.mesh as usize];
            instance.mesh = *numbers[instance.mesh as usize].get_or_insert_with(|| {
                let (vertex, triangle) = (own.positions.len(), own.triangles.len());
                own.append(&self.mesh.part(vertices.clone(), triangles.clone()), vertex);
                let (vertices, triangles) = (vertex..own.positions.len(), triangle..own.triangles.len());
                shared.push(SharedMesh { vertices, triangles });
                shared.len() as u32 - 1
            });
        }
        shared
    }

    /// A shared mesh by itself. Where its materials ask for tangents that it has not, each corner is a vertex with those that are made:
    /// they are of the mesh, not of where it stands.
    fn alone(&self, SharedMesh { vertices, triangles }: &SharedMesh, has_axes: bool) -> Mesh {
        let mut mesh = self.mesh.part(vertices.clone(), triangles.clone());
        if has_axes {
            let made = made_tangents(&mesh, &self.materials);
            for (triangle, tangents) in made {
                let corners = mesh.triangles[triangle];
                mesh.triangles[triangle] = [0, 1, 2].map(|corner| mesh.repeat(corners[corner], tangents[corner]));
            }
        }
        mesh
    }
}

impl Mesh {
    /// Some of its vertices and the triangles of these.
    pub(super) fn part(&self, vertices: Range<usize>, triangles: Range<usize>) -> Mesh {
        fn part<T: Clone>(all: &[T], range: &Range<usize>) -> Vec<T> {
            all.get(range.clone()).unwrap_or_default().to_vec()
        }
        let first = vertices.start as u32;
        let moved = |corners: &[u32; 3]| corners.map(|vertex| vertex - first);
        Mesh {
            positions: part(&self.positions, &vertices),
            normals: part(&self.normals, &vertices),
            triangles: self.triangles[triangles.clone()].iter().map(moved).collect(),
            materials: part(&self.materials, &triangles),
            coordinates: self.coordinates.each_ref().map(|coordinates| part(coordinates, &vertices)),
            tangents: part(&self.tangents, &vertices),
            colours: part(&self.colours, &vertices),
        }
    }

    /// Some of its triangles with their own vertices.
    pub(super) fn picked(&self, triangles: Range<usize>) -> Mesh {
        fn picked<T: Copy>(all: &[T], vertices: &[usize]) -> Vec<T> {
            vertices.iter().filter_map(|&vertex| all.get(vertex).copied()).collect()
        }
        let mut numbers = vec![u32::MAX; self.positions.len()];
        let mut vertices = Vec::new();
        let mut number = |vertex: u32| {
            let own = &mut numbers[vertex as usize];
            if *own == u32::MAX {
                *own = vertices.len() as u32;
                vertices.push(vertex as usize);
            }
            *own
        };
        let corners = self.triangles[triangles.clone()].iter().map(|corners| corners.map(&mut number)).collect();
        Mesh {
            positions: picked(&self.positions, &vertices),
            normals: picked(&self.normals, &vertices),
            triangles: corners,
            materials: self.materials[triangles].to_vec(),
            coordinates: self.coordinates.each_ref().map(|coordinates| picked(coordinates, &vertices)),
            tangents: picked(&self.tangents, &vertices),
            colours: picked(&self.colours, &vertices),
        }
    }

    /// All of its vertices and some of its triangles.
    pub(super) fn kept(&self, triangles: &[usize]) -> Mesh {
        let corners = triangles.iter().map(|&triangle| self.triangles[triangle]).collect();
        let materials = triangles.iter().map(|&triangle| self.materials[triangle]).collect();
        Mesh { triangles: corners, materials, ..self.clone() }
    }

    /// Repeats a vertex with another tangent, and returns its number.
    fn repeat(&mut self, vertex: u32, tangent: Vec4) -> u32 {
        fn repeat<T: Copy>(all: &mut Vec<T>, vertex: usize) {
            if let Some(&own) = all.get(vertex) {
                all.push(own);
            }
        }
        let (number, vertex) = (self.positions.len(), vertex as usize);
        self.tangents.resize(number, Vec4::ZERO);
        self.tangents.push(tangent);
        repeat(&mut self.positions, vertex);
        repeat(&mut self.normals, vertex);
        repeat(&mut self.coordinates[0], vertex);
        repeat(&mut self.coordinates[1], vertex);
        repeat(&mut self.colours, vertex);
        number as u32
    }

    /// Adds another mesh, moved.
    pub(crate) fn append_moved(&mut self, other: &Mesh, transform: &Transform) {
        let first = self.positions.len();
        self.append(other, first);
        self.move_from(first, transform);
    }

    /// Moves it as kernels do. A mirror turns the triangles around, so that their fronts stay outside.
    pub(crate) fn moved(&mut self, transform: &Transform) {
        self.move_from(0, transform);
        if transform.side < 0.0 {
            self.turn();
        }
    }

    /// Makes the outside of what is mirrored the outside again.
    pub(crate) fn turn(&mut self) {
        self.triangles.iter_mut().for_each(|[_, b, c]| std::mem::swap(b, c));
        self.tangents.iter_mut().for_each(|tangent| tangent.w = -tangent.w);
    }

    fn move_from(&mut self, first: usize, transform: &Transform) {
        self.positions[first..].par_iter_mut().for_each(|place| *place = transform.place(*place));
        if let Some(normals) = self.normals.get_mut(first..) {
            normals.par_iter_mut().for_each(|normal| *normal = transform.normal(flushed(*normal)));
        }
        if let Some(tangents) = self.tangents.get_mut(first..) {
            let turned = |t: &mut Vec4| *t = transform.direction(flushed(t.truncate())).extend(t.w);
            tangents.par_iter_mut().for_each(turned);
        }
    }

    /// Adds another mesh behind `first` vertices. Parts of one scene's mesh have the same lists, but for tangents.
    pub(super) fn append(&mut self, other: &Mesh, first: usize) {
        self.positions.extend(&other.positions);
        self.normals.extend(&other.normals);
        let shift = |corners: &[u32; 3]| corners.map(|vertex| first as u32 + vertex);
        self.triangles.extend(other.triangles.iter().map(shift));
        self.materials.extend(&other.materials);
        for (own, others) in self.coordinates.iter_mut().zip(&other.coordinates) {
            own.extend(others);
        }
        self.colours.extend(&other.colours);
        if !self.tangents.is_empty() || !other.tangents.is_empty() {
            self.tangents.resize(first, Vec4::ZERO);
            self.tangents.extend(&other.tangents);
            self.tangents.resize(self.positions.len(), Vec4::ZERO);
        }
    }
}
