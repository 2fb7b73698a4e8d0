//! Boxes of the hierarchy, for those who draw it.

use eyerays_shader::data::{NodeRef, numbers};
use glam::{UVec4, Vec3};

use super::DeviceScene;

/// The box of a node of the hierarchy, as rays are tested against it: a little wider than what it holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NodeBox {
    /// Its least corner in the world.
    pub least: Vec3,
    /// Its greatest corner.
    pub greatest: Vec3,
    /// Does it hold primitives, or a copy of a mesh, and no other boxes of the world?
    pub is_leaf: bool,
}

impl DeviceScene {
    /// The boxes so many levels below those of the root's two children, and those of leaves that are less deep. Copies of meshes are
    /// leaves.
    pub fn boxes(&self, level: u32) -> Vec<NodeBox> {
        let mut boxes = Vec::new();
        let mut open = vec![(NodeRef::ROOT, 0)];
        while let Some((node, depth)) = open.pop() {
            for (child, bounds) in self.children_of(node.index()).into_iter().flatten() {
                if bounds.is_leaf || depth == level {
                    boxes.push(bounds);
                } else {
                    open.push((child, depth + 1));
                }
            }
        }
        boxes
    }

    /// The boxes of a node's children by its number as [`Visit`](crate::trail::Visit) tells it, of methods that walk pairs; none where
    /// there is no such node.
    pub fn children(&self, node: u32) -> Option<[NodeBox; 2]> {
        let children = self.children_of(node)?;
        Some(children.map(|(_, bounds)| bounds))
    }

    fn children_of(&self, node: u32) -> Option<[(NodeRef, NodeBox); 2]> {
        let pair = self.nodes().get(node as usize)?;
        let sides =
            [(pair.left(), pair.left_centre, pair.left_half), (pair.right(), pair.right_centre, pair.right_half)];
        Some(sides.map(|(child, centre, half)| (child, self.node_box(child, centre, half))))
    }

    fn node_box(&self, child: NodeRef, centre: UVec4, half: UVec4) -> NodeBox {
        let (centre, half) = (numbers(centre), numbers(half));
        let [least, greatest] = [centre - half, centre + half].map(|corner| self.normalisation.in_world(corner));
        // Behind the last pair, references lead to copies.
        let is_leaf = child.is_leaf() || child.index() as usize >= self.nodes().len();
        NodeBox { least, greatest, is_leaf }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Job;
    use crate::quality::Bvh;
    use crate::scene_io;

    #[test]
    fn boxes_of_each_level_hold_those_below_and_the_last_are_leaves() {
        let (scene, _) = scene_io::load("../scenes/glass.toml".as_ref()).unwrap();
        let job = Job::new(&scene, scene.settings, Bvh::Medium.quality()).unwrap();
        let levels: Vec<Vec<NodeBox>> = (0..64).map(|level| job.boxes(level)).collect();
        assert_eq!(levels[0].len(), 2);
        for pair in levels.windows(2) {
            // But for how the margin around each of them is rounded.
            let holds = |outer: &NodeBox, inner: &NodeBox| {
                outer.least.cmple(inner.least + 1e-4).all() && outer.greatest.cmpge(inner.greatest - 1e-4).all()
            };
            assert!(pair[1].iter().all(|inner| pair[0].iter().any(|outer| holds(outer, inner))));
            assert!(pair[0].len() <= pair[1].len() && pair[1].len() <= 2 * pair[0].len());
        }
        let leaves = levels.last().unwrap();
        assert!(leaves.iter().all(|leaf| leaf.is_leaf) && leaves.len() as u32 > levels[3].len() as u32);
        // The whole scene, but for the margin.
        let all = leaves.iter().map(|leaf| [leaf.least, leaf.greatest]);
        let [least, greatest] = all.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]).unwrap();
        let bounds = scene.bounds();
        assert!(least.abs_diff_eq(bounds[0], 1e-3) && greatest.abs_diff_eq(bounds[1], 1e-3));
        assert_eq!(job.children(0).unwrap().to_vec(), levels[0]);
        assert_eq!(job.children(u32::MAX), None);
    }
}
