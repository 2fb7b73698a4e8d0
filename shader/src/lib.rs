#![cfg_attr(target_arch = "spirv", no_std)]
//! Everything a ray of Eyerays meets, written once: rust-gpu compiles it to SPIR-V, rustc to native code.

pub mod data;
