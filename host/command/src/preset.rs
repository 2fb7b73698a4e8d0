//! Settings files: what a measurement recommended, kept for renderings to come.

use std::path::Path;

use eyerays::choice::Named;
use serde::{Serialize, Serializer};

use crate::error::Result;
use eyerays::method::{Layout, Method, TriangleTest};
use eyerays::quality::Bvh;
use eyerays::render::{DeviceWish, Precision};
use eyerays::scene::{Filter, Integrator, PixelFilter, Range, Sampler, Settings};
use eyerays::scene_io::{Table, read_table};

/// What a settings file says; its keys are the names of options of `eyerays render`, with `_` for `-`. What it
/// does not say is left to the command line and the scene.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Preset {
    /// Where to render.
    #[serde(serialize_with = "wish")]
    pub device: Option<DeviceWish>,
    /// How numbers are computed.
    #[serde(serialize_with = "wish")]
    pub precision: Option<Precision>,
    /// How a ray is tested against a triangle.
    #[serde(serialize_with = "wish")]
    pub triangle: Option<TriangleTest>,
    /// How rays are followed.
    #[serde(serialize_with = "wish")]
    pub method: Option<Method>,
    /// How the hierarchy and its triangles lie in memory.
    #[serde(serialize_with = "wish")]
    pub layout: Option<Layout>,
    /// Quality of the hierarchy.
    #[serde(serialize_with = "wish")]
    pub bvh: Option<Bvh>,
    /// How light is carried.
    #[serde(serialize_with = "wish")]
    pub integrator: Option<Integrator>,
    /// Where in a pixel its samples lie.
    #[serde(serialize_with = "wish")]
    pub sampler: Option<Sampler>,
    /// What a ray sees of a texture.
    #[serde(serialize_with = "wish")]
    pub filter: Option<Filter>,
    /// How a pixel weighs what is around its middle.
    #[serde(serialize_with = "wish")]
    pub pixel_filter: Option<PixelFilter>,
    /// Is light of single wavelengths followed?
    pub spectral: Option<bool>,
    /// Photons for each pixel of a sample, 0 for none.
    pub caustics: Option<f32>,
    /// Samples along a pixel's edge.
    pub samples: Option<u32>,
    /// Samples of a pixel instead.
    pub spp: Option<u32>,
    /// The most times a ray is followed on.
    pub bounces: Option<u32>,
    /// A ray whose every weight is less is not followed.
    pub min_contribution: Option<f32>,
    /// Bounces before Russian roulette may end a path.
    pub roulette: Option<u32>,
    /// The most that light adds to a sample which was scattered more than once, 0 for no limit.
    pub clamp: Option<f32>,
}

impl Preset {
    /// Reads a settings file.
    ///
    /// # Errors
    /// No readable TOML file, an unknown key or value, a number out of range, two numbers of samples, or a triangle
    /// test that the precision has not: one line that names file, line and remedy.
    pub fn read(path: &Path) -> Result<Preset> {
        Ok(read_table(path, Self::of)?)
    }

    fn of(mut table: Table) -> eyerays::error::Result<Preset> {
        let preset = Preset {
            device: table.choice("device")?,
            precision: table.choice("precision")?,
            triangle: table.choice("triangle")?,
            method: table.choice("method")?,
            layout: table.choice("layout")?,
            bvh: table.choice("bvh")?,
            integrator: table.choice("integrator")?,
            sampler: table.choice("sampler")?,
            filter: table.choice("filter")?,
            pixel_filter: table.choice("pixel_filter")?,
            spectral: table.flag("spectral")?,
            caustics: table.number("caustics", Range::PHOTONS)?,
            samples: table.whole("samples", 1, Settings::MOST_SAMPLES)?,
            spp: table.whole("spp", 1, Settings::MOST_SPP)?,
            bounces: table.whole("bounces", 0, Settings::MOST_BOUNCES)?,
            min_contribution: table.number("min_contribution", Range::SHARE)?,
            roulette: table.whole("roulette", 0, Settings::MOST_BOUNCES)?,
            clamp: table.number("clamp", Range::AMOUNT)?,
        };
        if preset.samples.is_some() && preset.spp.is_some() {
            return Err(table.fault_of("spp", "samples and spp both say how many samples a pixel has; remove one"));
        }
        if preset.triangle == Some(TriangleTest::Moller) && preset.precision != Some(Precision::Fast) {
            let fault = "triangle \"moller\" is for fast precision; add precision = \"fast\" or remove it";
            return Err(table.fault_of("triangle", fault));
        }
        table.done()?;
        Ok(preset)
    }

    /// The text of a settings file, below a comment.
    pub fn text(&self, comment: &str) -> String {
        let keys = toml::to_string(self).expect("every field is a plain value");
        format!("# {}\n{keys}", comment.replace(char::is_control, " "))
    }
}

/// A choice as the command line and files spell it.
pub fn name<T: Named>(value: T) -> String {
    value.name().to_owned()
}

/// Writes a choice by its name.
pub(crate) fn named<T: Named, S: Serializer>(value: &T, out: S) -> std::result::Result<S::Ok, S::Error> {
    out.serialize_str(&name(*value))
}

fn wish<T: Named, S: Serializer>(value: &Option<T>, out: S) -> std::result::Result<S::Ok, S::Error> {
    match value {
        Some(value) => named(value, out),
        None => out.serialize_none(),
    }
}
