//! What mouse and keys do to the camera.

use eframe::egui::{self, Key, PointerButton, Response, Vec2};
use eyerays::scene::{Camera, Projection};
use glam::{DVec2, DVec3};

use crate::motion;

/// A drag over all of the picture's height turns by so much, in radians.
const TURN: f64 = std::f64::consts::PI;
/// A line of a mouse's wheel, or so many pixels of a touchpad, bring the eye nearer by this.
const WHEEL: f64 = 0.1 / 50.0;
/// Flying, the height of what is seen is crossed in so many seconds.
const CROSSING: f64 = 1.5;

/// Moves a camera as mouse and keys say over a picture of this height in points, and tells whether they do.
pub(super) fn moved(camera: &mut Camera, response: &Response, height: f32) -> bool {
    let before = camera.clone();
    let share = |by: Vec2| DVec2::new(by.x.into(), by.y.into()) / f64::from(height.max(1.0));
    let (modifiers, wheel, seconds) =
        response.ctx.input(|input| (input.modifiers, input.smooth_scroll_delta().y, input.stable_dt));
    let shift = modifiers.shift;
    let drag = share(response.drag_delta());
    if response.dragged_by(PointerButton::Middle) || response.dragged_by(PointerButton::Primary) && shift {
        motion::pan(camera, drag);
    } else if response.dragged_by(PointerButton::Primary) {
        motion::orbit(camera, drag * TURN);
    } else if response.dragged_by(PointerButton::Secondary) {
        motion::look(camera, -drag * field(camera));
    }
    if response.hovered() && wheel != 0.0 {
        motion::dolly(camera, f64::from(wheel) * WHEEL);
    }
    // With ctrl held, keys mean something else.
    if !response.ctx.egui_wants_keyboard_input() && !modifiers.command {
        let way = keys(&response.ctx);
        if way != DVec3::ZERO {
            let faster = if shift { 4.0 } else { 1.0 };
            motion::fly(camera, way * motion::height(camera) / CROSSING * f64::from(seconds.min(0.1)) * faster);
        }
    }
    *camera != before
}

/// Where the keys that are held fly to: right, up, and along the view.
fn keys(context: &egui::Context) -> DVec3 {
    let pair = |less: Key, more: Key| {
        context.input(|input| f64::from(u8::from(input.key_down(more))) - f64::from(u8::from(input.key_down(less))))
    };
    DVec3::new(pair(Key::A, Key::D), pair(Key::Q, Key::E), pair(Key::S, Key::W))
}

/// The angle that a picture's height spans, in radians: what is dragged then stays under the hand.
fn field(camera: &Camera) -> f64 {
    match camera.projection {
        Projection::Perspective { fov } => f64::from(fov).to_radians(),
        Projection::Fisheye { fov, .. } => f64::from(fov).to_radians(),
        Projection::Orthographic { .. } | Projection::Equirectangular => TURN,
    }
}
