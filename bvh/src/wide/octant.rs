//! Which child sits in which slot.
//!
//! A ray that visits slots in the order of their number XOR its octant should visit near children
//! before far ones. Bit 0 of a slot or an octant stands for x, bit 1 for y, bit 2 for z; in a slot it
//! is set on the side of the greater coordinate, in a ray's octant where the direction is negative.

use eyerays_shader::data::CwbvhNode;

use crate::bounds::Bounds;

const ARITY: usize = CwbvhNode::ARITY;

/// The child at each slot, as a place in `boxes`; at most eight. Leaves are in their order, so that a large leaf
/// of the pairs stays in one piece: a ray goes through the leaves of a node at once, whatever their slots.
///
/// Ylitie et al. 2017, section 3.2: slots are the octants' diagonals, and the sum of the distances that
/// children lie along the diagonals of their slots is to be as large as possible. They use an auction;
/// here each child is swapped with others for as long as that helps. (The order of two children depends only
/// on the highest bit in which their slots differ; a sum over pairs along that bit's axis models this
/// better, but on Conference and Sibenik rays visit as many nodes with it.)
pub(crate) fn slots(boxes: &[Bounds], is_leaf: impl Fn(usize) -> bool) -> [Option<usize>; ARITY] {
    let middle = Bounds::around(boxes.iter().copied()).centre();
    let along = |child: usize, slot: usize| -> f32 {
        let Some(b) = boxes.get(child) else { return 0.0 };
        let centre = b.centre();
        (0..3)
            .map(|axis| if slot >> axis & 1 == 1 { centre[axis] - middle[axis] } else { middle[axis] - centre[axis] })
            .sum()
    };
    let gains: [[f32; ARITY]; ARITY] = std::array::from_fn(|child| std::array::from_fn(|slot| along(child, slot)));
    let mut children: [usize; ARITY] = std::array::from_fn(|slot| slot);
    // Each swap raises the sum, so the loop ends by itself; the bound covers rounding.
    for _ in 0..PASSES {
        if !improve(&mut children, &gains) {
            break;
        }
    }
    let mut leaves = (0..boxes.len()).filter(|&child| is_leaf(child));
    children.map(|child| match child {
        nothing if nothing >= boxes.len() => None,
        leaf if is_leaf(leaf) => leaves.next(),
        inner => Some(inner),
    })
}

/// More passes than were ever seen to help.
const PASSES: usize = 16;

/// Swaps children where that raises the sum of gains. Returns whether there was such a pair.
fn improve(children: &mut [usize; ARITY], gains: &[[f32; ARITY]; ARITY]) -> bool {
    let mut improved = false;
    for a in 0..ARITY {
        for b in a + 1..ARITY {
            let (i, j) = (children[a], children[b]);
            if gains[j][a] + gains[i][b] > gains[i][a] + gains[j][b] {
                children.swap(a, b);
                improved = true;
            }
        }
    }
    improved
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(centre: [f32; 3]) -> Bounds {
        Bounds::new(centre.map(|c| c - 0.1), centre.map(|c| c + 0.1))
    }

    #[test]
    fn corners_of_a_cube_sit_in_their_octants() {
        for turn in 0..8usize {
            let corner = |i: usize| cube([0, 1, 2].map(|axis| ((i ^ turn) >> axis & 1) as f32));
            let boxes: Vec<Bounds> = (0..8).map(corner).collect();
            assert_eq!(slots(&boxes, |_| false), std::array::from_fn(|slot| Some(slot ^ turn)));
        }
    }

    #[test]
    fn two_children_are_met_in_order_by_rays_either_way() {
        let boxes = [cube([0.5, 0.3, 0.1]), cube([-0.5, 0.0, 0.0])];
        let slots = slots(&boxes, |_| false);
        let order = |octant: usize| -> Vec<usize> { (0..8).filter_map(|i| slots[i ^ octant]).collect() };
        assert_eq!(order(0b000), [1, 0]);
        assert_eq!(order(0b111), [0, 1]);
    }

    #[test]
    fn leaves_stay_in_order() {
        let boxes: Vec<Bounds> = [3.0, 1.0, -2.0, 2.0, -1.0].map(|x| cube([x, x, 0.0])).into();
        let is_leaf = |i| i != 2;
        let slots = slots(&boxes, is_leaf);
        let leaves: Vec<usize> = slots.into_iter().flatten().filter(|&i| is_leaf(i)).collect();
        assert_eq!(leaves, [0, 1, 3, 4]);
        assert_eq!(slots[0], Some(2), "least in every coordinate");
    }
}
