//! The JSON of a glTF file, as far as it is read. Nothing in it is trusted: any number may be out of range, any index may
//! name nothing, and any list may have the wrong length.

use std::collections::BTreeMap;
use std::fmt;
use std::marker::PhantomData;
use std::ops::Deref;

use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::shading::{Extensions, Material};

/// The most nodes, and the most of anything else, that a file may list.
const MOST: usize = 1_000_000;
/// What the elements of one list may take of memory, in bytes: in JSON they may be three bytes each.
const MOST_BYTES: usize = 256 << 20;

/// A list that is refused before it takes too much memory.
pub struct List<T>(Vec<T>);

impl<T> Default for List<T> {
    fn default() -> Self {
        List(Vec::new())
    }
}

impl<T> Deref for List<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.0
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for List<T> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Elements<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for Elements<T> {
            type Value = List<T>;

            fn expecting(&self, out: &mut fmt::Formatter) -> fmt::Result {
                out.write_str("a list")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut from: A) -> Result<List<T>, A::Error> {
                let most = MOST.min(MOST_BYTES / size_of::<T>().max(1));
                let mut list = Vec::new();
                while let Some(element) = from.next_element()? {
                    if list.len() == most {
                        return Err(A::Error::custom(format!("a list has more than {most} elements; split the file")));
                    }
                    list.push(element);
                }
                Ok(List(list))
            }
        }
        from.deserialize_seq(Elements(PhantomData))
    }
}

/// The JSON without the mark of UTF-8, with which some writers begin.
pub fn text(json: &[u8]) -> &[u8] {
    json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json)
}

/// The whole of it.
#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub struct Document {
    pub asset: Asset,
    pub extensions_used: List<String>,
    pub extensions_required: List<String>,
    pub scene: Option<usize>,
    pub scenes: List<Scene>,
    pub nodes: List<Node>,
    pub meshes: List<Mesh>,
    pub accessors: List<Accessor>,
    pub buffer_views: List<BufferView>,
    pub buffers: List<Buffer>,
    pub materials: List<Material>,
    pub textures: List<Texture>,
    pub images: List<Image>,
    pub samplers: List<Sampler>,
    pub cameras: List<Camera>,
    pub skins: List<Skin>,
    pub animations: List<Animation>,
    pub extensions: DocumentExtensions,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub struct Asset {
    pub generator: Option<String>,
    pub version: Option<String>,
    pub min_version: Option<String>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub struct Scene {
    pub nodes: List<usize>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub struct Node {
    pub name: Option<String>,
    pub children: Vec<usize>,
    pub mesh: Option<usize>,
    pub camera: Option<usize>,
    pub skin: Option<usize>,
    pub matrix: Option<Vec<f64>>,
    pub translation: Option<Vec<f64>>,
    pub rotation: Option<Vec<f64>>,
    pub scale: Option<Vec<f64>>,
    /// Of morph targets, in place of the mesh's.
    pub weights: Option<Vec<f64>>,
    pub extensions: NodeExtensions,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub struct NodeExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    pub light: Option<LightOf>,
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub instances: Option<Box<Instances>>,
}

/// Where the copies of a node's mesh are.
#[derive(Deserialize, Default)]
#[serde(default)]
pub struct Instances {
    pub attributes: BTreeMap<String, usize>,
}

/// Which light a node carries.
#[derive(Deserialize)]
pub struct LightOf {
    pub light: Option<usize>,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub struct Skin {
    pub joints: Vec<usize>,
    pub inverse_bind_matrices: Option<usize>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub struct Animation {
    pub name: Option<String>,
    pub channels: List<Channel>,
    pub samplers: List<AnimationSampler>,
}

/// What an animation changes.
#[derive(Deserialize)]
pub struct Channel {
    pub sampler: usize,
    pub target: Target,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub struct Target {
    pub node: Option<usize>,
    pub path: String,
    pub extensions: TargetExtensions,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub struct TargetExtensions {
    #[serde(rename = "KHR_animation_pointer")]
    pub property: Option<PointerOf>,
}

/// Which number of the JSON is changed.
#[derive(Deserialize, Default)]
#[serde(default)]
pub struct PointerOf {
    pub pointer: String,
}

/// Accessors of times and of values.
#[derive(Deserialize)]
pub struct AnimationSampler {
    pub input: usize,
    pub output: usize,
    pub interpolation: Option<String>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub struct Mesh {
    pub name: Option<String>,
    pub primitives: List<Primitive>,
    /// Of its morph targets.
    pub weights: Vec<f64>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub struct Primitive {
    pub attributes: BTreeMap<String, usize>,
    pub indices: Option<usize>,
    pub material: Option<usize>,
    pub mode: Option<u64>,
    /// Morph targets: what is added to attributes.
    pub targets: Vec<BTreeMap<String, usize>>,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub struct Accessor {
    pub buffer_view: Option<usize>,
    pub byte_offset: usize,
    pub component_type: u64,
    pub normalized: bool,
    pub count: usize,
    #[serde(rename = "type")]
    pub kind: String,
    pub sparse: Option<Box<Sparse>>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub struct Sparse {
    pub count: usize,
    pub indices: SparsePart,
    pub values: SparsePart,
}

/// Where the indices or the values of a sparse accessor are; values have the component type of their accessor.
#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub struct SparsePart {
    pub buffer_view: usize,
    pub byte_offset: usize,
    pub component_type: u64,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub struct BufferView {
    pub buffer: usize,
    pub byte_offset: usize,
    pub byte_length: usize,
    pub byte_stride: Option<usize>,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub struct Buffer {
    pub uri: Option<String>,
    pub byte_length: Option<usize>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub struct Texture {
    pub source: Option<usize>,
    pub sampler: Option<usize>,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub struct Image {
    pub name: Option<String>,
    pub uri: Option<String>,
    pub buffer_view: Option<usize>,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub struct Sampler {
    pub mag_filter: Option<u64>,
    pub wrap_s: Option<u64>,
    pub wrap_t: Option<u64>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub struct Camera {
    pub name: Option<String>,
    pub perspective: Option<Perspective>,
    pub orthographic: Option<Orthographic>,
}

/// Both in units.
#[derive(Deserialize, Default)]
#[serde(default)]
pub struct Orthographic {
    /// Half of the width.
    pub xmag: f64,
    /// Half of the height.
    pub ymag: f64,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Perspective {
    /// Radians.
    pub yfov: f64,
    /// Width over height.
    pub aspect_ratio: Option<f64>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub struct DocumentExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    pub lights: Lights,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub struct Lights {
    pub lights: List<Light>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub struct Light {
    #[serde(rename = "type")]
    pub kind: String,
    pub color: Option<[f64; 3]>,
    pub intensity: Option<f64>,
    pub range: Option<f64>,
    pub spot: Spot,
    /// Anything.
    pub extras: serde_json::Value,
}

/// Half angles in radians.
#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub struct Spot {
    pub inner_cone_angle: Option<f64>,
    pub outer_cone_angle: Option<f64>,
}

/// What the JSON of a file may take of memory at most, in bytes: for each table the largest record that one becomes, for each key
/// an entry of a map, for each comma a number; twice as much while lists grow, and its text twice.
pub fn memory(json: &[u8]) -> u64 {
    const RECORD: u64 = 2 * size_of::<Extensions>() as u64;
    let count = |byte: u8| json.iter().filter(|&&other| other == byte).count() as u64;
    count(b'{') * RECORD + count(b':') * 2 * 56 + count(b',') * 2 * 8 + 2 * json.len() as u64
}

/// What a list holds under a number; `owner` is the JSON path of what names it.
///
/// # Errors
/// There is no such element.
pub fn pick<'l, T>(list: &'l [T], number: usize, owner: &str, noun: &str) -> Result<&'l T, String> {
    list.get(number).ok_or_else(|| match list.len() {
        0 => format!("{owner}: there is no {noun} {number}; the file has none"),
        count => format!("{owner}: there is no {noun} {number}; the file has {count}"),
    })
}
