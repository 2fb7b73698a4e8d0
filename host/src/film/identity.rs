//! What a film is of, so that only parts of one picture are merged, and only what belongs to it is gone on with.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest, Sha256};

use crate::choice::Named;
use crate::error::{Error, Result};
use crate::job::Job;
use crate::layers;
use crate::method::Traversal;
use crate::noise::Target;
use crate::picture::hexadecimal;
use crate::render::Precision;
use crate::scene::Settings;
use crate::view::View;

/// What names of layers are under.
const LAYERS: &str = "layers";

/// All that the bits of a sample depend on, by names: the scene, the camera, settings, the kernels, and in fast precision the device.
/// An empty one is as good as any.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Identity(BTreeMap<String, String>);

impl Identity {
    /// Of a view of a scene, rendered with this precision; `scene` is the [`fingerprint`](crate::scene_io::fingerprint) of what was
    /// packed.
    ///
    /// # Errors
    /// None that settings could make.
    pub fn of(scene: [u8; 32], packed: &Job, view: &View, precision: Precision) -> Result<Identity> {
        let settings = packed.settings();
        let (width, height) = view.size();
        let mut all = BTreeMap::from([
            ("scene".to_owned(), hexadecimal(&scene)),
            ("camera".to_owned(), hexadecimal(&Sha256::digest(view.camera_bytes()))),
            ("size".to_owned(), format!("{width}x{height}")),
            ("precision".to_owned(), precision.name().to_owned()),
            ("version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
            ("kernels".to_owned(), eyerays_modules::SOURCE.to_owned()),
        ]);
        let optics = packed.optic_tables();
        if !optics.is_empty() {
            all.insert("optics".to_owned(), hexadecimal(&Sha256::digest(bytemuck::cast_slice::<u32, u8>(optics))));
        }
        let kept = layers::names(packed);
        if !kept.is_empty() {
            all.insert(LAYERS.to_owned(), kept.join(","));
        }
        if settings.sampler.has_cells() {
            all.insert("samples".to_owned(), settings.samples_a_pixel().to_string());
        }
        // Of what is asked for in numbers only these are no part of every sample.
        let of_samples = Settings { size: (0, 0), samples: 0, spp: 0, ..*settings };
        let value = serde_json::to_value(of_samples).map_err(|error| Error::new(error.to_string()))?;
        add(&mut all, value);
        Ok(Identity(all))
    }

    /// With what fast precision depends on too: the device with its driver, and how it follows rays.
    #[must_use]
    pub fn on(mut self, device: &str, traversal: Traversal) -> Identity {
        self.0.insert("device".to_owned(), device.to_owned());
        self.0.insert("traversal".to_owned(), format!("{traversal:?}"));
        self
    }

    /// With what decides how many samples a pixel has.
    #[must_use]
    pub fn until(mut self, target: &Target) -> Identity {
        self.0.extend(target.entries().map(|(name, value)| (name.to_owned(), value)));
        self
    }

    /// What its arbitrary output variables are called, in their order.
    pub fn layers(&self) -> Vec<String> {
        self.0.get(LAYERS).map_or_else(Vec::new, |names| names.split(',').map(str::to_owned).collect())
    }

    /// Names and values.
    pub fn entries(&self) -> impl Iterator<Item = (&str, &str)> {
        self.0.iter().map(|(name, value)| (name.as_str(), value.as_str()))
    }

    /// Refuses another.
    ///
    /// # Errors
    /// The first name with two values.
    pub fn check(&self, other: &Identity) -> Result<()> {
        if self.0.is_empty() || other.0.is_empty() {
            return Ok(());
        }
        let names = self.0.keys().chain(other.0.keys().filter(|&name| !self.0.contains_key(name)));
        for name in names {
            let [a, b] = [self, other].map(|identity| identity.0.get(name).map_or("none", |value| short(value)));
            if self.0.get(name) != other.0.get(name) {
                if name == LAYERS {
                    return Err(Error::OtherLayers { one: a.to_owned(), other: b.to_owned() });
                }
                return Err(Error::OtherFilm { what: name.clone(), one: a.to_owned(), other: b.to_owned() });
            }
        }
        Ok(())
    }
}

/// The first digits of a hash, which tell enough.
fn short(value: &str) -> &str {
    let is_hash = value.len() == 64 && value.bytes().all(|byte| byte.is_ascii_hexdigit());
    if is_hash { &value[..12] } else { value }
}

/// The numbers and names of a table and of those within.
fn add(all: &mut BTreeMap<String, String>, value: Value) {
    let Value::Object(fields) = value else { return };
    for (name, value) in fields {
        match value {
            Value::Object(_) => add(all, value),
            Value::Array(_) => {}
            Value::String(text) => drop(all.insert(name, text)),
            value if name != "samples" && name != "spp" => drop(all.insert(name, value.to_string())),
            _ => {}
        }
    }
}
