//! Kernels for one scene: the committed module with the scene's features written into it.

use std::borrow::Cow;

use eyerays_shader::data::Features;
use eyerays_shader::launch::{FEATURES_ID, WORKGROUP};

use super::device::{Gpu, Route};

const HEADER: usize = 5;
const OP_CONSTANT: u32 = 43;
const OP_SPEC_CONSTANT: u32 = 50;
const OP_DECORATE: u32 = 71;
const DECORATION_SPEC_ID: u32 = 1;

/// The module's words with the specialisation constant of the features made a plain constant, since
/// wgpu passes no constants to passthrough modules. The driver then folds every branch that the scene
/// does not take.
pub fn specialise(spirv: &[u8], features: Features) -> Vec<u32> {
    let words: Vec<u32> = spirv.chunks_exact(4).map(|c| u32::from_le_bytes([c[0], c[1], c[2], c[3]])).collect();
    let mut special = words[..HEADER].to_vec();
    let mut constant = None;
    let mut rest = &words[HEADER..];
    while let Some(&first) = rest.first() {
        let (instruction, after) = rest.split_at((first >> 16).max(1) as usize);
        rest = after;
        match instruction {
            &[head, target, DECORATION_SPEC_ID, FEATURES_ID] if head & 0xffff == OP_DECORATE => constant = Some(target),
            &[head, kind, id, _] if head & 0xffff == OP_SPEC_CONSTANT && Some(id) == constant => {
                special.extend([(head & 0xffff_0000) | OP_CONSTANT, kind, id, features.0]);
            }
            _ => special.extend(instruction),
        }
    }
    special
}

/// Makes a module of the driver's from specialised words.
pub(super) fn create(gpu: &Gpu, words: &[u32], entry: &str) -> wgpu::ShaderModule {
    match gpu.route {
        Route::Passthrough => {
            let entry = wgpu::PassthroughShaderEntryPoint { name: entry.into(), workgroup_size: (WORKGROUP, 1, 1) };
            // SAFETY: the words are the committed module, built and validated from our own kernels; every
            // index in the buffers it reads was validated, and every buffer has room for every slot.
            unsafe {
                gpu.device.create_shader_module_passthrough(wgpu::ShaderModuleDescriptorPassthrough {
                    label: Some("eyerays"),
                    entry_points: Cow::Owned(vec![entry]),
                    spirv: Some(Cow::Borrowed(words)),
                    ..Default::default()
                })
            }
        }
        Route::Naga => gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("eyerays"),
            source: wgpu::ShaderSource::SpirV(Cow::Borrowed(words)),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eyerays_shader::modules;

    #[test]
    fn both_modules_take_their_features_as_a_constant() {
        for module in [modules::EXACT, modules::FAST, modules::EXACT_SUBGROUP, modules::FAST_SUBGROUP] {
            let plain: Vec<u32> = module.chunks_exact(4).map(|c| u32::from_le_bytes(c.try_into().unwrap())).collect();
            let special = specialise(module, Features(0x2a5));
            assert_eq!(special.len() + 4, plain.len(), "the decoration is gone");
            let id =
                special.windows(4).find(|w| w[0] == (4 << 16) | OP_CONSTANT && w[3] == 0x2a5).expect("a constant")[2];
            assert!(plain.windows(4).any(|w| w[0] == (4 << 16) | OP_SPEC_CONSTANT && w[2] == id));
            assert!(!special.contains(&((4 << 16) | OP_SPEC_CONSTANT)), "no constant is left open");
        }
    }
}
