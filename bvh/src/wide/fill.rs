//! How threads share the nodes and leaves of a [`Bvh8`]: those near the root come first, then part by part what is below.
//! Parts are counted before they are made, so that each has its place and nothing is copied.

use eyerays_shader::bvh8::{Bvh8Node, Bvh8Ref, LeafKind, Mixed4, Sphere4, Triangle4};
use eyerays_shader::data::Primitive;
use rayon::prelude::*;

use super::{
    binary::{Binary, Node},
    bvh8::Bvh8,
    collapse::Plan,
};
use crate::{bounds::Bounds, tree::filled};

/// What is below a node of at most so many slots is one part.
const PART: u32 = 4096;

/// How many nodes there are, and leaves by their kinds.
type Counts = [usize; 4];

/// What nodes and leaves are made of.
pub(super) struct Collapse<'a> {
    pub tree: Binary,
    pub plan: Plan,
    pub primitives: &'a [Primitive],
}

impl Collapse<'_> {
    /// All nodes and leaves.
    pub fn run(&self) -> Bvh8 {
        let (mut top, mut parts) = ([0; 4], Vec::new());
        self.walk((0, 0), PART, &mut |wide| {
            self.count(&mut top, wide);
            let roots = wide.children.iter().filter(|child| child.is == Is::Part);
            parts.extend(roots.map(|root| (root.node, wide.level + 1)));
        });
        let counted = |&root: &(u32, u32)| {
            let mut counts = [0; 4];
            self.walk(root, 0, &mut |wide| self.count(&mut counts, wide));
            counts
        };
        let counts: Vec<Counts> = parts.par_iter().map(counted).collect();
        let [nodes, triangles, spheres, mixed] = counts.iter().fold(top, |all, counts| sum(all, *counts));
        let mut bvh8 = Bvh8 {
            nodes: filled(Bvh8Node::EMPTY, nodes),
            triangles: filled(Triangle4::EMPTY, triangles),
            spheres: filled(Sphere4::EMPTY, spheres),
            mixed: filled(Mixed4::of([].into_iter()), mixed),
        };
        let mut room = Room::all(&mut bvh8);
        let mut first = room.take(top);
        let rooms: Vec<Room<'_>> = counts.into_iter().map(|counts| room.take(counts)).collect();
        let mut roots = rooms.iter().map(|room| room.next[0]);
        self.walk((0, 0), PART, &mut |wide| first.put(self, wide, &mut roots));
        parts.par_iter().zip(rooms).for_each(|(&root, mut room)| {
            self.walk(root, 0, &mut |wide| room.put(self, wide, &mut std::iter::empty()));
        });
        bvh8
    }

    /// Visits wide nodes from a binary one on, which has so many wide ones above it, but none below inner children of at most
    /// `few` slots: these are parts.
    fn walk(&self, root: (u32, u32), few: u32, visit: &mut dyn FnMut(&Wide)) {
        let (mut open, mut list, mut nodes) = (vec![(0, root)], Vec::new(), 1);
        while let Some((number, (node, level))) = open.pop() {
            self.plan.children_at(&self.tree, node, level, &mut list);
            let area = |child: &(u32, bool)| self.node(child.0).bounds.half_area();
            list.sort_by(|a, b| area(b).total_cmp(&area(a)));
            let first = open.len();
            let child = |&(node, is_leaf): &(u32, bool)| {
                if is_leaf {
                    return Child { node, is: Is::Leaf };
                }
                if self.node(node).count <= few {
                    return Child { node, is: Is::Part };
                }
                nodes += 1;
                open.push((nodes - 1, (node, level + 1)));
                Child { node, is: Is::Inner(nodes - 1) }
            };
            let children = list.iter().map(child).collect();
            open[first..].reverse();
            visit(&Wide { number, level, children });
        }
    }

    fn node(&self, number: u32) -> &Node {
        &self.tree.nodes[number as usize]
    }

    /// The slots of a leaf, and what it holds.
    fn leaf(&self, node: u32) -> (&[u32], LeafKind) {
        let Node { first, count, .. } = *self.node(node);
        let slots = &self.tree.order[first as usize..(first + count) as usize];
        let all = |is: fn(&Primitive) -> bool| slots.iter().all(|&slot| is(&self.primitives[slot as usize]));
        let kind = if all(Primitive::is_triangle) {
            LeafKind::Triangles
        } else if all(Primitive::is_sphere) {
            LeafKind::Spheres
        } else {
            LeafKind::Mixed
        };
        (slots, kind)
    }

    fn count(&self, counts: &mut Counts, wide: &Wide) {
        counts[0] += 1;
        for leaf in wide.children.iter().filter(|child| child.is == Is::Leaf) {
            counts[place(self.leaf(leaf.node).1)] += 1;
        }
    }
}

/// Where leaves of a kind are counted.
fn place(kind: LeafKind) -> usize {
    match kind {
        LeafKind::Triangles => 1,
        LeafKind::Spheres => 2,
        LeafKind::Mixed => 3,
    }
}

fn sum(a: Counts, b: Counts) -> Counts {
    std::array::from_fn(|i| a[i] + b[i])
}

/// A wide node that a walk meets.
struct Wide {
    /// Its number in the walk.
    number: usize,
    level: u32,
    children: Vec<Child>,
}

/// A child, by its binary node.
struct Child {
    node: u32,
    is: Is,
}

#[derive(Clone, Copy, PartialEq)]
enum Is {
    Leaf,
    /// The wide node of this number in the walk.
    Inner(usize),
    /// The root of a part.
    Part,
}

/// Room for nodes and leaves.
struct Room<'r> {
    /// The number of the first node, and of the next leaf of each kind.
    next: Counts,
    nodes: &'r mut [Bvh8Node],
    triangles: &'r mut [Triangle4],
    spheres: &'r mut [Sphere4],
    mixed: &'r mut [Mixed4],
}

impl<'r> Room<'r> {
    fn all(bvh8: &'r mut Bvh8) -> Self {
        let Bvh8 { nodes, triangles, spheres, mixed } = bvh8;
        Room { next: [0; 4], nodes, triangles, spheres, mixed }
    }

    /// Takes room for so many from the front.
    fn take(&mut self, counts: Counts) -> Room<'r> {
        fn front<'t, T>(all: &mut &'t mut [T], count: usize) -> &'t mut [T] {
            all.split_off_mut(..count).expect("as counted")
        }
        let next = self.next;
        self.next = sum(next, counts);
        Room {
            next,
            nodes: front(&mut self.nodes, counts[0]),
            triangles: front(&mut self.triangles, counts[1]),
            spheres: front(&mut self.spheres, counts[2]),
            mixed: front(&mut self.mixed, counts[3]),
        }
    }

    /// Puts a node here, and its leaves. `roots` are the numbers of parts' first nodes.
    fn put(&mut self, collapse: &Collapse<'_>, wide: &Wide, roots: &mut dyn Iterator<Item = usize>) {
        for (i, child) in wide.children.iter().enumerate() {
            let reference = match child.is {
                Is::Leaf => self.put_leaf(collapse, child.node),
                Is::Inner(number) => Bvh8Ref::inner((self.next[0] + number) as u32),
                Is::Part => Bvh8Ref::inner(roots.next().expect("as counted") as u32),
            };
            set(&mut self.nodes[wide.number], i, collapse.node(child.node).bounds, reference);
        }
    }

    fn put_leaf(&mut self, collapse: &Collapse<'_>, node: u32) -> Bvh8Ref {
        fn put<T>(room: &mut &mut [T], leaf: T) {
            *room.split_off_first_mut().expect("as counted") = leaf;
        }
        let (slots, kind) = collapse.leaf(node);
        let numbered = slots.iter().map(|&slot| (slot, &collapse.primitives[slot as usize]));
        match kind {
            LeafKind::Triangles => put(&mut self.triangles, Triangle4::of(numbered)),
            LeafKind::Spheres => put(&mut self.spheres, Sphere4::of(numbered)),
            LeafKind::Mixed => put(&mut self.mixed, Mixed4::of(slots.iter().copied())),
        }
        let number = &mut self.next[place(kind)];
        *number += 1;
        Bvh8Ref::leaf(kind, *number as u32 - 1)
    }
}

/// Puts a child into a node.
fn set(node: &mut Bvh8Node, child: usize, bounds: Bounds, reference: Bvh8Ref) {
    let margin = f64::from(Bvh8Node::MARGIN);
    for axis in 0..3 {
        node.planes[axis][0][child] = (f64::from(bounds.min[axis]) - margin) as f32;
        node.planes[axis][1][child] = (f64::from(bounds.max[axis]) + margin) as f32;
    }
    node.children[child] = reference;
}
