//! The tree from the root down.

use eyerays_shader::data::{BOX_PADDING, MAX_LEAF, NodeRef, Primitive};
use glam::Vec3A;

use super::{
    bins::{BINS, Bins, Grid, Split, area},
    many,
    part::Part,
    through::through,
};
use crate::{
    Reference,
    bounds::{Bounds, half_area},
    branch::{Branch, Items, Piece},
    median,
};

/// Planes through triangles are tried where the children of the best plane between them overlap by more
/// than this share of the scene's surface area (Stich et al.: 1e-5, which on Conference and Sibenik makes
/// three times the references and saves no visits).
const OVERLAP: f32 = 1e-4;
/// And by more than this share of the node's own. With 0.2, Conference's tree costs as much and Sibenik's 1 % less, and they take a tenth longer
/// to grow; with 0.4, that of Sibenik costs 3 % more.
const OVERLAP_OF_NODE: f32 = 0.25;
/// From this level on, nodes are split at medians.
const LEVELS: u32 = 56;
/// From this many parts on, two threads grow a node's children.
const MANY: usize = 2048;

/// Grows a tree over the first `count` of these parts; splits may take the room behind them. The parts of its leaves, and their
/// own boxes, stay where the parts were.
pub(super) fn grow<'p>(triangles: &[Primitive], parts: &'p mut [Part], count: usize) -> Branch<Left<'p>> {
    let scene = area(around(&parts[..count]));
    let least_overlap = if count < parts.len() { OVERLAP * scene } else { f32::INFINITY };
    let grower = Grower { triangles, least_overlap };
    grower.branch(Node { parts, count, level: 0 })
}

/// The parts of a piece's leaves, from left to right with nothing between them, each with its own box instead of its extent.
pub(super) struct Left<'p> {
    parts: &'p [Part],
    count: usize,
}

impl Items for Left<'_> {
    type Item = Reference;

    fn count(&self) -> usize {
        self.count
    }

    fn write(&self, to: &mut [Reference]) {
        let left = self.parts.iter().filter(|part| !part.is_none());
        for (to, part) in to.iter_mut().zip(left) {
            *to = Reference { primitive: part.triangle(), bounds: part.bounds().write() };
        }
    }
}

/// A node that is still to be split: at least one part, and behind them room for more.
struct Node<'p> {
    parts: &'p mut [Part],
    count: usize,
    level: u32,
}

impl<'p> Node<'p> {
    fn parts(&self) -> &[Part] {
        &self.parts[..self.count]
    }

    fn room(&self) -> usize {
        self.parts.len() - self.count
    }

    /// Makes children of the first `left` parts and of the other `right`, which share the room in proportion to the area of
    /// their parts, since large ones are split.
    fn halves(self, left: usize, right: usize) -> [Node<'p>; 2] {
        let (Node { parts, level, .. }, count) = (self, left + right);
        let one = share(parts.len() - count, parts[..count].split_at(left));
        if one > 0 {
            parts.copy_within(left..count, left + one);
        }
        let (first, second) = parts.split_at_mut(left + one);
        [(first, left), (second, right)].map(|(parts, count)| Node { parts, count, level: level + 1 })
    }
}

/// What a thread needs again and again.
struct Workspace {
    bins: Box<[Bins; 3]>,
    /// Parts on their way to the left and to the right.
    sides: [Vec<Part>; 2],
    /// Parts that a plane crosses.
    met: Vec<Part>,
}

impl Workspace {
    fn new() -> Self {
        Workspace { bins: Box::new([Bins::EMPTY; 3]), sides: Default::default(), met: Vec::new() }
    }
}

struct Grower<'a> {
    triangles: &'a [Primitive],
    /// The least area of overlap for which a plane through triangles is tried.
    least_overlap: f32,
}

impl Grower<'_> {
    /// The tree below a node.
    fn branch<'p>(&self, node: Node<'p>) -> Branch<Left<'p>> {
        if node.count < MANY {
            let Node { parts, count, level } = node;
            let mut piece = Piece { pairs: Vec::with_capacity(count), items: 0 };
            self.fill(Node { parts: &mut *parts, count, level }, &mut piece, &mut Workspace::new());
            piece.pairs.shrink_to_fit();
            return Branch::Piece(Piece { pairs: piece.pairs, items: Left { parts, count: piece.items } });
        }
        let [left, right] = self.children(node, &mut Workspace::new());
        let (left, right) = rayon::join(|| self.branch(left), || self.branch(right));
        Branch::Inner(Box::new([left, right]))
    }

    /// Grows what is below a node of a piece, which counts its parts so far, and puts leaves together where one costs no more
    /// than a pair of them.
    fn fill(&self, node: Node<'_>, piece: &mut Piece<usize>, space: &mut Workspace) -> Subtree {
        if node.count == 1 {
            let [part, room @ ..] = node.parts else { unreachable!("a node has its parts") };
            *part = part.own();
            room.fill(Part::NONE);
            piece.items += 1;
            let joins = part.is_triangle() || !self.triangles[part.triangle() as usize].is_instance();
            return Subtree { child: NodeRef::leaf(piece.items as u32 - 1, 1), bounds: part.bounds(), joins };
        }
        let (number, is_root) = (piece.pairs.len(), node.level == 0);
        piece.pairs.push([NodeRef::ROOT; 2]);
        let [left, right] = self.children(node, space).map(|child| self.fill(child, piece, space));
        if let Some(leaf) = Subtree::leaf(&left, &right).filter(|_| !is_root) {
            piece.pairs.pop();
            return leaf;
        }
        piece.pairs[number] = [left.child, right.child];
        Subtree { child: NodeRef::inner(number as u32), bounds: left.bounds.union(right.bounds), joins: false }
    }

    /// Splits a node in two, neither of which is empty.
    fn children<'p>(&self, mut node: Node<'p>, space: &mut Workspace) -> [Node<'p>; 2] {
        if let [left, right] = node.parts()
            && let Some(children) = self.two(left, right)
        {
            node.parts[..2].copy_from_slice(&children);
            return node.halves(1, 1);
        }
        if node.level >= LEVELS {
            let (parts, count) = (&mut node.parts[..node.count], node.count);
            let half = median::split(parts, Part::bounds, Part::triangle);
            return node.halves(half, count - half);
        }
        let grid = Grid::across(many::around(node.parts(), |part| Bounds::point(part.bounds().centre())), BINS);
        many::sort_into(&mut space.bins, node.parts(), |bins, parts| by_centre(bins, &grid, parts));
        let between = (0..3).map(|axis| space.bins[axis].cheapest(axis)).fold(None, Split::cheaper);
        if node.room() > 0
            && let Some([left, right]) = self.through(&mut node, between, space)
        {
            return node.halves(left, right);
        }
        let count = node.count;
        let Some(split) = between else {
            return node.halves(count / 2, count - count / 2);
        };
        let is_left = |part: &Part| grid.bin(split.axis, part.bounds().centre()[split.axis]) < split.bin;
        let left = many::partition(&mut node.parts[..count], &mut space.sides[1], is_left);
        node.halves(left, count - left)
    }

    /// Two parts in their order along the first axis that tells them apart, as half of all nodes have them: the plane between
    /// them costs the same along any. None where a plane through them may cost less.
    fn two(&self, a: &Part, b: &Part) -> Option<[Part; 2]> {
        let [one, other] = [a, b].map(Part::bounds);
        if area(one.intersection(other)) > self.least_overlap {
            return None;
        }
        let (one, other) = (one.centre(), other.centre());
        let axis = (0..3).find(|&axis| one[axis] != other[axis]).unwrap_or(0);
        Some(if other[axis] < one[axis] { [*b, *a] } else { [*a, *b] })
    }

    /// Do children overlap by so little that no plane through them is tried?
    fn is_apart(&self, [left, right]: [Bounds; 2]) -> bool {
        area(left.intersection(right)) <= self.least_overlap.max(OVERLAP_OF_NODE * area(left.union(right)))
    }

    /// Cuts parts at a plane, if that is cheaper than `between` them, and cheaper than a leaf. Returns how many are on
    /// either side.
    fn through(&self, node: &mut Node<'_>, between: Option<Split>, space: &mut Workspace) -> Option<[usize; 2]> {
        if between.is_some_and(|split| self.is_apart(split.children)) {
            return None;
        }
        let (parts, bounds) = (node.parts(), around(node.parts()));
        let most = between.map_or(f32::INFINITY, |split| split.cost);
        let (split, plane) = through(&mut space.bins, self.triangles, parts, bounds)?;
        let leaf = area(bounds) * parts.len() as f32;
        let pays = parts.len() >= MAX_LEAF as usize || split.cost + area(bounds) < leaf;
        if !pays || most <= split.cost {
            return None;
        }
        self.cut(node, split.axis, plane, space)
    }

    /// Sorts parts to the sides of a plane, if neither side stays empty. Those that it crosses are cut, unless it costs less
    /// to keep them whole on one side, or there is no room. Returns how many are on either side.
    fn cut(&self, node: &mut Node<'_>, axis: usize, plane: f32, space: &mut Workspace) -> Option<[usize; 2]> {
        let Workspace { sides: [left, right], met, .. } = space;
        [&mut *left, right, met].into_iter().for_each(Vec::clear);
        let mut boxes = [Bounds::EMPTY; 2];
        for &part in node.parts() {
            let bounds = part.bounds();
            match (bounds.max[axis] <= plane, bounds.min[axis] >= plane) {
                (true, _) => {
                    boxes[0] = boxes[0].union(bounds);
                    left.push(part);
                }
                (_, true) => {
                    boxes[1] = boxes[1].union(bounds);
                    right.push(part);
                }
                _ => met.push(part),
            }
        }
        let mut room = node.room();
        let mut counts = [left.len() + met.len(), right.len() + met.len()].map(|count| count as f32);
        let sides = [left, right];
        for &part in met.iter() {
            let cut = part.cut(&self.triangles[part.triangle() as usize], axis, plane);
            let goes = goes(&part, &cut, &boxes, &counts, room > 0);
            let is_cut = goes == [true; 2];
            room -= usize::from(is_cut);
            for side in 0..2 {
                match if is_cut { cut[side] } else { goes[side].then_some(part) } {
                    Some(part) => {
                        boxes[side] = boxes[side].union(part.bounds());
                        sides[side].push(part);
                    }
                    None => counts[side] -= 1.0,
                }
            }
        }
        let [left, right] = sides;
        if left.is_empty() || right.is_empty() {
            return None;
        }
        let counts = [left.len(), right.len()];
        node.parts[..counts[0]].copy_from_slice(left);
        node.parts[counts[0]..][..counts[1]].copy_from_slice(right);
        Some(counts)
    }
}

/// What was grown, as a piece refers to it.
struct Subtree {
    child: NodeRef,
    bounds: Bounds,
    /// May it be part of a larger leaf? A copy of a mesh is one of its own.
    joins: bool,
}

impl Subtree {
    /// A leaf of all in two, if these are leaves and it costs no more: a pair costs a ray as much as a triangle, as
    /// [`Statistics`](crate::Statistics) counts. With a pair as three, Sibenik's diffuse rays visit 4 % fewer pairs and two
    /// thirds more triangles. Areas are those without the padding, which would make leaves of small flat triangles: Conference's shadow rays
    /// test 9 % more of them with twice the padding, and a GPU follows 6 % fewer a second.
    fn leaf(left: &Subtree, right: &Subtree) -> Option<Self> {
        let (bounds, all) = (left.bounds.union(right.bounds), left.child.count() + right.child.count());
        let area = |bounds: Bounds| half_area((bounds.extent() - 2.0 * BOX_PADDING).max(Vec3A::ZERO));
        let cost = |leaf: &Subtree| area(leaf.bounds) * leaf.child.count() as f32;
        let are_leaves = left.joins && right.joins && all <= MAX_LEAF;
        let pays = are_leaves && area(bounds) * (all as f32 - 1.0) <= cost(left) + cost(right);
        pays.then(|| Subtree { child: NodeRef::leaf(left.child.index(), all), bounds, joins: true })
    }
}

/// Puts whole parts into bins by their centres.
fn by_centre(bins: &mut [Bins; 3], grid: &Grid, parts: &[Part]) {
    for part in parts {
        let bounds = part.bounds();
        for (bins, bin) in bins.iter_mut().zip(grid.bins(bounds.centre())) {
            bins.put(bin, bounds);
        }
    }
}

/// To which sides a part goes that a plane crosses, given what is there: to both, cut, or whole to one.
/// `counts` counts each part that is not yet sorted on both sides.
fn goes(part: &Part, cut: &[Option<Part>; 2], boxes: &[Bounds; 2], counts: &[f32; 2], may_cut: bool) -> [bool; 2] {
    let cost = |left: Bounds, fewer_left: f32, right: Bounds, fewer_right: f32| {
        area(left) * (counts[0] - fewer_left) + area(right) * (counts[1] - fewer_right)
    };
    let left = cost(boxes[0].union(part.bounds()), 0.0, boxes[1], 1.0);
    let right = cost(boxes[0], 1.0, boxes[1].union(part.bounds()), 0.0);
    let both = match cut {
        [Some(a), Some(b)] if may_cut => cost(boxes[0].union(a.bounds()), 0.0, boxes[1].union(b.bounds()), 0.0),
        _ => f32::INFINITY,
    };
    match cut {
        [Some(_), None] => [true, false],
        [None, Some(_)] => [false, true],
        _ if both < left && both < right => [true; 2],
        _ => [left <= right, left > right],
    }
}

/// How much of the room the left side gets.
fn share(room: usize, (left, right): (&[Part], &[Part])) -> usize {
    if room == 0 {
        return 0;
    }
    let (one, other) = (many::total_area(left), many::total_area(right));
    ((room as f64 * one / (one + other)) as usize).min(room)
}

fn around(parts: &[Part]) -> Bounds {
    many::around(parts, Part::bounds)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn leaf(first: u32, x: f32) -> Subtree {
        Subtree { joins: true, child: NodeRef::leaf(first, 1), bounds: Bounds::new([x, 0.0, 0.0], [x + 1.0, 1.0, 1.0]) }
    }

    #[test]
    fn boxes_in_one_place_share_a_leaf_as_long_as_it_has_room() {
        let mut all = leaf(3, 0.0);
        for count in 2..=MAX_LEAF {
            all = Subtree::leaf(&all, &leaf(2 + count, 0.0)).unwrap();
            assert_eq!(all.child, NodeRef::leaf(3, count));
        }
        assert!(Subtree::leaf(&all, &leaf(8, 0.0)).is_none());
    }

    #[test]
    fn boxes_apart_keep_their_leaves() {
        assert!(Subtree::leaf(&leaf(0, 0.0), &leaf(1, 4.0)).is_none());
        let both = Subtree::leaf(&leaf(0, 8.0), &leaf(1, 8.1)).unwrap();
        assert_eq!(both.bounds, Bounds::new([8.0, 0.0, 0.0], [9.1, 1.0, 1.0]));
    }
}
