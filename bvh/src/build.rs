//! From triangles to a hierarchy.

use eyerays_shader::data::{MAX_LEAF, NodePair, NodeRef, Triangle};

use crate::{
    BuildError, MAX_DEPTH, Quality, bounds::Bounds, cluster::Clusters, layout, search, topology::Topology, validate,
};

/// A validated hierarchy.
#[derive(Clone, Debug, PartialEq)]
pub struct Bvh {
    /// The node pairs, the root's first, then in depth-first order.
    pub nodes: Vec<NodePair>,
    /// The triangle at each slot that a leaf counts, as an index into the triangles given.
    pub order: Vec<u32>,
}

impl Bvh {
    /// Sorts what belongs to the triangles, or the triangles themselves, into the order of slots.
    ///
    /// # Panics
    ///
    /// If there are fewer items than triangles.
    pub fn gather<T: Copy>(&self, items: &[T]) -> Vec<T> {
        self.order.iter().map(|&i| items[i as usize]).collect()
    }
}

/// Builds the hierarchy of triangles in the normalised scene.
///
/// The same triangles give the same hierarchy, whatever the number of rayon's threads. Every box
/// contains exactly what is below it, no leaf has more than [`MAX_LEAF`] triangles, and no path has
/// more than [`MAX_DEPTH`] pairs.
///
/// # Errors
///
/// [`BuildError::NoTriangles`], [`BuildError::TooManyTriangles`], and [`BuildError::Coordinate`] if
/// a vertex is not finite and in [-1, 1]. Any other error is a defect of the builder that its
/// validation found.
pub fn build(triangles: &[Triangle], quality: Quality) -> Result<Bvh, BuildError> {
    let count = check_count(triangles.len())?;
    check_coordinates(triangles)?;
    let bounds: Vec<Bounds> = triangles.iter().map(Bounds::of).collect();
    let bvh = match bounds[..] {
        [only] => Bvh { nodes: vec![layout::single(only)], order: vec![0] },
        _ => {
            let mut topology = topology(&bounds, count, quality);
            topology.limit_depth(MAX_DEPTH);
            Bvh { nodes: layout::pairs(&mut topology, &bounds), order: topology.order }
        }
    };
    validate::order(&bvh.order, triangles.len())?;
    validate::nodes(&bvh.nodes, triangles.len(), |slot| bounds[bvh.order[slot as usize] as usize])?;
    Ok(bvh)
}

/// The tree before its depth is limited.
fn topology(bounds: &[Bounds], count: u32, quality: Quality) -> Topology {
    if count <= MAX_LEAF {
        return Topology::run(count);
    }
    let clusters = Clusters::of(bounds);
    let primitives: Vec<Bounds> = (0..clusters.len() as u32)
        .map(|group| {
            let members = clusters.members(group).iter();
            Bounds::around(members.map(|&t| bounds[t as usize]))
        })
        .collect();
    let tree = search::search(&primitives, &quality.parameters());
    Topology::of(&tree, &clusters)
}

/// A number of triangles that references can count.
fn check_count(count: usize) -> Result<u32, BuildError> {
    match u32::try_from(count) {
        Ok(0) => Err(BuildError::NoTriangles),
        Ok(fits) if fits <= NodeRef::MAX_INDEX => Ok(fits),
        _ => Err(BuildError::TooManyTriangles { count }),
    }
}

/// obvhs must not see a NaN, nor areas that overflow.
fn check_coordinates(triangles: &[Triangle]) -> Result<(), BuildError> {
    let normalised = |t: &Triangle| {
        let coordinates = t.vertices().map(|v| v.to_array());
        coordinates.as_flattened().iter().all(|c| c.abs() <= 1.0)
    };
    match triangles.iter().find(|t| !normalised(t)) {
        Some(t) => Err(BuildError::Coordinate { primitive: t.primitive() }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_limited_by_what_a_reference_holds() {
        let most = NodeRef::MAX_INDEX as usize;
        assert_eq!(check_count(most), Ok(NodeRef::MAX_INDEX));
        assert_eq!(check_count(0), Err(BuildError::NoTriangles));
        for count in [most + 1, 1 << 33] {
            let error = check_count(count).unwrap_err();
            assert_eq!(error, BuildError::TooManyTriangles { count });
            let message = error.to_string();
            assert!(message.contains(&count.to_string()) && message.contains("536870911"));
        }
    }
}
