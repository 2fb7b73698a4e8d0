//! How a camera is moved by hand: around what it looks at, beside it, towards it, through the scene, and back until all is seen.

use eyerays::scene::{Camera, Projection};
use glam::{DQuat, DVec2, DVec3};

/// How near to straight up or down a camera may look, in radians: its `up` must not lie along its view.
const STEEPEST: f64 = 1e-3;

/// The axes of a camera's image, of unit length: to the right, up, and along the view.
fn axes(camera: &Camera) -> [DVec3; 3] {
    let forward = towards(camera).normalize_or(DVec3::NEG_Z);
    let right = forward.cross(camera.up.as_dvec3()).normalize_or(forward.any_orthonormal_vector());
    [right, right.cross(forward), forward]
}

/// From the eye to what it looks at.
fn towards(camera: &Camera) -> DVec3 {
    camera.target.as_dvec3() - camera.eye.as_dvec3()
}

/// A vector turned around the camera's `up` and then up or down, but not over the top.
fn turned(camera: &Camera, vector: DVec3, DVec2 { x: around, y: down }: DVec2) -> DVec3 {
    let up = camera.up.as_dvec3().normalize_or(DVec3::Y);
    let around = DQuat::from_axis_angle(up, around);
    let [right, ..] = axes(camera);
    let steep = vector.angle_between(up);
    // A turn by a positive angle around the right brings the vector nearer to `up`.
    let down = (steep + down).clamp(STEEPEST, std::f64::consts::PI - STEEPEST) - steep;
    around * (DQuat::from_axis_angle(right, -down) * vector)
}

/// Moves the eye around what it looks at, by these angles in radians to the right and down as the picture goes: dragging to the right
/// turns the scene to the right.
pub fn orbit(camera: &mut Camera, by: DVec2) {
    let view = turned(camera, towards(camera), DVec2::new(-by.x, by.y));
    let target = camera.target.as_dvec3();
    stand(camera, target - view, target);
}

/// Turns the view around the eye, by these angles in radians: looking to the right and down.
pub fn look(camera: &mut Camera, by: DVec2) {
    let view = turned(camera, towards(camera), DVec2::new(-by.x, by.y));
    let eye = camera.eye.as_dvec3();
    stand(camera, eye, eye + view);
}

/// Moves the camera so that what is as far away as what it looks at goes by these shares of the picture's height, to the right and
/// down.
pub fn pan(camera: &mut Camera, by: DVec2) {
    let [right, up, _] = axes(camera);
    let shift = (up * by.y - right * by.x) * height(camera);
    shift_by(camera, shift);
}

/// The height of what is seen where the camera looks, in world units; for cameras that see all around, the distance.
pub fn height(camera: &Camera) -> f64 {
    match camera.projection {
        Projection::Perspective { fov } => 2.0 * (f64::from(fov) / 2.0).to_radians().tan() * towards(camera).length(),
        Projection::Orthographic { height } => height.into(),
        Projection::Equirectangular | Projection::Fisheye { .. } => towards(camera).length(),
    }
}

/// Moves the eye nearer to what it looks at: its distance is divided by e to this power. Where rays are parallel, the picture's height
/// is.
pub fn dolly(camera: &mut Camera, by: f64) {
    let factor = (-by.clamp(-4.0, 4.0)).exp();
    if let Projection::Orthographic { height } = &mut camera.projection {
        *height = (f64::from(*height) * factor).clamp(1e-20, 1e20) as f32;
        return;
    }
    let target = camera.target.as_dvec3();
    stand(camera, target - towards(camera) * factor, target);
}

/// Moves the camera by so many world units to the right, up, and along the view.
pub fn fly(camera: &mut Camera, by: DVec3) {
    let [right, up, forward] = axes(camera);
    shift_by(camera, right * by.x + up * by.y + forward * by.z);
}

fn shift_by(camera: &mut Camera, shift: DVec3) {
    let (eye, target) = (camera.eye.as_dvec3() + shift, camera.target.as_dvec3() + shift);
    stand(camera, eye, target);
}

/// Has the camera stand and look there, unless single precision leaves no view of that: so near, or so steep, that numbers do not tell
/// points apart.
fn stand(camera: &mut Camera, eye: DVec3, target: DVec3) {
    let moved = Camera { eye: eye.as_vec3(), target: target.as_vec3(), ..camera.clone() };
    let steep = towards(&moved).angle_between(moved.up.as_dvec3());
    let is_finite = moved.eye.is_finite() && moved.target.is_finite();
    if is_finite && (STEEPEST / 2.0..=std::f64::consts::PI - STEEPEST / 2.0).contains(&steep) {
        *camera = moved;
    }
}

/// Moves the camera along its view until it sees a box from corner to corner, which it then looks at the middle of. `aspect` is the
/// picture's width over its height.
pub fn fit(camera: &mut Camera, [least, greatest]: [DVec3; 2], aspect: f64) {
    let [.., forward] = axes(camera);
    let (middle, radius) = ((least + greatest) / 2.0, ((greatest - least).length() / 2.0).max(1e-6));
    let distance = match &mut camera.projection {
        Projection::Perspective { fov } => {
            let half = (f64::from(*fov) / 2.0).to_radians();
            let narrower = (half.tan() * aspect.min(1.0)).atan();
            radius / narrower.sin()
        }
        Projection::Orthographic { height } => {
            *height = (2.0 * radius / aspect.min(1.0)) as f32;
            2.0 * radius
        }
        Projection::Equirectangular | Projection::Fisheye { .. } => 2.0 * radius,
    };
    stand(camera, middle - forward * distance, middle);
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use proptest::prelude::*;

    use super::*;

    fn camera() -> Camera {
        Camera::new("", Vec3::new(3.0, 2.0, 5.0), Vec3::new(0.5, 1.0, -1.0), Projection::Perspective { fov: 40.0 })
    }

    /// Where a point is seen: shares of the picture's height from its middle, to the right and down.
    fn seen(camera: &Camera, point: DVec3) -> DVec2 {
        let ([right, up, forward], from_eye) = (axes(camera), point - camera.eye.as_dvec3());
        let depth = from_eye.dot(forward);
        let scale = match camera.projection {
            Projection::Perspective { fov } => 1.0 / (2.0 * (f64::from(fov) / 2.0).to_radians().tan() * depth),
            _ => 1.0 / height(camera),
        };
        DVec2::new(from_eye.dot(right), -from_eye.dot(up)) * scale
    }

    #[test]
    fn what_is_looked_at_follows_the_hand_that_pans() {
        for projection in [Projection::Perspective { fov: 40.0 }, Projection::Orthographic { height: 3.0 }] {
            let mut camera = Camera { projection, ..camera() };
            let (point, by) = (camera.target.as_dvec3(), DVec2::new(0.25, -0.125));
            pan(&mut camera, by);
            assert!((seen(&camera, point) - by).length() < 1e-6, "{:?}", seen(&camera, point));
        }
    }

    #[test]
    fn an_orbit_to_the_right_turns_what_is_before_the_middle_to_the_right() {
        let before = camera();
        let [.., forward] = axes(&before);
        let near = before.target.as_dvec3() - forward;
        let mut after = before.clone();
        orbit(&mut after, DVec2::new(0.1, 0.05));
        let moved = seen(&after, near);
        assert!(moved.x > 0.01 && moved.y > 0.005, "{moved}");
    }

    #[test]
    fn looking_to_the_right_and_down_moves_the_picture_to_the_left_and_up() {
        let before = camera();
        let mut after = before.clone();
        look(&mut after, DVec2::new(0.1, 0.05));
        let moved = seen(&after, before.target.as_dvec3());
        assert!(moved.x < -0.05 && moved.y < -0.02, "{moved}");
        assert_eq!(after.eye, before.eye);
    }

    #[test]
    fn a_fitted_box_touches_the_edge_of_the_picture_and_no_corner_is_beyond() {
        let corners = [DVec3::new(-1.0, -2.0, -3.0), DVec3::new(4.0, 1.0, 2.0)];
        for aspect in [0.5, 1.0, 1.78] {
            for projection in [Projection::Perspective { fov: 40.0 }, Projection::Orthographic { height: 3.0 }] {
                let mut camera = Camera { projection, ..camera() };
                fit(&mut camera, corners, aspect);
                let farthest = (0..8).map(|i| {
                    let of = |bit: usize, axis: usize| corners[i >> bit & 1][axis];
                    let at = seen(&camera, DVec3::new(of(0, 0), of(1, 1), of(2, 2)));
                    (2.0 * at.y.abs()).max(2.0 * at.x.abs() / aspect)
                });
                let farthest = farthest.fold(0.0, f64::max);
                assert!((0.4..=1.0001).contains(&farthest), "{farthest} {aspect} {projection:?}");
            }
        }
    }

    #[test]
    fn cameras_of_parallel_rays_come_nearer_by_a_smaller_height() {
        let mut camera = Camera { projection: Projection::Orthographic { height: 3.0 }, ..camera() };
        let eye = camera.eye;
        dolly(&mut camera, 2f64.ln());
        assert_eq!((camera.projection, camera.eye), (Projection::Orthographic { height: 1.5 }, eye));
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..Default::default() })]

        /// However a hand shakes, a view is left that a picture can be made of.
        #[test]
        fn no_motion_ends_a_view(moves in prop::collection::vec((0..5u8, -9.0f64..9.0, -9.0f64..9.0), 1..60)) {
            let mut camera = camera();
            for (kind, x, y) in moves {
                match kind {
                    0 => orbit(&mut camera, DVec2::new(x, y)),
                    1 => look(&mut camera, DVec2::new(x, y)),
                    2 => pan(&mut camera, DVec2::new(x, y)),
                    3 => dolly(&mut camera, x),
                    _ => fly(&mut camera, DVec3::new(x, y, x)),
                }
                let view = towards(&camera);
                prop_assert!(camera.eye.is_finite() && camera.target.is_finite() && view.length() > 0.0);
                let steep = view.angle_between(DVec3::Y);
                prop_assert!(steep > STEEPEST / 10.0 && steep < std::f64::consts::PI - STEEPEST / 10.0, "{}", steep);
            }
        }

        /// An orbit keeps the distance, and there and back again is where it was.
        #[test]
        fn an_orbit_goes_back_as_it_came(x in -3.0f64..3.0, y in -0.3f64..0.3) {
            let (before, mut camera) = (camera(), camera());
            orbit(&mut camera, DVec2::new(x, y));
            prop_assert!((towards(&camera).length() / towards(&before).length() - 1.0).abs() < 1e-5);
            orbit(&mut camera, DVec2::new(-x, -y));
            prop_assert!((camera.eye - before.eye).length() < 1e-4);
        }
    }
}
