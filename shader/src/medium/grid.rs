//! Media that are denser in one place than in another: numbers at the corners of cells, in blocks that know the greatest of theirs.

use crate::buffer::read;
use crate::data::{CELLS, GlowTable, Grid, Medium};
use crate::real::{FAINT, Real, SMALL, Scalar, TINY, V3};

/// A ray in a grid's own coordinates, whose cells have edges of 1: the same distances along it as in the scene.
#[derive(Clone, Copy)]
pub struct GridRay<R: Real> {
    origin: V3<R>,
    direction: V3<R>,
    /// One over the direction; huge where that is zero.
    inverse: V3<R>,
}

impl<R: Scalar> GridRay<R> {
    /// That of a ray in the normalised scene.
    #[inline(always)]
    pub fn new(grids: &[u32], at: u32, origin: V3<R>, direction: V3<R>) -> Self {
        let first = at + Grid::TRANSFORM;
        let rows = [row::<R>(grids, first), row::<R>(grids, first + 4), row::<R>(grids, first + 8)];
        let moved = V3::new(number(grids, first + 3), number(grids, first + 7), number(grids, first + 11));
        let origin = (turned(rows, origin) + moved).map(|c| c.flush(TINY));
        let direction = turned(rows, direction);
        let inverse = direction.map(|c| {
            let is_none = c.abs().lt(R::splat(SMALL));
            R::select(is_none, R::splat(SMALL), c).reciprocal()
        });
        GridRay { origin, direction, inverse }
    }

    /// Where it is after a distance.
    #[inline(always)]
    pub fn at(&self, distance: R) -> V3<R> {
        (self.origin + self.direction * distance).map(|c| c.flush(TINY))
    }

    /// Where it enters a grid and where it leaves it; the latter is before the former if it misses it.
    #[inline(always)]
    pub fn within(&self, grids: &[u32], at: u32) -> (R, R) {
        let inset: R = number(grids, at + Grid::INSET);
        let cells = at + Grid::CELLS;
        let [x, y, z] = [read(grids, cells), read(grids, cells + 1), read(grids, cells + 2)];
        let slab = |origin: R, inverse: R, far: R| {
            let (a, b) = ((inset - origin) * inverse, (far - origin) * inverse);
            (a.min(b), a.max(b))
        };
        let far = |cells: u32| R::splat(cells as f32) - inset;
        let x = slab(self.origin.x, self.inverse.x, far(x));
        let y = slab(self.origin.y, self.inverse.y, far(y));
        let z = slab(self.origin.z, self.inverse.z, far(z));
        (x.0.max(y.0).max(z.0), x.1.min(y.1).min(z.1))
    }

    /// The block that it is in at a distance between entering the grid and leaving it.
    #[inline(always)]
    pub fn block(&self, grids: &[u32], at: u32, distance: R) -> Block {
        let place = self.at(distance);
        let blocks = at + Grid::BLOCKS;
        let [x, y, z] = [read(grids, blocks), read(grids, blocks + 1), read(grids, blocks + 2)];
        let along = |place: R, direction: R, count: u32| {
            let last = count as i32 - 1;
            let place = place * R::splat(const { 1.0 / CELLS as f32 });
            // On a face it is in the block that it goes on into.
            let whole = place.floor_index();
            let on_face = R::splat(whole as f32).eq(place) && direction.lt(R::splat(0.0));
            (if on_face { whole - 1 } else { whole }).max(0).min(last)
        };
        Block {
            x: along(place.x, self.direction.x, x),
            y: along(place.y, self.direction.y, y),
            z: along(place.z, self.direction.z, z),
        }
    }

    /// How far it goes until it leaves a block that it is in, and the block after that.
    #[inline(always)]
    pub fn leaves(&self, block: Block) -> (R, Block) {
        let face = |index: i32, direction: R, origin: R, inverse: R| {
            let is_back = direction.lt(R::splat(0.0));
            let next = if is_back { index } else { index + 1 } * CELLS as i32;
            let goes = R::splat(SMALL).le(direction.abs());
            R::select(goes, (R::splat(next as f32) - origin) * inverse, R::splat(f32::MAX))
        };
        let x = face(block.x, self.direction.x, self.origin.x, self.inverse.x);
        let y = face(block.y, self.direction.y, self.origin.y, self.inverse.y);
        let z = face(block.z, self.direction.z, self.origin.z, self.inverse.z);
        let step = |index: i32, direction: R, steps: bool| {
            let one = if direction.lt(R::splat(0.0)) { -1 } else { 1 };
            if steps { index + one } else { index }
        };
        let first = x.min(y).min(z);
        let next = Block {
            x: step(block.x, self.direction.x, x.le(first)),
            y: step(block.y, self.direction.y, y.le(first)),
            z: step(block.z, self.direction.z, z.le(first)),
        };
        (first, next)
    }
}

/// What the temperature of a place of the normalised scene multiplies the light of a medium with, linear RGB; nothing outside of its grid.
#[inline(always)]
pub fn glow<R: Scalar>(medium: &Medium, grids: &[u32], place: V3<R>) -> V3<R> {
    let (at, table, zero) = (medium.density.y, medium.density.z, R::splat(0.0));
    let ray = GridRay::new(grids, at, place, V3::zero());
    let (enter, leave) = ray.within(grids, at);
    if !enter.le(zero) || !zero.le(leave) {
        return V3::zero();
    }
    let temperature = ray.block(grids, at, zero).number::<R>(grids, at, ray.at(zero));
    let step = (temperature * number(grids, table)).min(R::splat((GlowTable::TEMPERATURES - 1) as f32));
    let before = step.floor_index().min(GlowTable::TEMPERATURES as i32 - 2);
    let first = table + 1 + 3 * before as u32;
    let (low, high) = (row::<R>(grids, first), row(grids, first + 3));
    low.mix(high, (step - R::splat(before as f32)).flush(SMALL)).map(|c| c.flush(FAINT))
}

// Functions and no closures: rust-gpu would keep the buffer that these refer to in memory.
#[inline(always)]
fn number<R: Scalar>(grids: &[u32], at: u32) -> R {
    R::splat(f32::from_bits(read(grids, at)))
}

#[inline(always)]
fn row<R: Scalar>(grids: &[u32], at: u32) -> V3<R> {
    V3::new(number(grids, at), number(grids, at + 1), number(grids, at + 2))
}

/// A vector by the rows of a matrix.
#[inline(always)]
fn turned<R: Scalar>([x, y, z]: [V3<R>; 3], v: V3<R>) -> V3<R> {
    let v = v.map(|c| c.flush(TINY));
    V3::new(x.dot(v), y.dot(v), z.dot(v)).map(|c| c.flush(TINY))
}

/// Between two numbers.
#[inline(always)]
fn mix<R: Scalar>(a: R, b: R, share: R) -> R {
    a + ((b - a) * share).flush(FAINT)
}

/// Between two numbers that lie beside each other.
#[inline(always)]
fn mixed<R: Scalar>(grids: &[u32], at: u32, share: R) -> R {
    mix(number(grids, at), number(grids, at + 1), share)
}

/// A cube of [`CELLS`] cells along each edge, by its place among all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Block {
    x: i32,
    y: i32,
    z: i32,
}

impl Block {
    /// Does the grid have it?
    #[inline(always)]
    pub fn is_in(self, grids: &[u32], at: u32) -> bool {
        let blocks = at + Grid::BLOCKS;
        let within = |index: i32, count: u32| (index >= 0) & (index < count as i32);
        within(self.x, read(grids, blocks))
            & within(self.y, read(grids, blocks + 1))
            & within(self.z, read(grids, blocks + 2))
    }

    /// The place of its record.
    #[inline(always)]
    fn record(self, grids: &[u32], at: u32) -> u32 {
        let [width, height] = [read(grids, at + Grid::BLOCKS), read(grids, at + Grid::BLOCKS + 1)];
        at + Grid::RECORDS + 2 * ((self.z as u32 * height + self.y as u32) * width + self.x as u32)
    }

    /// The greatest number in it.
    #[inline(always)]
    pub fn greatest(self, grids: &[u32], at: u32) -> f32 {
        f32::from_bits(read(grids, self.record(grids, at)))
    }

    /// The number at a place in it, in between as straight lines along each axis have it, at most the greatest.
    #[inline(always)]
    pub fn number<R: Scalar>(self, grids: &[u32], at: u32, place: V3<R>) -> R {
        let record = self.record(grids, at);
        let greatest = R::splat(f32::from_bits(read(grids, record)));
        let voxels = read(grids, record + 1);
        if voxels == Grid::EVEN {
            return greatest;
        }
        let along = |place: R, block: i32| {
            let within = (place - R::splat((block * CELLS as i32) as f32)).max(R::splat(0.0));
            let cell = within.floor_index().min(CELLS as i32 - 1);
            (cell as u32, (within - R::splat(cell as f32)).min(R::splat(1.0)).flush(SMALL))
        };
        let (x, u) = along(place.x, self.x);
        let (y, v) = along(place.y, self.y);
        let (z, w) = along(place.z, self.z);
        const EDGE: u32 = CELLS + 1;
        let first = at + voxels + (z * EDGE + y) * EDGE + x;
        let second = first + EDGE * EDGE;
        let near = mix(mixed(grids, first, u), mixed(grids, first + EDGE, u), v);
        let far = mix(mixed(grids, second, u), mixed(grids, second + EDGE, u), v);
        mix(near, far, w).max(R::splat(0.0)).min(greatest)
    }
}
