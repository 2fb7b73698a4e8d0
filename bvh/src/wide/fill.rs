//! How threads share the nodes and leaves of a [`Bvh8`]: those near the root come first, then part by part what is below.
//! Parts are counted before they are made, so that each has its place and nothing is copied.

use eyerays_shader::bvh8::{Bvh8Node, Bvh8Ref, LeafKind, Mixed4, Sphere4, Triangle4};
use eyerays_shader::data::Primitive;
use rayon::prelude::*;

use super::{
    binary::{Boxed, Node},
    bvh8::Bvh8,
    collapse::Plan,
};
use crate::{bounds::Bounds, tree::filled};

/// What is below a node of at most so many slots is one part.
const PART: u32 = 4096;

/// How many nodes there are, and leaves by their kinds.
type Counts = [usize; 4];

/// What nodes and leaves are made of.
pub(super) struct Collapse<'a, P, F> {
    pub plan: Plan<'a, P, F>,
    pub primitives: &'a [Primitive],
}

impl<P: Boxed, F: Fn(u32) -> Bounds + Sync> Collapse<'_, P, F> {
    /// All nodes and leaves.
    pub fn run(&self) -> Bvh8 {
        let top = self.walk((Node::ROOT, 0), PART);
        let roots = top.children.iter().filter_map(|child| match child.is {
            Is::Part { level } => Some((child.node, level)),
            _ => None,
        });
        let roots: Vec<(Node, u32)> = roots.collect();
        let parts: Vec<Walk> = roots.into_par_iter().map(|root| self.walk(root, 0)).collect();
        let [nodes, triangles, spheres, mixed] = parts.iter().fold(top.counts, |all, part| sum(all, part.counts));
        let mut bvh8 = Bvh8 {
            nodes: filled(Bvh8Node::EMPTY, nodes),
            triangles: filled(Triangle4::EMPTY, triangles),
            spheres: filled(Sphere4::EMPTY, spheres),
            mixed: filled(Mixed4::of([].into_iter()), mixed),
        };
        let mut room = Room::all(&mut bvh8);
        let mut first = room.take(top.counts);
        let rooms: Vec<Room<'_>> = parts.iter().map(|part| room.take(part.counts)).collect();
        first.put(self, &top, &mut rooms.iter().map(|room| room.next[0]));
        parts.into_par_iter().zip(rooms).for_each(|(part, mut room)| room.put(self, &part, &mut std::iter::empty()));
        bvh8
    }

    /// The wide nodes from a binary one on, which has so many wide ones above it, but none below inner children of at most
    /// `few` slots: these are parts.
    fn walk(&self, root: (Node, u32), few: u32) -> Walk {
        let mut walk = Walk { nodes: Vec::new(), children: Vec::new(), counts: [1, 0, 0, 0] };
        let (mut open, mut list, mut sorted) = (vec![(0, root)], Vec::new(), Vec::new());
        while let Some((number, (node, level))) = open.pop() {
            self.plan.children_at(node, level, &mut list);
            sorted.clear();
            sorted.extend(list.iter().map(|&(node, is_leaf)| (self.plan.bounds(node).half_area(), node, is_leaf)));
            sorted.sort_by(|a, b| b.0.total_cmp(&a.0));
            let first = open.len();
            for &(_, node, is_leaf) in &sorted {
                let is = if is_leaf {
                    let kind = self.kind(node);
                    walk.counts[place(kind)] += 1;
                    Is::Leaf(kind)
                } else if self.plan.count(node) <= few {
                    Is::Part { level: level + 1 }
                } else {
                    open.push((walk.counts[0], (node, level + 1)));
                    walk.counts[0] += 1;
                    Is::Inner(walk.counts[0] - 1)
                };
                walk.children.push(Child { node, is });
            }
            open[first..].reverse();
            walk.nodes.push((number, walk.children.len()));
        }
        walk
    }

    /// What a leaf holds.
    fn kind(&self, leaf: Node) -> LeafKind {
        let (mut triangles, mut spheres) = (true, true);
        self.plan.each_slot(leaf, |slot| {
            let primitive = &self.primitives[slot as usize];
            triangles &= primitive.is_triangle();
            spheres &= primitive.is_sphere();
        });
        match (triangles, spheres) {
            (true, _) => LeafKind::Triangles,
            (_, true) => LeafKind::Spheres,
            _ => LeafKind::Mixed,
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

/// Wide nodes, in the order in which they are met.
struct Walk {
    /// Each one's number, and where its children end. The inner children of a node are numbered in a row.
    nodes: Vec<(usize, usize)>,
    children: Vec<Child>,
    counts: Counts,
}

/// A child, by its binary node.
struct Child {
    node: Node,
    is: Is,
}

enum Is {
    Leaf(LeafKind),
    /// The wide node of this number in the walk.
    Inner(usize),
    /// The root of another walk, so many wide nodes below that of all.
    Part {
        level: u32,
    },
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

    /// Puts nodes here, and their leaves. `roots` are the numbers of parts' first nodes.
    fn put<P: Boxed, F: Fn(u32) -> Bounds + Sync>(
        &mut self,
        collapse: &Collapse<'_, P, F>,
        walk: &Walk,
        roots: &mut dyn Iterator<Item = usize>,
    ) {
        let (mut start, mut slots) = (0, Vec::new());
        for &(number, end) in &walk.nodes {
            for (i, child) in walk.children[start..end].iter().enumerate() {
                let reference = match child.is {
                    Is::Leaf(kind) => {
                        slots.clear();
                        collapse.plan.each_slot(child.node, |slot| slots.push(slot));
                        self.put_leaf(kind, &slots, collapse.primitives)
                    }
                    Is::Inner(number) => Bvh8Ref::inner((self.next[0] + number) as u32),
                    Is::Part { .. } => Bvh8Ref::inner(roots.next().expect("as counted") as u32),
                };
                set(&mut self.nodes[number], i, collapse.plan.bounds(child.node), reference);
            }
            start = end;
        }
    }

    fn put_leaf(&mut self, kind: LeafKind, slots: &[u32], primitives: &[Primitive]) -> Bvh8Ref {
        fn put<T>(room: &mut &mut [T], leaf: T) {
            *room.split_off_first_mut().expect("as counted") = leaf;
        }
        let numbered = slots.iter().map(|&slot| (slot, &primitives[slot as usize]));
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
    for axis in 0..3 {
        node.planes[axis][0][child] = bounds.min[axis];
        node.planes[axis][1][child] = bounds.max[axis];
    }
    node.children[child] = reference;
}
