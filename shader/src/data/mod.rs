//! Every record that lives in device memory, once, for the host and for the kernels.
//!
//! A record is made of 16-byte words of three numbers and an integer. Numbers travel as their bits,
//! so that an index never passes through a float register (a small integer is a subnormal float,
//! which a device may flush). Coordinates are in the normalised scene: the host divides the scene by
//! a power of two so that every vertex lies in [-1, 1].

mod aovs;
mod camera;
mod compact;
mod cwbvh;
mod emitter;
mod finish;
mod frame;
mod grid;
mod instance;
mod light_node;
mod medium;
mod node;
mod physical;
mod primitive;
mod quanta;
mod shading;
mod specialisation;
mod spectrum;
mod texture;

pub use aovs::Aovs;
pub use camera::{Camera, Projection, Stereo};
pub use compact::CompactPair;
pub use cwbvh::CwbvhNode;
pub use emitter::{Emission, Emitter};
pub use finish::{Finish, FinishMaps};
pub use frame::Frame;
pub use grid::{CELLS, GlowTable, Grid};
pub use instance::{Instance, line};
pub use light_node::LightNode;
pub use medium::{Filling, Medium};
pub use node::{CentredPair, NodePair, NodeRef};
pub use physical::Physical;
pub use primitive::{Bounds, Primitive};
pub use quanta::Quanta;
pub use shading::{Light, Material, Normals};
pub use specialisation::{Caustics, Effects, Finishes, Launch, Layout, Media, Order, Specialisation, Tuning, Waves};
pub use spectrum::SpectrumRow;
pub use texture::{Colours, Maps, Opacity, TexCoords, TextureMap};

use glam::{UVec4, Vec3};

/// Three numbers and an integer in the 16 bytes that a GPU loads at once.
#[inline(always)]
pub fn pack(v: Vec3, word: u32) -> UVec4 {
    UVec4::new(v.x.to_bits(), v.y.to_bits(), v.z.to_bits(), word)
}

/// The three numbers of a packed word.
#[inline(always)]
pub fn numbers(q: UVec4) -> Vec3 {
    Vec3::new(f32::from_bits(q.x), f32::from_bits(q.y), f32::from_bits(q.z))
}

/// One of four integers, by the last two bits of a number.
#[inline(always)]
fn word(four: UVec4, number: u32) -> u32 {
    let two = if number & 2 == 0 { (four.x, four.y) } else { (four.z, four.w) };
    if number & 1 == 0 { two.0 } else { two.1 }
}

/// The most triangles a leaf holds (thesis chapter 6: "less than six").
pub const MAX_LEAF: u32 = 5;
/// Entries of a traversal stack; `eyerays-bvh` builds no tree that needs more.
pub const STACK: usize = 64;
/// How much wider than a primitive its box is on every side, in the normalised scene; see `geometry::edge_on` for the bound it covers.
pub const BOX_PADDING: f32 = 1.0 / (1 << 19) as f32;
