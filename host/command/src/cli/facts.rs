//! What a rendered picture says of itself.

use std::path::Path;

use eyerays::about::About;
use eyerays::film::{Film, Identity};
use eyerays::render::Rendering;
use eyerays::scene::Camera;
use eyerays::view::View;
use glam::DMat4;
use serde_json::{Map, Value, json};

/// What of a rendering its picture tells.
pub(super) struct Facts<'a> {
    pub scene: &'a Path,
    pub camera: &'a Camera,
    pub view: &'a View,
    pub identity: &'a Identity,
    pub rendering: &'a Rendering,
    /// What took noise off the picture, if anything did.
    pub denoised: Option<&'a str>,
    /// Of how many buckets it is made without fireflies, if it is.
    pub fireflies: Option<u32>,
    /// Without what differs from run to run and from device to device.
    pub reproducible: bool,
}

impl Facts<'_> {
    pub fn about(&self) -> About {
        let Facts { camera, view, identity, rendering, .. } = self;
        let (size, window) = (view.size(), view.region());
        let settings: Map<String, Value> =
            identity.entries().map(|(name, value)| (name.to_owned(), json!(value))).collect();
        let about = About::default()
            .with("program", "eyerays")
            .with("version", env!("CARGO_PKG_VERSION"))
            .with("scene", self.scene.to_string_lossy())
            .with("camera", camera.name.as_str())
            .with(About::WORLD_TO_CAMERA, rows(camera.world_to_camera()))
            .with(About::WORLD_TO_NDC, camera.world_to_ndc(size).map(rows))
            .with("size", vec![size.0, size.1])
            .with("tile", vec![window.x, window.y, window.width, window.height])
            .with("first_sample", view.range().start)
            .with("samples", rendering.samples)
            .with("noise", rendering.picture.noise())
            .with("noise_target", rendering.film.as_ref().and_then(Film::cells).map(|cells| cells.target().noise()))
            .with("identity", settings);
        let about = match self.fireflies {
            Some(by) => about.with("fireflies", format!("left out of {by} buckets")),
            None => about,
        };
        let about = match self.denoised {
            Some(by) => about.with("denoised", by),
            None => about,
        };
        if self.reproducible {
            return about;
        }
        about.with("device", rendering.device.as_str()).with("seconds", rendering.time.as_secs_f64())
    }
}

/// For row vectors, row by row: what is for column vectors, column by column.
fn rows(matrix: DMat4) -> Vec<f32> {
    matrix.to_cols_array().map(|number| number as f32).to_vec()
}
