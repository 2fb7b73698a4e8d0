//! Numbers in space: how dense a medium is, or how hot, where.

use std::collections::BTreeMap;

use glam::{DAffine3, DVec3, IVec3};

use super::{Range, Unplaced};

/// Voxels along an edge of a leaf.
pub const LEAF: i32 = 8;

/// Numbers at voxels, of which most may be the same: those of a leaf are kept together, and a leaf that is not there is background. In
/// between they are as straight lines along each axis have it.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Where it came from, for messages.
    pub name: String,
    /// Leaves by their place: a voxel's, divided by [`LEAF`] and rounded down.
    pub leaves: BTreeMap<[i32; 3], Leaf>,
    /// The number of all other voxels; at least 0.
    pub background: f32,
    /// The first voxel along each axis, and the one after the last. Outside there is nothing, whatever the background.
    pub extent: [[i32; 3]; 2],
    /// Takes voxels to world units.
    pub placement: DAffine3,
    /// Does it end half a voxel beyond the outermost, which go on until there? Else it fades to the background, a voxel beyond.
    pub has_edges: bool,
}

/// What the numbers of a grid are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// What coefficients are multiplied with.
    Density,
    /// In units of a [`Temperature`](super::Temperature).
    Temperature,
}

impl Quantity {
    /// The key of scene files, and the name that such a grid has in other files by convention.
    pub fn name(self) -> &'static str {
        match self {
            Quantity::Density => "density",
            Quantity::Temperature => "temperature",
        }
    }

    /// What several of its numbers are called.
    fn plural(self) -> &'static str {
        match self {
            Quantity::Density => "densities",
            Quantity::Temperature => "temperatures",
        }
    }
}

/// Numbers of 8 x 8 x 8 voxels, x first.
#[derive(Debug, Clone, PartialEq)]
pub enum Leaf {
    /// All the same.
    Even(f32),
    /// One each.
    Voxels(Box<[f32; 512]>),
}

impl Grid {
    /// Numbers in so many equal cells of a box along the axes, x first.
    ///
    /// # Panics
    /// There are not as many as cells.
    pub fn dense(name: &str, size: [u32; 3], numbers: &[f32], [min, max]: [DVec3; 2]) -> Grid {
        let [width, height, depth] = size.map(|count| count as usize);
        assert_eq!(numbers.len(), width * height * depth, "a number for each cell");
        let number = |[x, y, z]: [i32; 3]| {
            let inside = (x as usize) < width && (y as usize) < height && (z as usize) < depth;
            if inside { numbers[(z as usize * height + y as usize) * width + x as usize] } else { 0.0 }
        };
        let mut leaves = BTreeMap::new();
        let last = size.map(|count| (count as i32 + LEAF - 1) / LEAF);
        for (z, y, x) in (0..last[2]).flat_map(|z| (0..last[1]).flat_map(move |y| (0..last[0]).map(move |x| (z, y, x))))
        {
            let place = [x, y, z];
            let leaf = Leaf::of(|voxel| number(std::array::from_fn(|axis| LEAF * place[axis] + voxel[axis])));
            if leaf != Leaf::Even(0.0) {
                leaves.insert(place, leaf);
            }
        }
        let cell = (max - min) / DVec3::from(size.map(f64::from));
        Grid {
            name: name.to_owned(),
            leaves,
            background: 0.0,
            extent: [[0; 3], size.map(|count| count as i32)],
            placement: DAffine3::from_scale_rotation_translation(cell, Default::default(), min + 0.5 * cell),
            has_edges: true,
        }
    }

    /// The largest coordinate of a voxel: so many are counted exactly in single precision.
    const FARTHEST: i32 = 1 << 22;

    /// Refuses a grid without voxels, with those too far away, of no size, or with numbers below nothing.
    pub(crate) fn check(&self, of: Quantity) -> Unplaced<()> {
        let [first, end] = self.extent;
        if self.size().iter().any(|&voxels| voxels <= 0) {
            return Err("the grid is empty; is it the right one?".to_owned());
        }
        if first.iter().chain(&end).any(|at| at.unsigned_abs() > Self::FARTHEST as u32) {
            return Err(format!("the grid has voxels beyond {}; move them to the origin", Self::FARTHEST));
        }
        if let Some(odd) = self.numbers().find(|&number| !Range::AMOUNT.holds(number)) {
            return Err(format!("the grid has the number {odd}; {} are finite and at least 0", of.plural()));
        }
        if !self.placement.is_finite() || self.placement.matrix3.determinant() == 0.0 {
            return Err("the grid's voxels have no size; give it another transform".to_owned());
        }
        Ok(())
    }

    /// All that it has.
    fn numbers(&self) -> impl Iterator<Item = f32> {
        self.leaves.values().flat_map(|leaf| leaf.numbers()).chain([&self.background]).copied()
    }

    /// The greatest number that it has.
    pub fn greatest(&self) -> f32 {
        self.numbers().fold(0.0, f32::max)
    }

    /// The number of a voxel.
    pub fn number(&self, voxel: [i32; 3]) -> f32 {
        match self.leaves.get(&voxel.map(|at| at.div_euclid(LEAF))) {
            Some(Leaf::Even(number)) => *number,
            Some(Leaf::Voxels(numbers)) => {
                let [x, y, z] = voxel.map(|at| at.rem_euclid(LEAF) as usize);
                numbers[(z * 8 + y) * 8 + x]
            }
            None => self.background,
        }
    }

    /// How many voxels it spans along each axis.
    pub fn size(&self) -> [i64; 3] {
        let [first, end] = self.extent;
        std::array::from_fn(|axis| i64::from(end[axis]) - i64::from(first[axis]))
    }

    /// A box along the axes around all of it, in world units.
    pub fn bounds(&self) -> [DVec3; 2] {
        let [first, end] = self.extent.map(IVec3::from_array).map(|corner| corner.as_dvec3());
        let beyond = if self.has_edges { 0.5 } else { 1.0 };
        let (low, high) = (first - beyond, end - 1.0 + beyond);
        let corner = |bits: u32| {
            let pick = |axis: usize| if bits >> axis & 1 == 0 { low[axis] } else { high[axis] };
            self.placement.transform_point3(DVec3::new(pick(0), pick(1), pick(2)))
        };
        let around = |[min, max]: [DVec3; 2], corner: DVec3| [min.min(corner), max.max(corner)];
        (1..8).map(corner).fold([corner(0); 2], around)
    }

    /// The same, moved and stretched along the axes into a box.
    #[must_use]
    pub fn fitted(mut self, [min, max]: [DVec3; 2]) -> Grid {
        let [own_min, own_max] = self.bounds();
        let scale = (max - min) / (own_max - own_min);
        let fit = DAffine3::from_scale(scale);
        let moved = DAffine3::from_translation(min - fit.transform_point3(own_min));
        self.placement = moved * fit * self.placement;
        self
    }
}

impl Leaf {
    /// That of the numbers of voxels.
    pub fn of(number: impl Fn([i32; 3]) -> f32) -> Leaf {
        let mut numbers = Box::new([0.0f32; 512]);
        for (index, own) in numbers.iter_mut().enumerate() {
            let index = index as i32;
            *own = number([index % 8, index / 8 % 8, index / 64]);
        }
        let first = numbers[0];
        if numbers.iter().all(|own| own.to_bits() == first.to_bits()) {
            Leaf::Even(first)
        } else {
            Leaf::Voxels(numbers)
        }
    }

    /// All its numbers, or the one.
    pub fn numbers(&self) -> &[f32] {
        match self {
            Leaf::Even(number) => std::slice::from_ref(number),
            Leaf::Voxels(numbers) => &numbers[..],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dense_grid_has_its_numbers_where_its_cells_are() {
        let size = [9u32, 3, 20];
        let numbers: Vec<f32> = (0..9 * 3 * 20).map(|i| i as f32).collect();
        let grid = Grid::dense("g", size, &numbers, [DVec3::splat(-1.0), DVec3::new(8.0, 5.0, 9.0)]);
        for (x, y, z) in [(0, 0, 0), (8, 2, 19), (7, 1, 8), (8, 0, 16)] {
            assert_eq!(grid.number([x, y, z]), ((z * 3 + y) * 9 + x) as f32);
        }
        assert_eq!(grid.number([9, 0, 0]), 0.0);
        assert_eq!(grid.number([-1, 0, 0]), 0.0);
        assert_eq!(grid.placement.transform_point3(DVec3::ZERO), DVec3::new(-0.5, 0.0, -0.75));
        assert_eq!(grid.bounds(), [DVec3::splat(-1.0), DVec3::new(8.0, 5.0, 9.0)]);
        let fitted = grid.fitted([DVec3::ZERO, DVec3::ONE]);
        assert!(fitted.bounds()[0].length() < 1e-12 && (fitted.bounds()[1] - DVec3::ONE).length() < 1e-12);
    }
}
