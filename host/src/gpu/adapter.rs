//! The GPUs of this machine.

use serde::Serialize;

use crate::error::{Error, Result};

/// What an adapter offers, for people and machines.
#[derive(Debug, Clone, Serialize)]
pub struct AdapterReport {
    /// By this number it can be asked for.
    pub index: usize,
    /// By a part of this name it can be asked for.
    pub name: String,
    /// Vulkan, Metal or Direct3D 12.
    pub backend: String,
    /// Discrete, integrated, virtual, software or other.
    pub kind: &'static str,
    /// Driver and its version.
    pub driver: String,
    /// Does it take the committed SPIR-V as it is? Exact precision needs that, and Vulkan.
    pub passthrough: bool,
    /// Can it render in exact precision?
    pub exact: bool,
    /// Lanes of a subgroup, least and most.
    pub subgroup: (u32, u32),
    /// The largest buffer in bytes.
    pub max_buffer: u64,
    /// The largest part of a buffer that a kernel sees, in bytes.
    pub max_binding: u64,
    /// Its own memory in bytes, where Vulkan tells it.
    pub memory: Option<u64>,
    /// Can it time kernels?
    pub timestamps: bool,
}

impl AdapterReport {
    /// What adapter number `index` offers.
    pub fn of(index: usize, adapter: &wgpu::Adapter) -> Self {
        let (info, limits, features) = (adapter.get_info(), adapter.limits(), adapter.features());
        let passthrough = features.contains(wgpu::Features::PASSTHROUGH_SHADERS);
        AdapterReport {
            index,
            kind: kind(info.device_type),
            driver: [info.driver, info.driver_info].join(" ").trim().to_owned(),
            passthrough,
            exact: passthrough && info.backend == wgpu::Backend::Vulkan,
            subgroup: (info.subgroup_min_size, info.subgroup_max_size),
            max_buffer: limits.max_buffer_size,
            max_binding: limits.max_storage_buffer_binding_size,
            memory: memory(adapter),
            timestamps: features.contains(wgpu::Features::TIMESTAMP_QUERY),
            backend: match info.backend {
                wgpu::Backend::Dx12 => "Direct3D 12".to_owned(),
                other => format!("{other:?}"),
            },
            name: info.name,
        }
    }

    /// Does it run on the CPU after all?
    pub fn is_software(&self) -> bool {
        self.kind == SOFTWARE
    }
}

/// The largest heap of a device's own memory.
#[cfg(not(target_vendor = "apple"))]
fn memory(adapter: &wgpu::Adapter) -> Option<u64> {
    /// `VK_MEMORY_HEAP_DEVICE_LOCAL_BIT`
    const OWN: u32 = 1;
    // SAFETY: the device is asked a question that changes nothing, while the adapter keeps its handle.
    let answer = unsafe {
        let adapter = adapter.as_hal::<wgpu::hal::api::Vulkan>()?;
        let instance = adapter.shared_instance().raw_instance();
        instance.get_physical_device_memory_properties(adapter.raw_physical_device())
    };
    let heaps = answer.memory_heaps_as_slice().iter();
    heaps.filter(|heap| heap.flags.as_raw() & OWN != 0).map(|heap| heap.size).max()
}

#[cfg(target_vendor = "apple")]
fn memory(_: &wgpu::Adapter) -> Option<u64> {
    None
}

const SOFTWARE: &str = "software";

fn kind(device: wgpu::DeviceType) -> &'static str {
    match device {
        wgpu::DeviceType::DiscreteGpu => "discrete",
        wgpu::DeviceType::IntegratedGpu => "integrated",
        wgpu::DeviceType::VirtualGpu => "virtual",
        wgpu::DeviceType::Cpu => SOFTWARE,
        wgpu::DeviceType::Other => "other",
    }
}

/// The connection to the machine's graphics interfaces.
pub(super) fn instance() -> wgpu::Instance {
    let descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
    wgpu::Instance::new(wgpu::InstanceDescriptor { flags: flags(descriptor.flags), ..descriptor })
}

/// What a connection is opened with that has these flags otherwise, such as that of a window.
pub fn flags(flags: wgpu::InstanceFlags) -> wgpu::InstanceFlags {
    // The dispatches' sizes come from our own kernel; wgpu's check of each costs a dispatch more.
    flags - wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL
}

/// Every adapter of this machine, best first: hardware before software, discrete before integrated.
pub(super) fn all(instance: &wgpu::Instance) -> Vec<wgpu::Adapter> {
    let mut adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
    let rank = |kind| match kind {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    };
    adapters.sort_by_key(|a| rank(a.get_info().device_type));
    adapters
}

/// What the adapters of this machine offer, in the order of their numbers. Drivers may write to standard error meanwhile.
pub fn adapters() -> Vec<AdapterReport> {
    all(&instance()).iter().enumerate().map(|(i, a)| AdapterReport::of(i, a)).collect()
}

/// The adapter with this number or (part of a) name; without one the best.
pub(super) fn choose(instance: &wgpu::Instance, wish: Option<&str>) -> Result<(usize, wgpu::Adapter)> {
    let adapters = all(instance);
    let names: Vec<String> = adapters.iter().map(|a| a.get_info().name).collect();
    if names.is_empty() {
        return Err(Error::NoGpu);
    }
    let index = match wish {
        None => Some(0),
        Some(wish) => match wish.parse::<usize>() {
            Ok(number) => (number < names.len()).then_some(number),
            Err(_) => names.iter().position(|n| n.to_lowercase().contains(&wish.to_lowercase())),
        },
    };
    let index = index.ok_or_else(|| Error::NoSuchAdapter { wish: wish.unwrap_or_default().to_owned(), names })?;
    Ok((index, adapters.into_iter().nth(index).expect("the index is of this list")))
}
