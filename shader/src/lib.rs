#![cfg_attr(target_arch = "spirv", no_std, feature(asm_experimental_arch))]
//! Everything a ray of Eyerays meets, written once: rust-gpu compiles it to SPIR-V, rustc to native code.

pub mod buffer;
pub mod camera;
pub mod data;
pub mod entry;
#[cfg(not(target_arch = "spirv"))]
pub mod bvh8;
pub mod integrator;
pub mod intersect;
pub mod launch;
pub mod methods;
#[cfg(not(target_arch = "spirv"))]
pub mod modules;
pub mod numerics;
pub mod ray;
pub mod real;
pub mod resources;
pub mod scene;
pub mod shade;
pub mod stage;
pub mod traverse;
pub mod warp;
