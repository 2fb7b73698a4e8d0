//! A glTF file of plants: a mesh each kind, and wherever it stands a copy (`EXT_mesh_gpu_instancing`).

use std::io::{self, Write};

use glam::Vec3;
use serde_json::{Value, json};

use super::plant::{Part, Plant};

const FLOATS: u32 = 5126;
const WORDS: u32 = 5125;

/// Where copies of a mesh stand.
#[derive(Default)]
pub struct Places {
    pub translations: Vec<[f32; 3]>,
    pub rotations: Vec<[f32; 4]>,
    pub scales: Vec<[f32; 3]>,
}

/// A file that is put together.
#[derive(Default)]
pub struct Model {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    materials: Vec<Value>,
    meshes: Vec<Value>,
    nodes: Vec<Value>,
}

impl Model {
    /// Adds the ground.
    pub fn ground(&mut self, part: &Part) {
        let primitive = self.primitive("ground", part);
        self.meshes.push(json!({ "name": "ground", "primitives": [primitive] }));
        self.nodes.push(json!({ "name": "ground", "mesh": self.meshes.len() - 1 }));
    }

    /// Adds a kind of plant wherever it stands.
    pub fn plants(&mut self, kind: usize, plant: &Plant, places: &Places) {
        let [stem, leaves] = &plant.parts;
        let primitives =
            [self.primitive(&format!("stem {kind}"), stem), self.primitive(&format!("leaves {kind}"), leaves)];
        let name = format!("plant {kind}");
        self.meshes.push(json!({ "name": name, "primitives": primitives }));
        let count = places.scales.len();
        let translation = self.list("VEC3", FLOATS, count, bytemuck::cast_slice(&places.translations));
        let rotation = self.list("VEC4", FLOATS, count, bytemuck::cast_slice(&places.rotations));
        let scale = self.list("VEC3", FLOATS, count, bytemuck::cast_slice(&places.scales));
        let attributes = json!({ "TRANSLATION": translation, "ROTATION": rotation, "SCALE": scale });
        self.nodes.push(json!({
            "name": name,
            "mesh": self.meshes.len() - 1,
            "extensions": { "EXT_mesh_gpu_instancing": { "attributes": attributes } },
        }));
    }

    /// Writes it as a binary file.
    pub fn write(mut self, comment: &str, out: &mut dyn Write) -> io::Result<()> {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let asset = json!({ "generator": comment, "version": "2.0" });
        let rest = json!({
            "extensionsUsed": ["EXT_mesh_gpu_instancing"],
            "extensionsRequired": ["EXT_mesh_gpu_instancing"],
            "buffers": [{ "byteLength": self.bytes.len() }],
            "bufferViews": self.views,
            "accessors": self.accessors,
            "materials": self.materials,
            "meshes": self.meshes,
            "scenes": [{ "nodes": (0..self.nodes.len()).collect::<Vec<_>>() }],
            "nodes": self.nodes,
        });
        // The asset first: by its generator the file is known as one that may be replaced.
        let mut json = format!("{{\"asset\":{asset},{}", &rest.to_string()[1..]).into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let word = |number: usize| u32::try_from(number).map(u32::to_le_bytes).map_err(io::Error::other);
        let length = word(12 + 8 + json.len() + 8 + self.bytes.len())?;
        let (of_json, of_bytes) = (word(json.len())?, word(self.bytes.len())?);
        let head = [&b"glTF"[..], &2u32.to_le_bytes(), &length, &of_json, b"JSON"].concat();
        for part in [&head[..], &json, &of_bytes, b"BIN\0", &self.bytes] {
            out.write_all(part)?;
        }
        Ok(())
    }

    fn primitive(&mut self, name: &str, part: &Part) -> Value {
        let [r, g, b] = part.colour;
        self.materials.push(json!({
            "name": name,
            "doubleSided": true,
            "pbrMetallicRoughness": { "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.8 },
        }));
        let material = self.materials.len() - 1;
        let position = self.list("VEC3", FLOATS, part.positions.len(), bytemuck::cast_slice(&part.positions));
        let ends = |least: Vec3, greatest: Vec3| (json!(least.to_array()), json!(greatest.to_array()));
        let around = part.positions.iter().fold((Vec3::MAX, Vec3::MIN), |(a, b), &p| (a.min(p), b.max(p)));
        let (least, greatest) = ends(around.0, around.1);
        self.accessors[position]["min"] = least;
        self.accessors[position]["max"] = greatest;
        let count = 3 * part.triangles.len();
        let indices = self.list("SCALAR", WORDS, count, bytemuck::cast_slice(&part.triangles));
        json!({ "attributes": { "POSITION": position }, "indices": indices, "material": material })
    }

    fn list(&mut self, kind: &str, component: u32, count: usize, bytes: &[u8]) -> usize {
        self.views.push(json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() }));
        self.bytes.extend(bytes);
        let view = self.views.len() - 1;
        self.accessors.push(json!({ "bufferView": view, "componentType": component, "count": count, "type": kind }));
        self.accessors.len() - 1
    }
}
