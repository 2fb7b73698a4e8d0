//! Copies of a node's mesh (EXT_mesh_gpu_instancing).

use glam::{DMat4, DVec3, DVec4};

use super::accessor::{Accessors, Elements};
use super::node::{Placed, from_parts};
use crate::scene::Unplaced;

/// Where the copies of a node's mesh are; one where the node is, if nothing says that there are others.
pub struct Copies<'f> {
    /// How many there are.
    pub count: usize,
    node: DMat4,
    translation: Option<Elements<'f>>,
    rotation: Option<Elements<'f>>,
    scale: Option<Elements<'f>>,
}

impl<'f> Copies<'f> {
    /// Those of a node.
    ///
    /// # Errors
    /// Those of [`Accessors::open`], and lists of different lengths.
    pub fn of(placed: &Placed, accessors: &Accessors<'f>) -> Unplaced<Self> {
        let mut copies = Copies { count: 1, node: placed.world, translation: None, rotation: None, scale: None };
        let Some(instances) = &placed.node.extensions.instances else { return Ok(copies) };
        let owner = format!("nodes[{}].extensions.EXT_mesh_gpu_instancing.attributes", placed.number);
        let mut count = None;
        for (key, &number) in &instances.attributes {
            let here = format!("{owner}.{key}");
            let widths: &[usize] = match key.as_str() {
                "TRANSLATION" | "SCALE" => &[3],
                "ROTATION" => &[4],
                _ => &[1, 2, 3, 4, 16],
            };
            let elements = accessors.open(number, widths, &here)?;
            let found = elements.count;
            let wanted = *count.get_or_insert(found);
            if found != wanted {
                return Err(format!(
                    "{here}: it has {found} elements beside {wanted} of another; write the file again"
                ));
            }
            match key.as_str() {
                "TRANSLATION" => copies.translation = Some(elements),
                "ROTATION" => copies.rotation = Some(elements),
                "SCALE" => copies.scale = Some(elements),
                _ => {}
            }
        }
        copies.count = count.unwrap_or(1);
        Ok(copies)
    }

    /// From the units of the mesh to the world's, of each.
    pub fn worlds(&self) -> impl Iterator<Item = DMat4> + '_ {
        (0..self.count).map(|number| {
            let vector = |of: &Option<Elements>, otherwise| match of {
                Some(elements) => DVec3::from(elements.vector::<3>(number).map(f64::from)),
                None => otherwise,
            };
            let rotation = self.rotation.as_ref().map_or(DVec4::W, |of| DVec4::from(of.vector(number).map(f64::from)));
            let (translation, scale) = (vector(&self.translation, DVec3::ZERO), vector(&self.scale, DVec3::ONE));
            self.node * from_parts(translation, rotation, scale)
        })
    }
}
