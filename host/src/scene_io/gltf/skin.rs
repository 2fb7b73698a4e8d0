//! Skins: meshes that follow joints, which stand as their nodes do.

use std::collections::HashMap;
use std::rc::Rc;

use glam::{DMat4, DVec4};

use super::accessor::{Accessors, Elements};
use super::document::{Document, Primitive, pick};
use super::node::Placed;
use super::vertices::Vertices;
use crate::scene::Unplaced;
use crate::scene_io::budget::Budget;

/// The skins of a scene, each posed once.
pub struct Skins<'d> {
    document: &'d Document,
    /// Nodes of the scene by their numbers; empty where no node has a skin.
    worlds: HashMap<usize, DMat4>,
    posed: HashMap<usize, Rc<Pose>>,
}

/// What takes the vertices of a mesh from where it was bound to where a skin's joints are, in world units; by joint.
pub struct Pose(Vec<DMat4>);

/// Which joints the vertices in use of a primitive follow, and how much.
#[derive(Default)]
pub struct Bond {
    joints: Vec<[u32; 4]>,
    weights: Vec<[f32; 4]>,
}

impl<'d> Skins<'d> {
    /// Those of a document whose scene has these nodes.
    pub fn new(document: &'d Document, nodes: &[Placed]) -> Self {
        let has_skins = nodes.iter().any(|placed| placed.node.skin.is_some());
        let worlds = nodes.iter().filter(|_| has_skins).map(|placed| (placed.number, placed.world)).collect();
        Skins { document, worlds, posed: HashMap::new() }
    }

    /// The pose of a node's skin, if it has one.
    ///
    /// # Errors
    /// There is no such skin or joint, too few matrices for its joints, or no memory for them.
    pub fn pose(&mut self, placed: &Placed, accessors: &Accessors, budget: &Budget) -> Unplaced<Option<Rc<Pose>>> {
        let Some(number) = placed.node.skin else { return Ok(None) };
        if let Some(pose) = self.posed.get(&number) {
            return Ok(Some(pose.clone()));
        }
        let skin = pick(&self.document.skins, number, &format!("nodes[{}].skin", placed.number), "skin")?;
        let owner = format!("skins[{number}]");
        budget
            .check_bytes((skin.joints.len() * size_of::<DMat4>()) as u64)
            .map_err(|why| format!("{owner}.joints: they {why}; use fewer"))?;
        let here = format!("{owner}.inverseBindMatrices");
        let bind = skin.inverse_bind_matrices.map(|number| accessors.open(number, &[16], &here)).transpose()?;
        let wanted = skin.joints.len();
        if let Some(count) = bind.as_ref().map(|bind| bind.count).filter(|&count| count < wanted) {
            return Err(format!("{here}: it has {count} matrices for {wanted} joints; write the file again"));
        }
        let joint = |(place, &node): (usize, &usize)| {
            pick(&self.document.nodes, node, &format!("{owner}.joints[{place}]"), "node")?;
            let world = self.worlds.get(&node).copied().unwrap_or(DMat4::IDENTITY);
            Ok(world * bind.as_ref().map_or(DMat4::IDENTITY, |bind| matrix(bind, place)))
        };
        let pose = Rc::new(Pose(skin.joints.iter().enumerate().map(joint).collect::<Unplaced<_>>()?));
        self.posed.insert(number, pose.clone());
        Ok(Some(pose))
    }
}

impl Pose {
    /// What takes a vertex to the world. Weights are shares of their sum; a vertex without any follows the first joint.
    pub fn world(&self, bond: &Bond, vertex: usize) -> DMat4 {
        let first = || self.0.first().copied().unwrap_or(DMat4::IDENTITY);
        let (Some(joints), Some(weights)) = (bond.joints.get(vertex), bond.weights.get(vertex)) else { return first() };
        let weights = weights.map(|weight| if weight > 0.0 && weight.is_finite() { f64::from(weight) } else { 0.0 });
        let sum: f64 = weights.iter().sum();
        if sum == 0.0 {
            return first();
        }
        let parts = joints.iter().zip(weights).filter(|(_, weight)| *weight > 0.0);
        let parts = parts.map(|(&joint, weight)| {
            let matrix = self.0.get(joint as usize).copied().unwrap_or(DMat4::IDENTITY);
            matrix * (weight / sum)
        });
        parts.fold(DMat4::ZERO, |all, part| all + part)
    }
}

impl Bond {
    /// That of a primitive's vertices; of none where the file says nothing.
    ///
    /// # Errors
    /// Those of [`Vertices::attribute`].
    pub fn of(of: &Primitive, vertices: &Vertices) -> Unplaced<Bond> {
        let attribute = |key| vertices.attribute(&of.attributes, key, &[4], "attributes");
        let (joints, weights) = (attribute("JOINTS_0")?, attribute("WEIGHTS_0")?);
        let joints = vertices.list(joints, |joints| joints.map(|joint: f32| joint as u32));
        Ok(Bond { joints, weights: vertices.list(weights, |weights| weights) })
    }
}

/// A matrix of a list. Its last row is (0, 0, 0, 1), whatever rounding made of it.
fn matrix(of: &Elements, number: usize) -> DMat4 {
    let numbers: [f32; 16] = of.vector(number);
    let [x, y, z, w] = [0, 4, 8, 12]
        .map(|first| DVec4::new(numbers[first].into(), numbers[first + 1].into(), numbers[first + 2].into(), 0.0));
    DMat4::from_cols(x, y, z, w.with_w(1.0))
}
