//! Kernels on their way to the driver.

use std::borrow::Cow;

use eyerays_shader::launch::WORKGROUP;

use super::device::{Gpu, Route};

/// Makes a module of the driver's from the words of one kernel.
pub(super) fn create(gpu: &Gpu, words: &[u32], entry: &str) -> wgpu::ShaderModule {
    match gpu.route {
        Route::Passthrough => {
            let entry = wgpu::PassthroughShaderEntryPoint { name: entry.into(), workgroup_size: (WORKGROUP, 1, 1) };
            // SAFETY: the words are a kernel of our own, cut out of a committed module by passes that keep it valid; every
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
