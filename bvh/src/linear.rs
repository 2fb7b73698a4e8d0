//! Hierarchies along a Morton curve (Karras, Maximizing Parallelism in the Construction of BVHs, Octrees, and k-d Trees, 2012): soonest
//! built, and by a device, too; see [`eyerays_shader::linear`].

use eyerays_shader::data::{NodeRef, Primitive};
use eyerays_shader::linear::code;
use eyerays_shader::refit::Block;
use rayon::prelude::*;

use crate::{
    BuildError, Reference, References,
    bounds::Bounds,
    build::check_count,
    reference::check_coordinates,
    tree::{CHUNK, Children, filled},
};

/// References to whole primitives in the order of their codes, and a tree that splits them where their codes differ first.
///
/// # Errors
/// As [`split`](crate::split).
pub fn linear(primitives: &[Primitive]) -> Result<References, BuildError> {
    check(primitives)?;
    let coded = |(number, primitive): (usize, &Primitive)| {
        let (least, greatest) = primitive.bounds();
        (code(Block { least, greatest }), number as u32)
    };
    let mut coded: Vec<(u32, u32)> = primitives.par_iter().enumerate().map(coded).collect();
    coded.par_sort_unstable();
    let reference = |&(_, primitive): &(u32, u32)| Reference {
        primitive,
        bounds: Bounds::of(&primitives[primitive as usize]).write(),
    };
    let list = coded.par_iter().map(reference).collect();
    let mut pairs = filled([NodeRef::ROOT; 2], coded.len() - 1);
    grow(&mut pairs, 0, &coded, 0);
    Ok(References { list, pairs })
}

/// Checks what [`linear`] would refuse, for who builds elsewhere.
///
/// # Errors
/// As [`split`](crate::split).
pub fn check(primitives: &[Primitive]) -> Result<(), BuildError> {
    check_count(primitives.len())?;
    check_coordinates(primitives)
}

/// Grows the pairs of some slots, `first` the first, of which the first pair has a number: one fewer than there are slots, in depth-first
/// order.
fn grow(pairs: &mut [Children], number: u32, coded: &[(u32, u32)], first: u32) {
    let Some((pair, below)) = pairs.split_first_mut() else { return };
    let middle = middle(coded, first);
    let (left, right) = below.split_at_mut(middle - 1);
    let child = |count: usize, number: u32, first: u32| {
        if count == 1 { NodeRef::leaf(first, 1) } else { NodeRef::inner(number) }
    };
    let (next, second) = (number + middle as u32, first + middle as u32);
    *pair = [child(middle, number + 1, first), child(coded.len() - middle, next, second)];
    let (before, after) = coded.split_at(middle);
    if coded.len() > CHUNK {
        rayon::join(|| grow(left, number + 1, before, first), || grow(right, next, after, second));
    } else {
        grow(left, number + 1, before, first);
        grow(right, next, after, second);
    }
}

/// How many of sorted codes, two at least, come before the highest bit in which they differ is set, or that of their places.
fn middle(coded: &[(u32, u32)], first: u32) -> usize {
    let (low, high) = (coded[0].0, coded[coded.len() - 1].0);
    if low == high {
        let last = first + coded.len() as u32 - 1;
        let bit = 31 - (first ^ last).leading_zeros();
        return (((last >> bit) << bit) - first) as usize;
    }
    let bit = 31 - (low ^ high).leading_zeros();
    coded.partition_point(|&(code, _)| code >> bit & 1 == 0)
}

#[cfg(test)]
mod tests {
    use eyerays_shader::linear::below;
    use glam::Vec3;

    use super::*;
    use crate::{Quality, build};

    fn heap(count: u32, spread: f32) -> Vec<Primitive> {
        let mut rng = fastrand::Rng::with_seed(count.into());
        let mut place = |size: f32| Vec3::new(rng.f32() - 0.5, rng.f32() - 0.5, rng.f32() - 0.5) * size;
        (0..count)
            .map(|number| {
                let at = place(spread);
                Primitive::triangle([at, at + place(0.1), at + place(0.1)], number, 0, 0)
            })
            .collect()
    }

    #[test]
    fn trees_are_valid_and_split_where_a_device_splits() {
        for (count, spread) in [(1, 1.0), (2, 1.0), (3, 0.0), (100, 1.8), (5000, 0.001), (20_000, 1.8)] {
            let all = heap(count, spread);
            let references = linear(&all).unwrap();
            build(&references, Quality::Linear).unwrap();
            let code_of = |slot: u32| {
                let (least, greatest) = all[references.list[slot as usize].primitive as usize].bounds();
                code(Block { least, greatest })
            };
            let mut open = vec![(0, 0, 0, count)];
            while let Some((pair, node, first, end)) = open.pop() {
                if end - first < 2 {
                    continue;
                }
                let of = below(count, node, code_of);
                assert_eq!((of.first, of.end), (first, end));
                let [left, right] = references.pairs[pair as usize];
                let is = |child: NodeRef, first, end| {
                    if end - first == 1 { child == NodeRef::leaf(first, 1) } else { !child.is_leaf() }
                };
                assert!(is(left, first, of.middle) && is(right, of.middle, end));
                open.push((left.index(), of.middle - 1, first, of.middle));
                open.push((right.index(), of.middle, of.middle, end));
            }
        }
    }

    #[test]
    fn what_split_refuses_is_refused() {
        assert_eq!(linear(&[]).unwrap_err(), BuildError::NoPrimitives);
        let far = [Primitive::triangle([Vec3::splat(2.0); 3], 3, 0, 0)];
        assert_eq!(linear(&far).unwrap_err(), BuildError::Coordinate { primitive: 3 });
    }
}
