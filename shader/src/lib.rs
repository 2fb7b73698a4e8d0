#![cfg_attr(target_arch = "spirv", no_std, feature(asm_experimental_arch))]
//! Everything a ray of Eyerays meets, written once: rust-gpu compiles it to SPIR-V, rustc to native code.

pub mod buffer;
#[cfg(not(target_arch = "spirv"))]
pub mod bvh8;
pub mod camera;
pub mod data;
#[cfg(target_arch = "spirv")]
pub mod entry;
pub mod intersect;
pub mod launch;
#[cfg(not(target_arch = "spirv"))]
pub mod modules;
pub mod numerics;
pub mod ray;
pub mod real;
pub mod scene;
pub mod shade;
pub mod stage;
pub mod traverse;
pub mod warp;
