//! The tree whose planes split triangles.

use std::collections::VecDeque;

use rayon::prelude::*;

use super::part::Part;

/// A tree as it grows.
pub(super) enum Branch {
    /// Left and right.
    Inner(Box<[Branch; 2]>),
    /// What one thread has grown.
    Chunk(Chunk),
}

/// A small tree. Node 0 is its root, siblings lie in a row.
pub(super) struct Chunk {
    nodes: Vec<Kind>,
    /// The parts of its leaves.
    parts: Vec<Part>,
    /// Where each leaf's parts end.
    ends: Vec<u32>,
}

impl Chunk {
    /// For about so many parts.
    pub fn new(parts: usize) -> Self {
        let mut nodes = Vec::with_capacity(2 * parts);
        nodes.push(Kind::Leaf(0));
        Chunk { nodes, parts: Vec::with_capacity(parts), ends: Vec::with_capacity(parts) }
    }

    /// Makes a node a leaf of these parts.
    pub fn leaf(&mut self, number: usize, parts: &[Part]) {
        self.nodes[number] = Kind::Leaf(self.ends.len() as u32);
        self.parts.extend_from_slice(parts);
        self.ends.push(self.parts.len() as u32);
    }

    /// Makes a node an inner one. Returns the number of its left child, which the right one follows.
    pub fn inner(&mut self, number: usize) -> usize {
        let left = self.nodes.len();
        self.nodes.extend([Kind::Leaf(0); 2]);
        self.nodes[number] = Kind::Inner(left as u32, left as u32 + 1);
        left
    }
}

/// What a node of a [`Tree`] is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Left and right child, by their numbers.
    Inner(u32, u32),
    /// A leaf, by its number.
    Leaf(u32),
}

/// A tree in breadth-first order, siblings in a row, whose leaves cover references in depth-first order. Node 0
/// is the root. The reinsertion relies on large nodes being among the first.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tree {
    pub nodes: Vec<Kind>,
    /// Where each leaf's references start, and their number at the end.
    pub starts: Vec<u32>,
}

impl Branch {
    /// The chunks from left to right.
    fn chunks<'b>(&'b self, list: &mut Vec<&'b Chunk>) {
        match self {
            Branch::Inner(children) => children.iter().for_each(|child| child.chunks(list)),
            Branch::Chunk(chunk) => list.push(chunk),
        }
    }

    /// The parts of all leaves, in depth-first order, as something else.
    pub fn parts<T: Send>(&self, of: impl Fn(&Part) -> T + Sync) -> Vec<T> {
        let mut chunks = Vec::new();
        self.chunks(&mut chunks);
        chunks.par_iter().flat_map_iter(|chunk| chunk.parts.iter().map(&of)).collect()
    }

    /// Where each leaf's parts start, and their number at the end.
    fn starts(&self) -> Vec<u32> {
        let mut chunks = Vec::new();
        self.chunks(&mut chunks);
        let (mut starts, mut before) = (vec![0], 0);
        for chunk in chunks {
            starts.extend(chunk.ends.iter().map(|end| before + end));
            before += chunk.parts.len() as u32;
        }
        starts
    }

    /// How many leaves it has.
    fn leaves(&self) -> u32 {
        match self {
            Branch::Inner(children) => children.iter().map(Branch::leaves).sum(),
            Branch::Chunk(chunk) => chunk.ends.len() as u32,
        }
    }

    /// The tree with its nodes numbered.
    pub fn flat(&self) -> Tree {
        let mut nodes = vec![Kind::Leaf(0)];
        let mut open = VecDeque::from([Place::of(self, 0)]);
        let mut number = 0;
        while let Some(place) = open.pop_front() {
            nodes[number] = match place.children() {
                Ok(children) => {
                    let left = nodes.len() as u32;
                    nodes.extend([Kind::Leaf(0); 2]);
                    open.extend(children);
                    Kind::Inner(left, left + 1)
                }
                Err(leaf) => Kind::Leaf(leaf),
            };
            number += 1;
        }
        Tree { nodes, starts: self.starts() }
    }
}

/// A node of a grown tree, wherever it is, and how many leaves are on its left: within its chunk, those before the chunk.
enum Place<'b> {
    Branch(&'b [Branch; 2], u32),
    Node(&'b Chunk, u32, u32),
}

impl<'b> Place<'b> {
    fn of(branch: &'b Branch, before: u32) -> Self {
        match branch {
            Branch::Inner(children) => Place::Branch(children, before),
            Branch::Chunk(chunk) => Place::Node(chunk, 0, before),
        }
    }

    /// The children, or the number of the leaf that it is.
    fn children(self) -> Result<[Place<'b>; 2], u32> {
        match self {
            Place::Branch([left, right], before) => {
                Ok([Place::of(left, before), Place::of(right, before + left.leaves())])
            }
            Place::Node(chunk, number, before) => match chunk.nodes[number as usize] {
                Kind::Inner(left, right) => Ok([left, right].map(|child| Place::Node(chunk, child, before))),
                Kind::Leaf(leaf) => Err(before + leaf),
            },
        }
    }
}
