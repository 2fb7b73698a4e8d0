//! What a hierarchy looks like (thesis table 7.1) and what it costs.

use eyerays_shader::data::{NodePair, NodeRef, Primitive};

use crate::{
    Bvh,
    bounds::Bounds,
    tree::{Fold, fold},
    validate::{children, is_empty},
    wide::{Child, Record},
};

/// Figures of a hierarchy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// Primitives.
    pub primitives: usize,
    /// References to primitives or parts of triangles, each in a place of its own (thesis: split triangles).
    pub references: usize,
    /// Inner nodes and leaves.
    pub nodes: usize,
    /// Leaves.
    pub leaves: usize,
    /// The most edges from the root to a leaf, which are the pairs on that path.
    pub depth: u32,
    /// The expected cost of a random ray by the surface area heuristic: for each inner node
    /// [`Statistics::TRAVERSAL`], for each triangle [`Statistics::INTERSECTION`], times the surface
    /// area of the node that is or holds it, divided by the root's.
    pub sah_cost: f64,
    /// Bytes of the node pairs.
    pub node_bytes: usize,
    /// Wide nodes, none before [`Bvh::widen`].
    pub wide_nodes: usize,
    /// The most wide nodes on a path from the root.
    pub wide_depth: u32,
    /// As [`Statistics::sah_cost`], of the wide nodes: for each node [`Statistics::TRAVERSAL`], for each
    /// triangle [`Statistics::INTERSECTION`], with the areas of the quantised boxes.
    pub wide_sah_cost: f64,
    /// Bytes of the wide nodes.
    pub wide_bytes: usize,
    /// Bytes of the primitives in leaf order.
    pub primitive_bytes: usize,
}

impl Statistics {
    /// Cost of the step through an inner node, which tests the boxes of both children.
    pub const TRAVERSAL: f64 = 1.0;
    /// Cost of a triangle test.
    pub const INTERSECTION: f64 = 1.0;

    /// The figures of `bvh`, which was built over `primitives`.
    pub fn of(bvh: &Bvh, primitives: &[Primitive]) -> Self {
        let (pairs, wide) = rayon::join(|| Figures::of_pairs(bvh), || Figures::of_wide(bvh));
        Statistics {
            primitives: primitives.len(),
            references: bvh.order.len(),
            nodes: bvh.nodes.len() + pairs.leaves,
            leaves: pairs.leaves,
            depth: pairs.depth,
            sah_cost: pairs.sah_cost,
            node_bytes: size_of_val(&bvh.nodes[..]),
            wide_nodes: bvh.wide.len(),
            wide_depth: wide.depth,
            wide_sah_cost: wide.sah_cost,
            wide_bytes: size_of_val(&bvh.wide[..]),
            primitive_bytes: size_of::<Primitive>() * bvh.order.len(),
        }
    }
}

/// What a walk through either hierarchy finds.
struct Figures {
    leaves: usize,
    depth: u32,
    sah_cost: f64,
}

impl Figures {
    fn of_pairs(bvh: &Bvh) -> Self {
        let root = Bounds::around(real_children(&bvh.nodes[0]).map(|(bounds, _)| bounds));
        let figures = fold(&bvh.nodes, &mut vec![(); bvh.nodes.len()], &Sums { whole: f64::from(root.half_area()) });
        Figures { sah_cost: Statistics::TRAVERSAL + figures.sah_cost, ..figures }
    }

    fn of_wide(bvh: &Bvh) -> Self {
        let mut figures = Figures { leaves: 0, depth: 0, sah_cost: 0.0 };
        let mut open = vec![(0u32, 1u32, None)];
        let mut root = 0.0;
        if bvh.wide.is_empty() {
            return figures;
        }
        while let Some((node, depth, area)) = open.pop() {
            let record = Record::decode(&bvh.wide[node as usize]).expect("a validated node");
            let half_area = |planes| f64::from(record.grid.bounds(planes).half_area());
            let real = || record.children.into_iter().filter(|child| child.0 != Child::None);
            let area = area.unwrap_or_else(|| {
                let all = Bounds::around(real().map(|(_, planes)| record.grid.bounds(planes)));
                root = f64::from(all.half_area());
                root
            });
            figures.depth = figures.depth.max(depth);
            figures.sah_cost += Statistics::TRAVERSAL * area / root;
            let mut next = record.first_child;
            for (child, planes) in real() {
                if let Child::Leaf { count } = child {
                    figures.leaves += 1;
                    figures.sah_cost += Statistics::INTERSECTION * f64::from(count) * half_area(planes) / root;
                } else {
                    open.push((next, depth + 1, Some(half_area(planes))));
                    next += 1;
                }
            }
        }
        figures
    }
}

/// The figures of what is below a pair, whose own costs are its parent's to add.
struct Sums {
    /// Half the root's area.
    whole: f64,
}

impl Fold<NodePair> for Sums {
    type Known = Figures;
    type Note = ();

    fn leaf(&self, _: NodeRef) -> Figures {
        Figures { leaves: 1, depth: 0, sah_cost: 0.0 }
    }

    fn pair(&self, _: usize, pair: &NodePair, below: [Figures; 2], (): &mut ()) -> Figures {
        let mut sum = Figures { leaves: 0, depth: 0, sah_cost: 0.0 };
        for ((bounds, child), below) in real_children(pair).zip(below) {
            let share = f64::from(bounds.half_area()) / self.whole;
            let tests = f64::from(child.count()) * Statistics::INTERSECTION;
            sum.sah_cost += below.sah_cost + share * if child.is_leaf() { tests } else { Statistics::TRAVERSAL };
            sum.leaves += below.leaves;
            sum.depth = sum.depth.max(1 + below.depth);
        }
        sum
    }
}

/// The children of a pair without [`NodePair::EMPTY`].
fn real_children(pair: &NodePair) -> impl Iterator<Item = (Bounds, NodeRef)> {
    children(pair).into_iter().filter(|&(bounds, reference)| !is_empty(bounds, reference))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wide::Grid;
    use glam::{Vec3, vec3};

    /// A box of edge 1 from `x` on.
    fn unit(x: f32, leaf: NodeRef) -> (Vec3, Vec3, NodeRef) {
        (vec3(x, 0.0, 0.0), vec3(x + 1.0, 1.0, 1.0), leaf)
    }

    #[test]
    fn a_tree_by_hand() {
        let mut children = [Record::NOWHERE; 8];
        children[0] = (Child::Leaf { count: 2 }, [[0; 3], [64; 3]]);
        children[4] = (Child::Leaf { count: 3 }, [[64; 3], [128; 3]]);
        let grid = Grid { origin: [0.0; 3], exponent: [-6; 3] };
        let wide = Record { grid, first_child: 0, first_triangle: 0, children }.encode();
        let inner = (Vec3::ZERO, vec3(2.0, 1.0, 1.0), NodeRef::inner(1));
        let bvh = Bvh {
            nodes: vec![
                NodePair::new(inner, unit(3.0, NodeRef::leaf(5, 4))),
                NodePair::new(unit(0.0, NodeRef::leaf(0, 2)), unit(1.0, NodeRef::leaf(2, 3))),
            ],
            wide: vec![wide],
            order: (0..9).collect(),
            bounds: vec![Bounds::EMPTY.write(); 9],
        };
        let triangles = [Primitive::triangle([Vec3::ZERO; 3], 0, 0, 0); 9];
        let statistics = Statistics::of(&bvh, &triangles);
        // Half areas: root 9, inner node 5, each leaf 3.
        let cost = 1.0 + 5.0 / 9.0 + (2.0 + 3.0 + 4.0) * 3.0 / 9.0;
        assert!((statistics.sah_cost - cost).abs() < 1e-12);
        // Cubes of edge 1 in one of edge 2.
        assert_eq!(statistics.wide_sah_cost, 1.0 + (2.0 + 3.0) / 4.0);
        let expected = Statistics {
            primitives: 9,
            references: 9,
            nodes: 5,
            leaves: 3,
            depth: 2,
            sah_cost: statistics.sah_cost,
            node_bytes: 128,
            wide_nodes: 1,
            wide_depth: 1,
            wide_sah_cost: statistics.wide_sah_cost,
            wide_bytes: 80,
            primitive_bytes: 432,
        };
        assert_eq!(statistics, expected);
    }

    #[test]
    fn an_empty_sibling_counts_for_nothing() {
        let triangle = Primitive::triangle([Vec3::ZERO, Vec3::X, Vec3::Y], 0, 0, 0);
        let bvh = crate::build(&crate::split(&[triangle], 0.0).unwrap(), crate::Quality::Medium).unwrap();
        let statistics = Statistics::of(&bvh, &[triangle]);
        assert_eq!((statistics.nodes, statistics.leaves, statistics.depth), (2, 1, 1));
        assert_eq!(statistics.sah_cost, Statistics::TRAVERSAL + Statistics::INTERSECTION);
    }
}
