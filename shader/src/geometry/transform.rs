//! Where the parts of a scene go: one transform, by the same operations wherever it is done. A reader of files that moves a mesh
//! to the world gets the vertices that a kernel gets which moves a copy of it.
//!
//! Scaling by powers of two changes no bit but exponents, so the operations may be done in world units or in normalised ones.

use glam::Vec3;

use crate::real::{Real, Scalar, TINY, V3};

/// An affine map: rows of a matrix, and what is added.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// What a place is multiplied with for the first axis.
    pub x: Vec3,
    /// For the second.
    pub y: Vec3,
    /// For the third.
    pub z: Vec3,
    /// What is added then.
    pub translation: Vec3,
    /// The sign of the determinant: -1 in a mirror, else 1.
    pub side: f32,
}

/// A sum of products, from left to right.
#[inline(always)]
fn row(a: Vec3, p: Vec3) -> f32 {
    a.x * p.x + a.y * p.y + a.z * p.z
}

impl Transform {
    /// Nothing moves.
    pub const IDENTITY: Transform =
        Transform { x: Vec3::X, y: Vec3::Y, z: Vec3::Z, translation: Vec3::ZERO, side: 1.0 };

    /// One of these rows.
    #[cfg(not(target_arch = "spirv"))]
    pub fn new([x, y, z]: [Vec3; 3], translation: Vec3) -> Self {
        let [a, b, c] = [x, y, z].map(Vec3::as_dvec3);
        let side = if a.cross(b).dot(c) < 0.0 { -1.0 } else { 1.0 };
        Transform { x, y, z, translation, side }
    }

    /// A place.
    #[inline(always)]
    pub fn place(&self, p: Vec3) -> Vec3 {
        let Transform { x, y, z, translation, .. } = *self;
        Vec3::new(row(x, p) + translation.x, row(y, p) + translation.y, row(z, p) + translation.z)
    }

    /// The unit vector of a direction along a surface; a zero vector if it has none.
    #[inline(always)]
    pub fn direction(&self, d: Vec3) -> Vec3 {
        unit(Vec3::new(row(self.x, d), row(self.y, d), row(self.z, d)))
    }

    /// The unit normal of what has this normal before; a zero vector stays one. The cofactors are the inverse's transpose but for the
    /// determinant.
    #[inline(always)]
    pub fn normal(&self, n: Vec3) -> Vec3 {
        let [x, y, z] = self.cofactors();
        let side = self.side;
        unit(Vec3::new(row(x, n) * side, row(y, n) * side, row(z, n) * side))
    }

    /// What a box reaches around its moved middle, given half its extent.
    #[inline(always)]
    pub fn around(&self, half: Vec3) -> Vec3 {
        let size = |row: Vec3| Vec3::new(Real::abs(row.x), Real::abs(row.y), Real::abs(row.z));
        Vec3::new(row(size(self.x), half), row(size(self.y), half), row(size(self.z), half))
    }

    /// A vector turned by its rows alone, in another arithmetic: what a key says of a camera or a light.
    #[inline(always)]
    pub fn turned<R: Scalar>(&self, vector: V3<R>) -> V3<R> {
        let by = |row: Vec3| vector.dot(V3::splat(row)).flush(TINY);
        V3::new(by(self.x), by(self.y), by(self.z))
    }

    /// Rows of the matrix of cofactors.
    #[inline(always)]
    fn cofactors(&self) -> [Vec3; 3] {
        let Transform { x, y, z, .. } = *self;
        [cross(y, z), cross(z, x), cross(x, y)]
    }
}

/// The right-handed cross product.
#[inline(always)]
fn cross(a: Vec3, b: Vec3) -> Vec3 {
    Vec3::new(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
}

#[inline(always)]
fn unit(v: Vec3) -> Vec3 {
    let unit = V3::<f32>::new(v.x, v.y, v.z).normalised().0;
    Vec3::new(unit.x, unit.y, unit.z)
}
