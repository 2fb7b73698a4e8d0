//! The tree from the root down.

use eyerays_shader::data::{MAX_LEAF, Primitive};

use super::{
    bins::{Objects, Split, area, through},
    part::Part,
    tree::Branch,
};
use crate::bounds::Bounds;

/// Planes through triangles are tried where the children of the best plane between them overlap by more
/// than this share of the scene's surface area (Stich et al.: 1e-5, which on Conference and Sibenik makes
/// three times the references and saves no visits).
const OVERLAP: f32 = 1e-4;
/// Levels after which the rest is split at medians.
const LEVELS: u32 = 56;
/// From this many parts on, two threads grow a node's children.
const MANY: usize = 2048;

/// Grows a tree over parts; splits may add `room` parts.
pub(super) fn grow(triangles: &[Primitive], parts: Vec<Part>, room: usize) -> Branch {
    let scene = area(around(&parts));
    Grower { triangles, least_overlap: OVERLAP * scene }.branch(parts, room, 0)
}

struct Grower<'a> {
    triangles: &'a [Primitive],
    /// The least area of overlap for which a plane through triangles is tried.
    least_overlap: f32,
}

impl Grower<'_> {
    /// A node of at least one part.
    fn branch(&self, parts: Vec<Part>, room: usize, level: u32) -> Branch {
        if parts.len() == 1 || level == LEVELS {
            return Branch::Leaf(parts);
        }
        let count = parts.len();
        let [left, right] = self.children(parts, room);
        let room = room - (left.len() + right.len() - count);
        let (one, other) = share(room, &left, &right);
        let left = || self.branch(left, one, level + 1);
        let right = || self.branch(right, other, level + 1);
        let (left, right) = if count < MANY { (left(), right()) } else { rayon::join(left, right) };
        Branch::Inner(Box::new([left, right]))
    }

    /// Splits a node in two, neither of which is empty.
    fn children(&self, mut parts: Vec<Part>, room: usize) -> [Vec<Part>; 2] {
        let objects = Objects::of(&parts);
        let between = objects.cheapest(&parts);
        if room > 0
            && let Some(children) = self.through(&parts, room, between)
        {
            return children;
        }
        let Some(split) = between else {
            let half = parts.split_off(parts.len() / 2);
            return [parts, half];
        };
        let (left, right) = parts.into_iter().partition(|part| objects.is_left(&split, part));
        [left, right]
    }

    /// Cuts parts at a plane, if that is cheaper than `between` them, and cheaper than a leaf.
    fn through(&self, parts: &[Part], room: usize, between: Option<Split>) -> Option<[Vec<Part>; 2]> {
        if between.is_some_and(|split| area(split.children[0].intersection(split.children[1])) <= self.least_overlap) {
            return None;
        }
        let bounds = around(parts);
        let (split, plane) = through(self.triangles, parts, bounds)?;
        let leaf = area(bounds) * parts.len() as f32;
        let pays = parts.len() >= MAX_LEAF as usize || split.cost + area(bounds) < leaf;
        if !pays || between.is_some_and(|between| between.cost <= split.cost) {
            return None;
        }
        let children = self.cut(parts, room, split.axis, plane);
        children.iter().all(|child| !child.is_empty()).then_some(children)
    }

    /// Sorts parts to the sides of a plane. Those that it crosses are cut, unless it costs less to keep
    /// them whole on one side, or there is no room.
    fn cut(&self, parts: &[Part], mut room: usize, axis: usize, plane: f32) -> [Vec<Part>; 2] {
        let (mut sides, mut met) = ([Vec::new(), Vec::new()], Vec::new());
        for &part in parts {
            match (part.bounds.max[axis] <= plane, part.bounds.min[axis] >= plane) {
                (true, _) => sides[0].push(part),
                (_, true) => sides[1].push(part),
                _ => met.push(part),
            }
        }
        let mut boxes = [around(&sides[0]), around(&sides[1])];
        let mut counts = [0, 1].map(|side| (sides[side].len() + met.len()) as f32);
        for part in met {
            let cut = part.cut(&self.triangles[part.triangle as usize], axis, plane);
            let goes = goes(&part, &cut, &boxes, &counts, room > 0);
            room -= usize::from(goes == [true; 2]);
            for side in 0..2 {
                let whole = goes != [true; 2];
                match cut[side].filter(|_| !whole).or((whole && goes[side]).then_some(part)) {
                    Some(part) => {
                        boxes[side] = boxes[side].union(part.bounds);
                        sides[side].push(part);
                    }
                    None => counts[side] -= 1.0,
                }
            }
        }
        sides
    }
}

/// To which sides a part goes that a plane crosses, given what is there: to both, cut, or whole to one.
/// `counts` counts each part that is not yet sorted on both sides.
fn goes(part: &Part, cut: &[Option<Part>; 2], boxes: &[Bounds; 2], counts: &[f32; 2], may_cut: bool) -> [bool; 2] {
    let cost = |left: Bounds, fewer_left: f32, right: Bounds, fewer_right: f32| {
        area(left) * (counts[0] - fewer_left) + area(right) * (counts[1] - fewer_right)
    };
    let left = cost(boxes[0].union(part.bounds), 0.0, boxes[1], 1.0);
    let right = cost(boxes[0], 1.0, boxes[1].union(part.bounds), 0.0);
    let both = match cut {
        [Some(a), Some(b)] if may_cut => cost(boxes[0].union(a.bounds), 0.0, boxes[1].union(b.bounds), 0.0),
        _ => f32::INFINITY,
    };
    match cut {
        [Some(_), None] => [true, false],
        [None, Some(_)] => [false, true],
        _ if both < left && both < right => [true; 2],
        _ => [left <= right, left > right],
    }
}

/// How much room either side gets: in proportion to the area of its parts, since large ones are split.
fn share(room: usize, left: &[Part], right: &[Part]) -> (usize, usize) {
    if room == 0 {
        return (0, 0);
    }
    let sum = |parts: &[Part]| parts.iter().map(|part| f64::from(area(part.bounds))).sum::<f64>();
    let (one, other) = (sum(left), sum(right));
    let one = ((room as f64 * one / (one + other)) as usize).min(room);
    (one, room - one)
}

fn around(parts: &[Part]) -> Bounds {
    Bounds::around(parts.iter().map(|part| part.bounds))
}
