//! Of how many triangles each face of a file is made.

/// The numbers of triangles of faces, one after the other.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct FaceSizes {
    /// None as long as each is one triangle.
    sizes: Vec<u32>,
    triangles: usize,
}

impl FaceSizes {
    /// Adds a face; one of no triangle is none.
    pub fn push(&mut self, triangles: usize) {
        if triangles > 1 || !self.sizes.is_empty() && triangles > 0 {
            if self.sizes.is_empty() {
                self.sizes = vec![1; self.triangles];
            }
            self.sizes.push(triangles as u32);
        }
        self.triangles += triangles;
    }

    /// Adds those that end at these numbers of triangles in all.
    pub fn extend(&mut self, ends: impl Iterator<Item = usize>) {
        let mut before = 0;
        for end in ends {
            self.push(end - std::mem::replace(&mut before, end));
        }
    }

    /// None where each is one triangle.
    pub fn sizes(&self) -> &[u32] {
        &self.sizes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_alone_take_no_room_and_quads_among_them_are_told() {
        let mut sizes = FaceSizes::default();
        sizes.extend([1, 2, 3].into_iter());
        assert!(sizes.sizes().is_empty());
        sizes.extend([2, 2, 3].into_iter());
        sizes.push(1);
        assert_eq!(sizes.sizes(), [1, 1, 1, 2, 1, 1]);
    }
}
