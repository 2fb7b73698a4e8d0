//! All that may be changed, at the right of the picture.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use eframe::egui::{CollapsingHeader, ComboBox, DragValue, Grid, Panel, ScrollArea, Slider, Ui};
use eyerays::choice::Named;
use eyerays::image::{Encoding, WhiteBalance};
use eyerays::render::{DeviceWish, Precision, Several};
use eyerays::scene::{Camera, Focus, Integrator, Lens, Material, Projection, Sampler, Settings};
use glam::Vec3;

use super::Window;
use super::keys::KEYS;
use crate::news::Facts;
use crate::wish::Device;

/// Boxes of deeper levels are too many to be drawn and told apart.
const DEEPEST: u32 = 11;

/// What an aperture is at first, as a share of the distance to what is looked at.
const APERTURE: f64 = 0.01;

impl Window {
    /// What may be changed.
    pub(super) fn panel(&mut self, ui: &mut Ui) {
        Panel::right("panel").default_size(300.0).show(ui, |ui| {
            ScrollArea::vertical().show(ui, |ui| {
                section(ui, "Device", true, |ui| {
                    device(ui, &mut self.wish.device);
                    ui.checkbox(&mut self.wish.is_paused, "paused");
                });
                section(ui, "What is shown", true, |ui| {
                    pick(ui, "shown", &mut self.wish.shows);
                    look(ui, &mut self.wish.look);
                });
                if let Some(facts) = self.news.facts.clone() {
                    section(ui, "How rays are followed", true, |ui| self.lesson(ui));
                    section(ui, "Camera", true, |ui| self.lens(ui, &facts));
                    section(ui, "Rendering", true, |ui| self.rendering(ui, &facts));
                    let settings = self.wish.settings.unwrap_or(facts.settings);
                    section(ui, "Beside it", true, |ui| self.beside_panel(ui, settings));
                    section(ui, "Animation", !facts.animations.is_empty(), |ui| self.animation(ui, &facts));
                    section(ui, "Lights", false, |ui| self.lights(ui, &facts));
                    section(ui, "Materials", false, |ui| self.materials(ui, &facts));
                    section(ui, "Warnings", false, |ui| {
                        facts.warnings.iter().for_each(|warning| drop(ui.label(warning)));
                    });
                }
                section(ui, "Keys", true, keys);
            });
        });
    }

    fn lesson(&mut self, ui: &mut Ui) {
        let lesson = &mut self.wish.lesson;
        let mut has_boxes = lesson.level.is_some();
        ui.checkbox(&mut has_boxes, "boxes of the hierarchy");
        let mut level = lesson.level.unwrap_or(0);
        if has_boxes {
            ui.add(Slider::new(&mut level, 0..=DEEPEST).text("level"));
            ui.weak(format!("{} of them", self.news.lesson.boxes.len()));
        }
        lesson.level = has_boxes.then_some(level);
        ui.checkbox(&mut self.show.follows, "a click follows its ray");
        if !self.show.follows {
            lesson.pixel = None;
        }
    }

    fn lens(&mut self, ui: &mut Ui, facts: &Facts) {
        let Some(mut camera) = self.camera() else { return };
        let before = camera.clone();
        ComboBox::from_label("camera").selected_text(&camera.name).show_ui(ui, |ui| {
            for (number, chosen) in facts.cameras.iter().enumerate() {
                if ui.selectable_label(camera == *chosen, format!("{} {}", number + 1, chosen.name)).clicked() {
                    camera = chosen.clone();
                }
            }
        });
        match &mut camera.projection {
            Projection::Perspective { fov } => slide(ui, "field of view in degrees", fov, 1.0..=150.0),
            Projection::Fisheye { fov, .. } => slide(ui, "field of view in degrees", fov, 10.0..=360.0),
            Projection::Orthographic { height } => number(ui, "height", height, 1e-3),
            Projection::Equirectangular => {}
        }
        if camera.projection.is_flat() {
            aperture(ui, &mut camera);
        }
        if camera != before {
            self.move_camera(camera);
        }
    }

    fn rendering(&mut self, ui: &mut Ui, facts: &Facts) {
        let mut settings = self.wish.settings.unwrap_or(facts.settings);
        transport(ui, &mut settings);
        self.wish.settings = (settings != facts.settings).then_some(settings);
        ui.add(Slider::new(&mut self.wish.most, 1..=Settings::MOST_SPP).logarithmic(true).text("samples at most"));
        if ui.button("as the scene says").clicked() {
            (self.wish.settings, self.wish.most) = (None, Settings::MOST_SPP);
        }
    }

    fn animation(&mut self, ui: &mut Ui, facts: &Facts) {
        let Some(animation) = facts.animations.first() else {
            ui.weak("nothing of this scene moves");
            return;
        };
        let playing = if self.show.playing { "stop" } else { "play" };
        if ui.button(format!("{playing} {}", animation.name)).clicked() {
            self.show.playing = !self.show.playing;
        }
        let before = self.wish.source.seconds.unwrap_or(0.0);
        let mut seconds = before;
        ui.add(Slider::new(&mut seconds, 0.0..=animation.seconds.max(1e-3)).text("seconds"));
        if seconds != before {
            self.wish.source.seconds = Some(seconds);
        }
    }

    fn lights(&mut self, ui: &mut Ui, facts: &Facts) {
        for (number, light) in facts.own.lights.iter().enumerate() {
            let mut factor = self.wish.edits.lights.get(&number).copied().unwrap_or(1.0);
            let name = format!("{} {}", number + 1, light.group());
            ui.add(Slider::new(&mut factor, 0.0..=100.0).logarithmic(true).text(name.trim_end()));
            keep(&mut self.wish.edits.lights, number, factor, factor != 1.0);
        }
        let Some(environment) = &facts.own.environment else { return };
        let (mut factor, mut rotation) = self.wish.edits.environment.unwrap_or((1.0, environment.rotation));
        ui.add(Slider::new(&mut factor, 0.0..=100.0).logarithmic(true).text("environment"));
        slide(ui, "turned by degrees", &mut rotation, -180.0..=180.0);
        let edit = (factor, rotation);
        self.wish.edits.environment = (edit != (1.0, environment.rotation)).then_some(edit);
    }

    fn materials(&mut self, ui: &mut Ui, facts: &Facts) {
        for (number, own) in facts.own.materials.iter().enumerate() {
            CollapsingHeader::new(&own.name).id_salt(number).show(ui, |ui| {
                let mut material = self.wish.edits.materials.get(&number).unwrap_or(own).clone();
                self::material(ui, &mut material);
                let differs = material != *own;
                keep(&mut self.wish.edits.materials, number, material, differs);
            });
        }
        if !self.wish.edits.is_none() && ui.button("as the files say").clicked() {
            self.wish.edits = Default::default();
        }
    }
}

/// Where it is rendered, and how numbers and rays are.
pub(super) fn device(ui: &mut Ui, device: &mut Device) {
    let Device { wish, several, precision, traversal, .. } = device;
    ui.horizontal_wrapped(|ui| {
        for &one in DeviceWish::VARIANTS {
            if ui.selectable_label(several.is_none() && *wish == one, one.name()).on_hover_text(one.help()).clicked() {
                (*wish, *several) = (one, None);
            }
        }
        let all = ui.selectable_label(several.is_some(), "all").on_hover_text("Every GPU and the CPU together");
        if all.clicked() {
            (*several, *precision) = (Some(Several::All), Precision::Exact);
        }
    });
    pick(ui, "precision", precision);
    pick(ui, "method", &mut traversal.method);
}

/// How light is followed.
pub(super) fn transport(ui: &mut Ui, settings: &mut Settings) {
    let Settings { transport, bounces, sampler, spectral, caustics, .. } = settings;
    pick(ui, "integrator", &mut transport.integrator);
    pick(ui, "sampler", sampler);
    ui.add(Slider::new(bounces, 0..=32).text("bounces"));
    if transport.integrator == Integrator::Path {
        slide(ui, "clamp", &mut transport.clamp, 0.0..=100.0);
        ui.checkbox(spectral, "light of single wavelengths");
        slide(ui, "photons of caustics", caustics, 0.0..=4.0);
    } else {
        (*spectral, *caustics) = (false, 0.0);
    }
    if transport.integrator.samples() && sampler.has_cells() {
        *sampler = Sampler::Sobol;
    }
}

/// Keeps an edit, or forgets it where it changes nothing.
fn keep<T>(edits: &mut BTreeMap<usize, T>, number: usize, edit: T, differs: bool) {
    if differs {
        edits.insert(number, edit);
    } else {
        edits.remove(&number);
    }
}

fn section(ui: &mut Ui, title: &str, is_open: bool, contents: impl FnOnce(&mut Ui)) {
    CollapsingHeader::new(title).default_open(is_open).show(ui, contents);
}

/// One of several.
fn pick<T: PartialEq + Named>(ui: &mut Ui, label: &str, value: &mut T) {
    ComboBox::from_label(label).selected_text(value.name()).show_ui(ui, |ui| {
        for &choice in T::VARIANTS {
            ui.selectable_value(value, choice, choice.name()).on_hover_text(choice.help());
        }
    });
}

fn slide(ui: &mut Ui, label: &str, value: &mut f32, range: RangeInclusive<f32>) {
    ui.add(Slider::new(value, range).text(label));
}

/// A number of any size, above 0.
fn number(ui: &mut Ui, label: &str, value: &mut f32, least: f32) {
    ui.horizontal(|ui| {
        let speed = f64::from(*value) / 100.0;
        ui.add(DragValue::new(value).speed(speed).range(least..=f32::MAX));
        ui.label(label);
    });
}

/// How light is shown.
pub(crate) fn look(ui: &mut Ui, look: &mut Encoding) {
    slide(ui, "exposure in stops", &mut look.exposure_ev, -10.0..=10.0);
    pick(ui, "tone map", &mut look.tone);
    let mut is_balanced = look.white.is_some();
    ui.checkbox(&mut is_balanced, "white balance");
    let mut kelvins = look.white.map_or(6504.0, WhiteBalance::kelvins);
    if is_balanced {
        ui.add(Slider::new(&mut kelvins, 2000.0..=12_000.0).text("kelvins"));
    }
    look.white = WhiteBalance::of(kelvins).ok().filter(|_| is_balanced);
}

/// A lens for a camera that has none, sharp where it looks.
pub(super) fn lens(camera: &Camera) -> Lens {
    let distance = f64::from(camera.eye.distance(camera.target));
    Lens { focus: Focus::Target, ..Lens::round((APERTURE * distance) as f32) }
}

/// What makes a camera sharp at one distance alone.
fn aperture(ui: &mut Ui, camera: &mut Camera) {
    let distance = f64::from(camera.eye.distance(camera.target));
    let first = lens(camera);
    let mut has_lens = camera.lens.is_some();
    ui.checkbox(&mut has_lens, "aperture");
    match (&mut camera.lens, has_lens) {
        (lens @ None, true) => *lens = Some(first),
        (lens, false) => *lens = None,
        (Some(lens), true) => {
            number(ui, "radius of the aperture", &mut lens.radius, 0.0);
            let mut focus = camera_focus(lens, distance);
            let before = focus;
            number(ui, "sharp at this distance", &mut focus, f32::MIN_POSITIVE);
            if focus != before {
                lens.focus = Focus::Distance(focus);
            }
        }
    }
}

fn camera_focus(lens: &Lens, distance: f64) -> f32 {
    match lens.focus {
        Focus::Distance(distance) => distance,
        Focus::Target | Focus::Point(_) => distance as f32,
    }
}

fn material(ui: &mut Ui, material: &mut Material) {
    if let Some(physical) = &mut material.physical {
        colour(ui, "base", &mut physical.base);
        slide(ui, "metallic", &mut physical.metallic, 0.0..=1.0);
        slide(ui, "roughness", &mut physical.roughness, 0.0..=1.0);
        colour(ui, "transmission", &mut physical.transmission);
        slide(ui, "index of refraction", &mut physical.ior, 1.0..=3.0);
    } else {
        colour(ui, "diffuse", &mut material.diffuse);
        colour(ui, "specular", &mut material.specular);
        colour(ui, "reflection", &mut material.reflection);
        colour(ui, "transmission", &mut material.transmission);
        slide(ui, "shininess", &mut material.shininess, 0.0..=1000.0);
        slide(ui, "index of refraction", &mut material.ior, 1.0..=3.0);
    }
    if material.emission != Vec3::ZERO {
        let mut light = material.emission.max_element();
        let before = light;
        number(ui, "emission", &mut light, 1e-6);
        if light != before {
            material.emission *= light / before;
        }
    }
    slide(ui, "opacity", &mut material.opacity, 0.0..=1.0);
}

/// Linear RGB.
fn colour(ui: &mut Ui, label: &str, value: &mut Vec3) {
    ui.horizontal(|ui| {
        let mut channels = value.to_array();
        if ui.color_edit_button_rgb(&mut channels).changed() {
            *value = Vec3::from_array(channels);
        }
        ui.label(label);
    });
}

fn keys(ui: &mut Ui) {
    Grid::new("keys").show(ui, |ui| {
        for (key, what) in KEYS {
            ui.strong(key);
            ui.label(what);
            ui.end_row();
        }
    });
}
