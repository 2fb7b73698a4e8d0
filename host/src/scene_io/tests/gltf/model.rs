//! Files for the tests, put together from JSON and bytes.

use std::path::Path;

use serde_json::{Value, json};

use crate::error::Result;
use crate::scene::Mesh;
use crate::scene_io::gltf::{self, Gltf};
use crate::scene_io::tests::budget;
use crate::scene_io::{Loading, Moment};

/// A file that is put together: its JSON, and its bytes, which become the first buffer.
pub struct Model {
    pub json: Value,
    pub bytes: Vec<u8>,
}

pub const F32: u32 = 5126;
pub const U16: u32 = 5123;

impl Model {
    /// A triangle at the origin with its corners on the axes x and y.
    pub fn triangle() -> Self {
        let mut model = Model::empty();
        let corners = floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        let position = model.accessor("VEC3", F32, 3, &corners);
        model.json["meshes"] = json!([{ "primitives": [{ "attributes": { "POSITION": position } }] }]);
        model.json["nodes"] = json!([{ "mesh": 0 }]);
        model.json["scenes"] = json!([{ "nodes": [0] }]);
        model
    }

    pub fn empty() -> Self {
        let json = json!({ "asset": { "version": "2.0" }, "accessors": [], "bufferViews": [] });
        Model { json, bytes: Vec::new() }
    }

    /// A file with something of everything.
    pub fn everything() -> Self {
        let mut model = Model::triangle();
        let normal = model.accessor("VEC3", F32, 3, &floats(&[[0.0, 0.0, 1.0]; 3].concat()));
        let tangent = model.accessor("VEC4", F32, 3, &floats(&[[1.0, 0.0, 0.0, 1.0]; 3].concat()));
        let coordinates = model.accessor("VEC2", 5121, 3, &[0, 0, 1, 0, 0, 1]);
        let indices = model.accessor("SCALAR", U16, 4, &shorts(&[0, 1, 2, 0]));
        let (places, values) = (model.view(&shorts(&[1])), model.view(&floats(&[2.0, 0.0, 0.0])));
        model.json["accessors"][0]["sparse"] = json!({
            "count": 1, "indices": { "bufferView": places, "componentType": U16 }, "values": { "bufferView": values }
        });
        let attributes = json!({ "POSITION": 0, "NORMAL": normal, "TANGENT": tangent, "TEXCOORD_0": coordinates });
        model.json["meshes"][0]["primitives"] = json!([
            { "attributes": attributes, "indices": indices, "mode": 5, "material": 0 },
            { "attributes": { "POSITION": 0 } },
        ]);
        model.json["images"] = json!([{ "uri": data(&picture()) }]);
        model.json["textures"] = json!([{ "source": 0, "sampler": 0 }]);
        model.json["samplers"] = json!([{ "magFilter": 9728 }]);
        model.json["materials"] = json!([{
            "pbrMetallicRoughness": { "baseColorFactor": [1, 0.5, 0.25, 1], "baseColorTexture": { "index": 0 } },
            "normalTexture": { "index": 0, "extensions": { "KHR_texture_transform": { "rotation": 1, "scale": [2, 3] } } },
            "emissiveFactor": [1, 0, 0],
            "extensions": { "KHR_materials_ior": { "ior": 1.4 }, "KHR_materials_transmission": { "transmissionFactor": 0.5 } },
        }]);
        model.json["cameras"] = json!([{ "perspective": { "yfov": 1 } }]);
        let spot = json!({ "outerConeAngle": 0.5, "innerConeAngle": 0.25 });
        model.json["extensions"] =
            json!({ "KHR_lights_punctual": { "lights": [{ "type": "spot", "intensity": 2, "spot": spot }] } });
        model.json["nodes"] = json!([
            { "mesh": 0, "children": [1], "rotation": [0, 0, 0, 1], "scale": [1, -2, 1] },
            { "mesh": 0, "camera": 0, "translation": [0, 0, 3], "extensions": { "KHR_lights_punctual": { "light": 0 } } },
        ]);
        let times = model.accessor("SCALAR", F32, 2, &floats(&[0.0, 1.0]));
        let turns = model.accessor("VEC4", F32, 2, &floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0]));
        let places = model.accessor("VEC3", F32, 6, &floats(&[[0.0, 0.5, 1.0]; 6].concat()));
        let target = |node: usize, path: &str| json!({ "node": node, "path": path });
        model.json["animations"] = json!([{
            "samplers": [
                { "input": times, "output": turns },
                { "input": times, "output": places, "interpolation": "CUBICSPLINE" },
            ],
            "channels": [
                { "sampler": 0, "target": target(0, "rotation") }, { "sampler": 1, "target": target(1, "translation") },
            ],
        }]);
        model
    }

    /// Adds bytes, and returns the number of their view.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        let views = self.json["bufferViews"].as_array_mut().unwrap();
        views.push(json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() }));
        self.bytes.extend(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.json["bufferViews"].as_array().unwrap().len() - 1
    }

    /// Adds a list, and returns its number.
    pub fn accessor(&mut self, kind: &str, component: u32, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        let accessors = self.json["accessors"].as_array_mut().unwrap();
        accessors.push(json!({ "bufferView": view, "componentType": component, "count": count, "type": kind }));
        accessors.len() - 1
    }

    /// The first primitive.
    pub fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    /// As JSON whose buffer is a data URI.
    pub fn gltf(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"] = json!([{ "uri": data(&self.bytes), "byteLength": self.bytes.len() }]);
        serde_json::to_vec(&json).unwrap()
    }

    /// As a binary file.
    pub fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"] = json!([{ "byteLength": self.bytes.len() }]);
        let mut json = serde_json::to_vec(&json).unwrap();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut bytes = self.bytes.clone();
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        let word = |number: usize| u32::try_from(number).unwrap().to_le_bytes();
        let length = word(12 + 8 + json.len() + 8 + bytes.len());
        let (of_json, of_bytes) = (word(json.len()), word(bytes.len()));
        [&b"glTF"[..], &word(2), &length, &of_json, b"JSON", &json, &of_bytes, b"BIN\0", &bytes].concat()
    }

    /// What it holds, with what stands in several places in each of them.
    pub fn load(&self) -> Gltf {
        let mut scene = parse(&self.gltf()).unwrap();
        let binary = parse(&self.glb()).unwrap();
        assert_eq!(
            (binary.obj.mesh, &binary.obj.copies),
            (scene.obj.mesh.clone(), &scene.obj.copies),
            "the binary file differs"
        );
        let (meshes, instances) = std::mem::take(&mut scene.obj.copies).finish();
        for instance in instances {
            scene.obj.mesh.append_moved(&meshes[instance.mesh as usize], &instance.transform());
        }
        scene
    }

    pub fn mesh(&self) -> Mesh {
        self.load().obj.mesh
    }
}

/// Reads a file that names no others.
pub fn parse(bytes: &[u8]) -> Result<Gltf> {
    parse_at(bytes, Moment::default())
}

/// The same at a moment.
pub fn parse_at(bytes: &[u8], moment: Moment) -> Result<Gltf> {
    let loading = Loading { moment, ..Loading::default() };
    gltf::parse(Path::new("/nowhere/a.glb"), bytes, budget(1 << 34), loading)
}

pub fn floats(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

pub fn shorts(numbers: &[u16]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

pub fn data(bytes: &[u8]) -> String {
    use base64::Engine;
    format!("data:application/octet-stream;base64,{}", base64::engine::general_purpose::STANDARD.encode(bytes))
}

/// A picture of 2 x 1 texels, red and green.
pub fn picture() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let image = image::RgbImage::from_raw(2, 1, vec![255, 0, 0, 0, 255, 0]).unwrap();
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}
