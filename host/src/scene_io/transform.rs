//! Where a mesh goes: scaled, then turned about x, y and z, then moved.

use eyerays_shader::geometry;
use glam::{DMat3, DMat4, DVec3, Vec3};

use super::keys::Keys;
use super::table::Table;
use crate::error::Result;
use crate::math;
use crate::scene::Mesh;
use crate::scene::Range;
use crate::scene::normal::unit;

/// An affine map that can be undone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transform {
    linear: DMat3,
    translate: DVec3,
    /// By which it makes everything longer, if that is the same in all directions.
    factor: Option<f64>,
}

/// A transform in the arithmetic that kernels share.
pub fn exact(linear: &DMat3, translate: DVec3) -> geometry::Transform {
    let rows = linear.transpose();
    let rows = [rows.x_axis, rows.y_axis, rows.z_axis].map(|row| row.as_vec3());
    geometry::Transform::new(rows, translate.as_vec3())
}

impl Transform {
    /// Reads `scale`, `rotate` (degrees) and `translate` of a `[[mesh]]` table, all optional, and keys that say others over time. Returns
    /// what it is after so many seconds, and when its last key is.
    ///
    /// # Errors
    /// A number that is not finite, a scale of zero, or keys that make no sense.
    pub fn read(table: &mut Table, seconds: f64) -> Result<(Option<Transform>, Option<f32>)> {
        let scale = table.triple_or_number("scale", Range::FACTOR)?;
        let rotate = table.triple("rotate", Range::ANY)?;
        let translate = table.triple("translate", Range::ANY)?;
        let is_none = scale.is_none() && rotate.is_none() && translate.is_none();
        let own = [scale.unwrap_or(Vec3::ONE), rotate.unwrap_or(Vec3::ZERO), translate.unwrap_or(Vec3::ZERO)];
        let fields = [("scale", Range::FACTOR), ("rotate", Range::ANY), ("translate", Range::ANY)];
        let of = |[scale, rotate, translate]: [Vec3; 3]| Transform::new(scale, rotate, translate);
        match Keys::read(table, fields, own)? {
            Some(keys) => Ok((Some(of(keys.at(seconds))), Some(keys.last()))),
            None => Ok(((!is_none).then(|| of(own)), None)),
        }
    }

    /// Scales, then turns by `rotate` degrees about the fixed x, y and z axes in this order
    /// (counter-clockwise looking against the axis), then moves.
    pub fn new(scale: Vec3, rotate: Vec3, translate: Vec3) -> Self {
        let [x, y, z] = rotate.to_array().map(|angle| sin_cos(f64::from(angle)));
        let about_x = DMat3::from_cols(DVec3::X, DVec3::new(0.0, x.1, x.0), DVec3::new(0.0, -x.0, x.1));
        let about_y = DMat3::from_cols(DVec3::new(y.1, 0.0, -y.0), DVec3::Y, DVec3::new(y.0, 0.0, y.1));
        let about_z = DMat3::from_cols(DVec3::new(z.1, z.0, 0.0), DVec3::new(-z.0, z.1, 0.0), DVec3::Z);
        let (scale, sizes) = (scale.as_dvec3(), scale.as_dvec3().abs());
        Transform {
            linear: about_z * about_y * about_x * DMat3::from_diagonal(scale),
            translate: translate.as_dvec3(),
            factor: (sizes.x == sizes.y && sizes.y == sizes.z).then_some(sizes.x),
        }
    }

    /// What leaves everything where it is.
    pub const NONE: Transform = Transform { linear: DMat3::IDENTITY, translate: DVec3::ZERO, factor: Some(1.0) };

    /// Another one, and then this one.
    #[must_use]
    pub fn after(&self, first: &Transform) -> Transform {
        Transform {
            linear: self.linear * first.linear,
            translate: self.linear * first.translate + self.translate,
            factor: self.factor.zip(first.factor).map(|(a, b)| a * b),
        }
    }

    /// Does a sphere stay one? It does in a mirror.
    pub fn keeps_spheres(&self) -> bool {
        self.factor.is_some()
    }

    /// A place.
    pub fn place(&self, position: Vec3) -> Vec3 {
        (self.linear * position.as_dvec3() + self.translate).as_vec3()
    }

    /// Both parts as one.
    pub fn matrix(&self) -> DMat4 {
        DMat4::from_translation(self.translate) * DMat4::from_mat3(self.linear)
    }

    /// A length in a transform that keeps spheres.
    pub fn length(&self, length: f32) -> f32 {
        (f64::from(length) * self.factor.unwrap_or(1.0)) as f32
    }

    /// A unit normal in a transform that keeps spheres; in a mirror the front stays the front.
    pub fn normal(&self, normal: Vec3) -> Vec3 {
        unit(self.linear * normal.as_dvec3())
    }

    /// Moves a mesh. A mirror turns the triangles around, so that their fronts stay outside.
    pub fn apply(&self, mesh: &mut Mesh) {
        mesh.moved(&exact(&self.linear, self.translate));
    }
}

/// Sine and cosine of degrees, exact for whole quarter turns: walls stay flat.
fn sin_cos(degrees: f64) -> (f64, f64) {
    let turn = degrees.rem_euclid(360.0);
    match turn {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        _ => math::sin_cos(turn.to_radians()),
    }
}
