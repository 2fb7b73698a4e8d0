//! A scene as the text of a scene file that takes its surfaces from another file.

use std::collections::HashMap;
use std::fmt::{Debug, Write};

use glam::Vec3;

use super::finish;
use crate::choice::Named;
use crate::scene::studio;
use crate::scene::{
    Absorption, Alpha, Background, Camera, Conductor, Environment, Falloff, Focus, Integrator, Lens, Light, Mapping,
    Material, Matte, Medium, Physical, Projection, Scene, Settings, Transport, Visibility, Volume, Wall,
};
use crate::spectrum::Illuminant;

/// The text of a TOML scene whose one mesh is the file `mesh`, from which `scene` was loaded by itself: its settings, cameras,
/// lights and surroundings, and the numbers of its materials, for somebody to change. Textures stay in the mesh's file, as do
/// materials that share a name.
pub fn describe(scene: &Scene, mesh: &str) -> String {
    let mut text = Text::default();
    if scene.ambient != Vec3::ZERO {
        text.key("ambient", triple(scene.ambient));
    }
    if scene.lights.is_empty() && scene.environment.is_none() {
        text.line("# No lights are added: what shines is enough.");
        text.key("light", "[]");
    }
    text.table("render");
    settings(&mut text, &scene.settings);
    text.table("background");
    background(&mut text, scene);
    if let Some(fog) = &scene.fog {
        text.table("fog");
        medium(fog).into_iter().for_each(|(key, value)| text.key(key, value));
    }
    for camera in &scene.cameras {
        text.list("camera");
        self::camera(&mut text, camera);
    }
    for light in &scene.lights {
        text.list("light");
        self::light(&mut text, light);
    }
    let mut names: HashMap<&str, u32> = HashMap::new();
    scene.materials.iter().for_each(|material| *names.entry(&material.name).or_default() += 1);
    for material in scene.materials.iter().filter(|material| names[material.name.as_str()] == 1) {
        text.list("material");
        self::material(&mut text, material);
    }
    text.list("mesh");
    text.key("file", quoted(mesh));
    let mut shared: Vec<&str> = names.into_iter().filter(|(_, count)| *count > 1).map(|(name, _)| name).collect();
    shared.sort_unstable();
    for name in shared {
        text.line(&format!("# Several of its materials are called {}, so none of them is above.", quoted(name)));
    }
    text.0
}

/// A camera as a table of a TOML scene.
pub fn describe_camera(camera: &Camera) -> String {
    let mut text = Text::default();
    text.list("camera");
    self::camera(&mut text, camera);
    text.0
}

/// What is written so far.
#[derive(Default)]
struct Text(String);

impl Text {
    fn line(&mut self, line: &str) {
        self.0.push_str(line);
        self.0.push('\n');
    }

    fn heading(&mut self, heading: &str) {
        if !self.0.is_empty() {
            self.0.push('\n');
        }
        self.line(heading);
    }

    fn table(&mut self, name: &str) {
        self.heading(&format!("[{name}]"));
    }

    fn list(&mut self, name: &str) {
        self.heading(&format!("[[{name}]]"));
    }

    fn key(&mut self, key: &str, value: impl AsRef<str>) {
        self.line(&format!("{key} = {}", value.as_ref()));
    }

    /// A number, or anything else that is written as Rust has it.
    fn value<T: Debug>(&mut self, key: &str, value: T) {
        self.key(key, format!("{value:?}"));
    }

    /// The same, unless it is what nobody needs to say.
    fn other<T: Debug + PartialEq>(&mut self, key: &str, value: T, default: T) {
        if value != default {
            self.value(key, value);
        }
    }

    fn colour(&mut self, key: &str, colour: Vec3, default: Vec3) {
        if colour != default {
            self.key(key, triple(colour));
        }
    }

    fn word<T: Named + PartialEq>(&mut self, key: &str, word: T, default: T) {
        if word != default {
            self.key(key, quoted(word.name()));
        }
    }
}

fn triple(of: Vec3) -> String {
    format!("{:?}", of.to_array())
}

/// A TOML string.
fn quoted(text: &str) -> String {
    let mut quoted = String::from('"');
    for character in text.chars() {
        match character {
            '"' | '\\' => quoted.extend(['\\', character]),
            control if control.is_control() => {
                write!(quoted, "\\U{:08X}", u32::from(control)).expect("a string takes all that is written");
            }
            other => quoted.push(other),
        }
    }
    quoted + "\""
}

fn settings(text: &mut Text, of: &Settings) {
    let default = Settings::default();
    text.key("size", format!("[{}, {}]", of.size.0, of.size.1));
    text.other("samples", of.samples, default.samples);
    text.other("spp", of.spp, default.spp);
    text.word("sampler", of.sampler, default.sampler);
    text.other("bounces", of.bounces, default.bounces);
    text.other("min_contribution", of.min_contribution, default.min_contribution);
    text.other("culling", of.culling, default.culling);
    text.other("compensation", of.compensation, default.compensation);
    text.word("filter", of.filter, default.filter);
    if let Some(filter) = of.pixel_filter {
        text.key("pixel_filter", quoted(filter.name()));
    }
    text.other("transparent", of.transparent, default.transparent);
    text.other("spectral", of.spectral, default.spectral);
    text.other("caustics", of.caustics, default.caustics);
    let Transport { integrator, seed, roulette, clamp, direct, ao_distance } = of.transport;
    let default = default.transport;
    text.word("integrator", integrator, Integrator::Whitted);
    text.other("seed", seed, default.seed);
    text.other("roulette", roulette, default.roulette);
    text.other("clamp", clamp, default.clamp);
    text.word("direct", direct, default.direct);
    text.other("ao_distance", ao_distance, default.ao_distance);
}

fn background(text: &mut Text, scene: &Scene) {
    let is_hidden = scene.environment.as_ref().is_none_or(|environment| !environment.visible);
    match scene.background {
        Background::Colour(colour) if is_hidden => text.key("color", triple(colour)),
        // An environment takes its place.
        Background::Colour(_) => {}
        Background::Gradient { horizon, zenith } => {
            text.key("horizon", triple(horizon));
            text.key("zenith", triple(zenith));
        }
    }
    group(text, &scene.background_group);
    if let Some(Environment { texture, rotation, scale, visible }) = &scene.environment {
        let name = if *texture == studio::texture() { studio::NAME } else { &texture.name };
        text.key("environment", quoted(name));
        text.other("rotation", *rotation, 0.0);
        text.other("intensity", *scale, 1.0);
        text.other("visible", *visible, true);
    }
}

fn camera(text: &mut Text, of: &Camera) {
    text.key("name", quoted(&of.name));
    text.key("eye", triple(of.eye));
    text.key("target", triple(of.target));
    text.colour("up", of.up, Vec3::Y);
    match of.projection {
        Projection::Perspective { fov } => text.value("fov", fov),
        Projection::Orthographic { height } => text.value("orthographic", height),
        Projection::Equirectangular => text.key("projection", quoted("equirectangular")),
        Projection::Fisheye { fov, mapping } => {
            text.key("projection", quoted("fisheye"));
            text.value("fov", fov);
            text.word("mapping", mapping, Mapping::default());
        }
    }
    text.other("shift_x", of.shift[0], 0.0);
    text.other("shift_y", of.shift[1], 0.0);
    if let Some(lens) = &of.lens {
        self::lens(text, lens);
    }
    text.other("clip_near", of.clip[0], Camera::ALL[0]);
    text.other("clip_far", of.clip[1], Camera::ALL[1]);
    if let Some(stereo) = &of.stereo {
        text.key("stereo", quoted(stereo.layout.name()));
        text.value("eye_distance", stereo.distance);
        if let Some(convergence) = stereo.convergence {
            text.value("convergence", convergence);
        }
    }
}

fn lens(text: &mut Text, of: &Lens) {
    text.value("aperture", of.radius);
    match of.focus {
        Focus::Distance(distance) => text.value("focus", distance),
        Focus::Point(point) => text.key("focus_on", triple(point)),
        Focus::Target => {}
    }
    text.other("blades", of.blades, 0);
    text.other("blade_rotation", of.rotation, 0.0);
    text.other("blade_roundness", of.roundness, 0.0);
    text.other("anamorphic", of.ratio, 1.0);
}

/// The group that lamps are in.
fn group(text: &mut Text, name: &str) {
    if !name.is_empty() {
        text.key("group", quoted(name));
    }
}

fn light(text: &mut Text, of: &Light) {
    match *of {
        Light::Point { position, colour, .. } => {
            text.key("kind", quoted("point"));
            text.key("position", triple(position));
            text.colour("color", colour, Vec3::ONE);
        }
        Light::Directional { direction, colour, .. } => {
            text.key("kind", quoted("directional"));
            text.key("direction", triple(direction));
            text.colour("color", colour, Vec3::ONE);
        }
        Light::Spot { position, target, colour, outer, inner, falloff, .. } => {
            text.key("kind", quoted("spot"));
            text.key("position", triple(position));
            text.key("target", triple(target));
            text.colour("color", colour, Vec3::ONE);
            text.value("angle", 2.0 * outer);
            text.value("softness", (1.0 - f64::from(inner) / f64::from(outer)) as f32);
            if falloff != Falloff::default() {
                text.key("falloff", quoted(falloff.name()));
            }
        }
    }
    illuminant(text, of.illuminant());
    group(text, of.group());
}

/// The spectrum of lamps.
fn illuminant(text: &mut Text, of: Option<Illuminant>) {
    match of {
        Some(Illuminant::BlackBody(kelvins)) => text.value("temperature", kelvins),
        Some(Illuminant::Fluorescent(lamp)) => text.key("illuminant", quoted(lamp.name())),
        None => {}
    }
}

fn material(text: &mut Text, of: &Material) {
    text.key("name", quoted(&of.name));
    match &of.physical {
        Some(physical) => self::physical(text, physical),
        None => plain(text, of),
    }
    text.colour("transmission", of.physical.map_or(of.transmission, |p| p.transmission), Vec3::ZERO);
    if of.physical.is_none_or(|physical| physical.glass.is_none()) {
        text.other("ior", of.ior, Material::default().ior);
    }
    text.colour("emission", of.emission, Vec3::ZERO);
    illuminant(text, of.illuminant);
    text.other("two_sided", of.two_sided, false);
    group(text, &of.group);
    if let Some(lit_by) = &of.lit_by {
        let names: Vec<String> = lit_by.iter().map(|name| quoted(name)).collect();
        text.key("lit_by", format!("[{}]", names.join(", ")));
    }
    if let Some(of) = &of.volume {
        text.key("volume", volume(of));
    }
    visibility(text, of.visibility);
    match of.alpha {
        Alpha::Opaque => {}
        Alpha::Mask(least) => text.value("alpha_cutoff", least),
        Alpha::Blend => text.key("alpha", quoted("blend")),
    }
    text.other("opacity", of.opacity, 1.0);
}

/// What a medium says.
fn medium(of: &Medium) -> Vec<(&'static str, String)> {
    let default = Medium::default();
    let colours = [
        ("scattering", of.scattering, default.scattering),
        ("absorption", of.absorption, default.absorption),
        ("emission", of.emission, default.emission),
    ];
    let said = colours.into_iter().filter(|(_, colour, default)| colour != default);
    let mut keys: Vec<_> = said.map(|(key, colour, _)| (key, triple(colour))).collect();
    if of.anisotropy != default.anisotropy {
        keys.push(("anisotropy", format!("{:?}", of.anisotropy)));
    }
    keys
}

/// What surfaces are filled with, as a table in a line.
fn volume(of: &Volume) -> String {
    let mut keys = medium(&of.medium);
    if !of.interface {
        keys.push(("interface", "false".to_owned()));
    }
    if of.priority > 0 {
        keys.push(("priority", of.priority.to_string()));
    }
    let all: Vec<String> = keys.into_iter().map(|(key, value)| format!("{key} = {value}")).collect();
    format!("{{ {} }}", all.join(", "))
}

fn visibility(text: &mut Text, of: Visibility) {
    let Visibility { camera, shadow, reflection, matte } = of;
    let rays = [("camera", camera), ("shadow", shadow), ("reflection", reflection)];
    let hidden: Vec<_> = rays.iter().filter(|(_, sees)| !sees).map(|(ray, _)| format!("{ray} = false")).collect();
    if !hidden.is_empty() {
        text.key("visible", format!("{{ {} }}", hidden.join(", ")));
    }
    text.other("catcher", matte == Matte::Catcher, false);
    text.other("holdout", matte == Matte::Holdout, false);
}

/// The thesis' model.
fn plain(text: &mut Text, of: &Material) {
    let default = Material::default();
    text.key("diffuse", triple(of.diffuse));
    text.colour("ambient", of.ambient(), of.diffuse);
    text.colour("specular", of.specular, default.specular);
    text.other("shininess", of.shininess, default.shininess);
    text.colour("reflection", of.reflection, default.reflection);
}

fn physical(text: &mut Text, of: &Physical) {
    let default = Physical::default();
    text.other("roughness", of.roughness, default.roughness);
    text.other("anisotropy", of.anisotropy, default.anisotropy);
    text.other("anisotropy_rotation", of.anisotropy_rotation, default.anisotropy_rotation);
    finish::described(of).into_iter().for_each(|(key, value)| text.key(key, value));
    if let Some(metal) = of.conductor.and_then(|conductor| conductor.metal) {
        text.key("metal", quoted(metal.name()));
        return;
    }
    if let Some(Conductor { eta, k, .. }) = of.conductor {
        text.key("conductor", format!("{{ eta = {}, k = {} }}", triple(eta), triple(k)));
        return;
    }
    text.key("base_color", triple(of.base));
    text.value("metallic", of.metallic);
    text.other("specular_weight", of.specular_weight, default.specular_weight);
    text.colour("specular_tint", of.specular_tint, default.specular_tint);
    match of.wall {
        Wall::Body => {}
        Wall::Pane => text.key("thin", "true"),
        Wall::Interface => text.key("thin", quoted(of.wall.name())),
    }
    if let Some(Absorption { colour, distance }) = of.absorption {
        text.key("absorption", format!("{{ color = {}, distance = {distance:?} }}", triple(colour)));
    }
}
