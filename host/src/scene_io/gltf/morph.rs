//! Morph targets: what a mesh's weights add to its vertices.

use std::collections::BTreeMap;

use glam::Vec3;

use super::document;
use super::node::Placed;
use super::notes::Notes;
use super::primitive::Primitive;
use super::vertices::Vertices;
use crate::scene::Unplaced;

/// The weights of a mesh at a node: its own, or else the mesh's.
pub fn weights<'d>(placed: &Placed<'d>, mesh: &'d document::Mesh) -> &'d [f64] {
    placed.weights.unwrap_or(&mesh.weights)
}

impl Primitive {
    /// Adds what its targets say, each times its weight. A target without a weight adds nothing, and what the primitive does not
    /// have stays away.
    ///
    /// # Errors
    /// Those of [`Vertices::attribute`].
    pub fn morph(&mut self, of: &document::Primitive, weights: &[f64], vertices: &Vertices) -> Unplaced<()> {
        let weighted = of.targets.iter().enumerate().zip(weights).filter(|(_, weight)| **weight != 0.0);
        for ((number, target), &weight) in weighted {
            let deltas = |key: &str| -> Unplaced<Vec<Vec3>> {
                let elements = vertices.attribute(target, key, &[3], &format!("targets[{number}]"))?;
                Ok(vertices.list(elements, |delta| Vec3::from_array(delta) * weight as f32))
            };
            for (position, delta) in self.positions.iter_mut().zip(deltas("POSITION")?) {
                *position += delta;
            }
            if !self.normals.is_empty() {
                for (normal, delta) in self.normals.iter_mut().zip(deltas("NORMAL")?) {
                    *normal = plus(*normal, delta);
                }
            }
            if !self.tangents.is_empty() {
                for (tangent, delta) in self.tangents.iter_mut().zip(deltas("TANGENT")?) {
                    *tangent = plus(tangent.truncate(), delta).extend(tangent.w);
                }
            }
        }
        Ok(())
    }
}

/// The sum, or the vector itself where that is no direction.
fn plus(own: Vec3, delta: Vec3) -> Vec3 {
    if (own + delta).is_finite() { own + delta } else { own }
}

/// Says what of targets is not applied.
pub fn note(primitive: &document::Primitive, notes: &mut Notes) {
    let is_read = |key: &String| matches!(key.as_str(), "POSITION" | "NORMAL" | "TANGENT");
    if !primitive.targets.iter().flat_map(BTreeMap::keys).all(is_read) {
        notes.left_out("targets", "morph targets of colours and texture coordinates are left out");
    }
}
