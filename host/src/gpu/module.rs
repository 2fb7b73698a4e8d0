//! Kernels for one scene: the committed module with the scene's features written into it.

use std::borrow::Cow;

use eyerays_shader::data::{Features, Tuning};
use eyerays_shader::launch::{FEATURES_ID, TUNING_ID, WORKGROUP};

use super::device::{Gpu, Route};

const HEADER: usize = 5;
const OP_CONSTANT: u32 = 43;
const OP_SPEC_CONSTANT: u32 = 50;
const OP_DECORATE: u32 = 71;
const DECORATION_SPEC_ID: u32 = 1;

/// The module's words with its specialisation constants made plain ones, since wgpu passes no constants
/// to passthrough modules. The driver then folds every branch that the scene
/// does not take.
pub fn specialise(spirv: &[u8], features: Features, tuning: Tuning) -> Vec<u32> {
    let words: Vec<u32> = spirv.chunks_exact(4).map(|c| u32::from_le_bytes([c[0], c[1], c[2], c[3]])).collect();
    let mut special = words[..HEADER].to_vec();
    let mut constants = Vec::new();
    let mut rest = &words[HEADER..];
    while let Some(&first) = rest.first() {
        let (instruction, after) = rest.split_at((first >> 16).max(1) as usize);
        rest = after;
        match *instruction {
            [head, target, DECORATION_SPEC_ID, FEATURES_ID] if head & 0xffff == OP_DECORATE => {
                constants.push((target, features.0));
            }
            [head, target, DECORATION_SPEC_ID, TUNING_ID] if head & 0xffff == OP_DECORATE => {
                constants.push((target, tuning.0));
            }
            [head, kind, id, default] if head & 0xffff == OP_SPEC_CONSTANT => {
                let value = constants.iter().find(|c| c.0 == id).map_or(default, |c| c.1);
                special.extend([(head & 0xffff_0000) | OP_CONSTANT, kind, id, value]);
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
    fn modules_take_features_and_tuning_as_constants() {
        // Nothing is tuned where no rays decide together.
        let (alone, together) = (&[0x2a5][..], &[0x2a5, 0x1234][..]);
        for (module, values) in [
            (modules::EXACT, alone),
            (modules::FAST, alone),
            (modules::EXACT_SUBGROUP, together),
            (modules::FAST_SUBGROUP, together),
        ] {
            let plain: Vec<u32> = module.chunks_exact(4).map(|c| u32::from_le_bytes(c.try_into().unwrap())).collect();
            let special = specialise(module, Features(0x2a5), Tuning(0x1234));
            assert_eq!(special.len() + 4 * values.len(), plain.len(), "the decorations are gone");
            for &value in values {
                let constant = special.windows(4).find(|w| w[0] == (4 << 16) | OP_CONSTANT && w[3] == value);
                let id = constant.expect("a constant")[2];
                assert!(plain.windows(4).any(|w| w[0] == (4 << 16) | OP_SPEC_CONSTANT && w[2] == id));
            }
            assert!(!special.contains(&((4 << 16) | OP_SPEC_CONSTANT)), "no constant is left open");
        }
    }
}
