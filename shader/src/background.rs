//! What lies behind everything.

use crate::data::{Effects, Frame, numbers};
use crate::light::Environment;
use crate::real::{Scalar, V3};

/// The colour of a ray that hits nothing: constant, a gradient over the height of its direction, or of a picture. The camera may
/// see a constant in its place.
#[inline(always)]
pub fn background<R: Scalar>(
    effects: Effects,
    frame: &Frame,
    environment: &[u32],
    direction: V3<R>,
    is_of_camera: bool,
) -> V3<R> {
    if effects.has(Effects::ENVIRONMENT) {
        let environment = Environment::new(environment);
        if !is_of_camera || environment.is_visible() {
            return environment.radiance(direction);
        }
    }
    gradient(effects, frame, direction)
}

/// The same without a picture.
#[inline(always)]
pub fn gradient<R: Scalar>(effects: Effects, frame: &Frame, direction: V3<R>) -> V3<R> {
    let bottom = V3::splat(numbers(frame.horizon));
    if !effects.has(Effects::GRADIENT) {
        return bottom;
    }
    let height = direction.y.max(R::splat(0.0)).min(R::splat(1.0));
    bottom * (R::splat(1.0) - height) + V3::splat(numbers(frame.zenith)) * height
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::pack;
    use glam::Vec3;

    #[test]
    fn a_gradient_runs_from_the_horizon_up() {
        let frame = Frame { horizon: pack(Vec3::X, 0), zenith: pack(Vec3::Y, 0), ..Frame::default() };
        let seen = |y: f64, effects| background(Effects(effects), &frame, &[], V3::new(0.0, y, 0.0), true);
        let red = V3::splat(Vec3::X);
        assert_eq!(seen(-0.5, Effects::GRADIENT), red);
        assert_eq!(seen(0.25, Effects::GRADIENT), V3::new(0.75, 0.25, 0.0));
        assert_eq!(seen(1.0, 0), red);
    }
}
