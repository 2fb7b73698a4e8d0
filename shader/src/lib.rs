#![cfg_attr(target_arch = "spirv", no_std, feature(asm_experimental_arch))]
//! Everything a ray of Eyerays meets, written once: rust-gpu compiles it to SPIR-V, rustc to native code.
pub mod background;
pub mod buffer;
#[cfg(not(target_arch = "spirv"))]
pub mod bvh8;
pub mod camera;
pub mod data;
pub mod entry;
pub mod geometry;
pub mod integrator;
pub mod launch;
pub mod light;
pub mod linear;
pub mod material;
pub mod methods;
pub mod numerics;
pub mod ray;
pub mod real;
pub mod refit;
pub mod resources;
pub mod sampler;
pub mod scene;
pub mod screen;
pub mod stage;
pub mod texture;
pub mod traverse;
pub mod warp;
