//! Kernels for one scene: the committed module with the scene's features written into it.

use std::borrow::Cow;

use eyerays_shader::data::Features;
use eyerays_shader::launch::{FEATURES_ID, WORKGROUP};

use super::device::{Gpu, Route};

const HEADER: usize = 5;
const OP_NOP: u32 = 0x0001_0000;
const OP_CONSTANT: u32 = 43;
const OP_SPEC_CONSTANT: u32 = 50;
const OP_DECORATE: u32 = 71;
const DECORATION_SPEC_ID: u32 = 1;

/// The module's words with the specialisation constant of the features made a plain constant, since
/// wgpu passes no constants to passthrough modules. The driver then folds every branch that the scene
/// does not take.
pub fn specialise(spirv: &[u8], features: Features) -> Vec<u32> {
    let mut words: Vec<u32> = spirv.chunks_exact(4).map(|c| u32::from_le_bytes([c[0], c[1], c[2], c[3]])).collect();
    let mut constant = None;
    let mut at = HEADER;
    while at < words.len() {
        let (opcode, length) = (words[at] & 0xffff, (words[at] >> 16).max(1) as usize);
        let operands = &mut words[at..at + length];
        match opcode {
            OP_DECORATE if operands[2..] == [DECORATION_SPEC_ID, FEATURES_ID] => {
                constant = Some(operands[1]);
                operands.fill(OP_NOP);
            }
            OP_SPEC_CONSTANT if Some(operands[2]) == constant => {
                operands[0] = (operands[0] & 0xffff_0000) | OP_CONSTANT;
                operands[3] = features.0;
            }
            _ => {}
        }
        at += length;
    }
    words
}

/// Makes a module of the driver's from specialised words.
pub(super) fn create(gpu: &Gpu, words: &[u32], entries: &[String]) -> wgpu::ShaderModule {
    match gpu.route {
        Route::Passthrough => {
            let entry_points = entries
                .iter()
                .map(|name| wgpu::PassthroughShaderEntryPoint {
                    name: name.as_str().into(),
                    workgroup_size: (WORKGROUP, 1, 1),
                })
                .collect();
            // SAFETY: the words are the committed module, built and validated from our own kernels; every
            // index in the buffers it reads was validated, and every buffer has room for every slot.
            unsafe {
                gpu.device.create_shader_module_passthrough(wgpu::ShaderModuleDescriptorPassthrough {
                    label: Some("eyerays"),
                    entry_points: Cow::Owned(entry_points),
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
        for module in [modules::EXACT, modules::FAST] {
            let plain: Vec<u32> = module.chunks_exact(4).map(|c| u32::from_le_bytes(c.try_into().unwrap())).collect();
            let special = specialise(module, Features(0x2a5));
            assert_eq!(plain.len(), special.len());
            let changed: Vec<(u32, u32)> =
                plain.iter().zip(&special).filter(|(a, b)| a != b).map(|(a, b)| (*a, *b)).collect();
            assert_eq!(changed.len(), 6, "a decoration of four words, an opcode and a value: {changed:x?}");
            assert_eq!(changed[4], ((4 << 16) | OP_SPEC_CONSTANT, (4 << 16) | OP_CONSTANT));
            assert_eq!(changed[5], (0, 0x2a5));
        }
    }
}
