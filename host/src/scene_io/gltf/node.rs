//! The tree of nodes, without recursion: a file may nest them a million deep.

use glam::{DMat4, DQuat, DVec3, DVec4};

use super::animation::{Change, Pose};
use super::document::{Document, Node, pick};
use crate::scene::Unplaced;

/// A node in world units.
pub struct Placed<'d> {
    /// Its place in the file's list.
    pub number: usize,
    pub node: &'d Node,
    /// Of its morph targets, if it says so: at this moment.
    pub weights: Option<&'d [f64]>,
    /// From its own units to the world's; may hold what is not finite.
    pub world: DMat4,
    /// Does an animation say where it is, or where an ancestor is?
    pub moves: bool,
}

/// All nodes of the scene that the file shows first in a pose, parents before their children.
///
/// # Errors
/// A node or a scene that does not exist, one with two parents or that is its own ancestor, or a transform of the wrong length.
pub fn walk<'d>(document: &'d Document, pose: &'d Pose) -> Unplaced<Vec<Placed<'d>>> {
    let has_parent = parents(document)?;
    let mut placed = Vec::new();
    let mut is_seen = vec![false; document.nodes.len()];
    // The last is next.
    let mut open: Vec<(usize, DMat4, bool)> = roots(document, &has_parent)?;
    open.reverse();
    while let Some((number, above, is_carried)) = open.pop() {
        let node = pick(&document.nodes, number, "nodes", "node")?;
        if std::mem::replace(is_seen.get_mut(number).unwrap_or(&mut true), true) {
            return Err(format!("nodes[{number}]: it is reached twice; name it once, and no node as its own ancestor"));
        }
        let change = pose.change(number);
        let world = above * local(node, change).map_err(|fault| format!("nodes[{number}].{fault}"))?;
        let weights = change.and_then(|change| change.weights.as_deref()).or(node.weights.as_deref());
        let moves = is_carried || change.is_some_and(Change::moves);
        placed.push(Placed { number, node, weights, world, moves });
        open.extend(node.children.iter().rev().map(|&child| (child, world, moves)));
    }
    Ok(placed)
}

/// Which nodes are children.
fn parents(document: &Document) -> Unplaced<Vec<bool>> {
    let mut has_parent = vec![false; document.nodes.len()];
    for (number, node) in document.nodes.iter().enumerate() {
        for &child in &node.children {
            let owner = format!("nodes[{number}].children");
            pick(&document.nodes, child, &owner, "node")?;
            if std::mem::replace(has_parent.get_mut(child).unwrap_or(&mut true), true) {
                return Err(format!("{owner}: node {child} has two parents; make a node of its own for each"));
            }
        }
    }
    Ok(has_parent)
}

fn roots(document: &Document, has_parent: &[bool]) -> Unplaced<Vec<(usize, DMat4, bool)>> {
    let here = |number| (number, DMat4::IDENTITY, false);
    if document.scenes.is_empty() && document.scene.is_none() {
        let roots = has_parent.iter().enumerate().filter(|(_, has)| !**has);
        return Ok(roots.map(|(number, _)| here(number)).collect());
    }
    let scene = document.scene.unwrap_or(0);
    let nodes = &pick(&document.scenes, scene, "scene", "scene")?.nodes;
    let owner = format!("scenes[{scene}].nodes");
    nodes.iter().try_for_each(|&number| pick(&document.nodes, number, &owner, "node").map(drop))?;
    Ok(nodes.iter().copied().map(here).collect())
}

/// The transform of a node, by its matrix or by translation, rotation and scale, which an animation changes. The error begins with the key.
fn local(node: &Node, change: Option<&Change>) -> Unplaced<DMat4> {
    let still = Change::default();
    let change = change.unwrap_or(&still);
    if let (Some(matrix), false) = (&node.matrix, change.moves()) {
        return Ok(DMat4::from_cols_array(&numbers("matrix", matrix)?));
    }
    let given = |key, list: &Option<Vec<f64>>| list.as_ref().map(|list| numbers::<3>(key, list)).transpose();
    let translation = change.translation.or(given("translation", &node.translation)?).map_or(DVec3::ZERO, DVec3::from);
    let scale = change.scale.or(given("scale", &node.scale)?).map_or(DVec3::ONE, DVec3::from);
    let rotation = node.rotation.as_ref().map(|list| numbers::<4>("rotation", list)).transpose()?;
    let rotation = change.rotation.or(rotation);
    Ok(from_parts(translation, rotation.map_or(DVec4::W, DVec4::from), scale))
}

/// Scales, turns, then moves. A quaternion of no length turns nothing.
pub fn from_parts(translation: DVec3, rotation: DVec4, scale: DVec3) -> DMat4 {
    let rotation = rotation.try_normalize().map_or(DQuat::IDENTITY, DQuat::from_vec4);
    DMat4::from_scale_rotation_translation(scale, rotation, translation)
}

fn numbers<const N: usize>(key: &str, list: &[f64]) -> Unplaced<[f64; N]> {
    list.try_into().map_err(|_| format!("{key}: it has {} numbers and needs {N}; write the file again", list.len()))
}
