//! What keys do beside moving the camera.

use eframe::egui::{self, Key, Modifiers};
use eyerays::render::DeviceWish;

use super::Window;
use crate::camera_text;
use crate::motion;

/// Every key with what it does, as the window tells.
pub(super) const KEYS: [(&str, &str); 17] = [
    ("click", "tell what is there"),
    ("ctrl + click", "make it sharp there"),
    ("drag", "orbit around what is looked at"),
    ("shift + drag, middle", "pan"),
    ("right drag", "look around"),
    ("wheel", "come nearer, go away"),
    ("W A S D Q E", "fly, faster with shift"),
    ("F", "see all of the scene"),
    ("R", "back to the camera as it was"),
    ("1 to 9", "the scene's cameras"),
    ("C", "copy the camera as TOML"),
    ("ctrl + S", "add the camera to the scene's file"),
    ("space", "play, stand still"),
    ("P", "pause, go on"),
    ("G", "the GPU, the CPU"),
    ("N", "all that may be changed"),
    ("ctrl + Q", "close the window"),
];

/// The keys of the scene's cameras.
const NUMBERS: [Key; 9] =
    [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6, Key::Num7, Key::Num8, Key::Num9];

impl Window {
    /// Does what was pressed.
    pub(super) fn keys(&mut self, context: &egui::Context) {
        // By what was held then: keys may have changed since, in the same frame.
        let pressed = |held: Modifiers, key: Key| context.input_mut(|input| input.consume_key(held, key));
        if pressed(Modifiers::COMMAND, Key::Q) {
            context.send_viewport_cmd(egui::ViewportCommand::Close);
        }
        if context.egui_wants_keyboard_input() {
            return;
        }
        let (with_ctrl, pressed) = (|key| pressed(Modifiers::COMMAND, key), |key| pressed(Modifiers::NONE, key));
        if pressed(Key::N) {
            self.show.panel = !self.show.panel;
        }
        if pressed(Key::P) {
            self.wish.is_paused = !self.wish.is_paused;
        }
        if pressed(Key::G) {
            let device = &mut self.wish.device;
            device.several = None;
            device.wish = if device.wish == DeviceWish::Cpu { DeviceWish::Gpu } else { DeviceWish::Cpu };
        }
        if pressed(Key::Space) {
            self.show.playing = !self.show.playing;
        }
        let Some((facts, mut camera)) = self.news.facts.clone().zip(self.camera()) else { return };
        if pressed(Key::F) {
            let (width, height) = self.wish.size;
            motion::fit(&mut camera, facts.bounds, f64::from(width) / f64::from(height));
            self.move_camera(camera.clone());
        }
        if pressed(Key::R) {
            (self.wish.camera, self.moved) = (None, None);
        }
        for (key, chosen) in NUMBERS.into_iter().zip(&facts.cameras) {
            if pressed(key) {
                self.wish.camera = Some(chosen.clone());
            }
        }
        if pressed(Key::C) || context.input(|input| input.events.contains(&egui::Event::Copy)) {
            let text = camera_text::toml(&camera);
            (self.told)(text.trim_end());
            context.copy_text(text);
            self.say("copied the camera");
        }
        if with_ctrl(Key::S) {
            match camera_text::add(&self.wish.source.path, &camera) {
                Ok(name) => self.say(format!("added the camera {name:?} to {}", self.wish.source.path.display())),
                Err(error) => self.say(format!("error: {error}")),
            }
        }
    }
}
