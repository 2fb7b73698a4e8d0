//! What a driver's compiler makes of a kernel: by Vulkan alone, without a queue, so that devices will do which run nothing, as Mesa's
//! null hardware.

use std::ffi::{CStr, CString};

use ash::{Device, Entry, Instance, khr, vk};
use eyerays::gpu::{Recipe, Target};
use eyerays::job::Job;
use eyerays::method::{Processor, Traversal};
use eyerays::plan::Plan;
use eyerays_passes::Kernel;
use eyerays_shader::resources::{Access, RESOURCES};

/// The kernels that render a scene by the default method in exact precision, each once, by the names of their entry points.
///
/// # Panics
/// If a committed module is damaged.
pub fn kernels(packed: &Job) -> Vec<(String, Kernel)> {
    let traversal = Traversal::default();
    let plan = Plan::new(packed, &traversal, |coherence| Ok(traversal.resolved(Processor::Gpu, coherence)));
    let recipe = |step: &_| Recipe::new(*step, Target { exact: true, subgroups: true });
    let mut recipes: Vec<Recipe> = Vec::new();
    for recipe in plan.expect("such a GPU has every method").steps().map(recipe) {
        if !recipes.iter().any(|other| other.is_like(&recipe)) {
            recipes.push(recipe);
        }
    }
    recipes.into_iter().map(|recipe| (recipe.name.clone(), recipe.cut())).collect()
}

/// A device that tells of its compiler's work (`VK_KHR_pipeline_executable_properties`).
pub struct Driver {
    /// As the driver calls it.
    pub name: String,
    device: Device,
    statistics: khr::pipeline_executable_properties::Device,
    instance: Instance,
    // The library that all of it is in.
    _entry: Entry,
}

/// What a compiler tells of a kernel, by the names that it gives, such as `Register Count` or `VGPRs`.
pub type Statistics = Vec<(String, f64)>;

impl Driver {
    /// The first device of the drivers at hand that tells; none where there is none.
    pub fn open() -> Option<Driver> {
        // SAFETY: the system's loader is asked for, as every program does that uses Vulkan.
        let entry = unsafe { Entry::load() }.ok()?;
        let about = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_2);
        let create = vk::InstanceCreateInfo::default().application_info(&about);
        // SAFETY: no extension, no layer, no pointer that outlives the call.
        let instance = unsafe { entry.create_instance(&create, None) }.ok()?;
        match of_instance(&instance) {
            Some((device, name)) => {
                let statistics = khr::pipeline_executable_properties::Device::new(&instance, &device);
                Some(Driver { name, device, statistics, instance, _entry: entry })
            }
            None => {
                // SAFETY: nothing was made of it.
                unsafe { instance.destroy_instance(None) };
                None
            }
        }
    }

    /// Compiles a kernel by the name of its entry point.
    ///
    /// # Errors
    /// What the driver reports.
    pub fn compile(&self, kernel: &Kernel, entry: &str) -> Result<Statistics, vk::Result> {
        let entry = CString::new(entry).expect("a path has no zero");
        let words = kernel.words();
        let bindings: Vec<_> = kernel.bindings().iter().zip(0..).map(|(&of, place)| binding(of, place)).collect();
        let device = &self.device;
        // SAFETY: the module is valid SPIR-V, as the tests of the committed modules have it; what is made is destroyed once, after
        // what was made of it, and nothing is launched.
        unsafe {
            let module = device.create_shader_module(&vk::ShaderModuleCreateInfo::default().code(&words), None)?;
            let set = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
            let sets = [device.create_descriptor_set_layout(&set, None)?];
            let layout =
                device.create_pipeline_layout(&vk::PipelineLayoutCreateInfo::default().set_layouts(&sets), None)?;
            let stage = vk::PipelineShaderStageCreateInfo::default()
                .stage(vk::ShaderStageFlags::COMPUTE)
                .module(module)
                .name(&entry);
            let create = vk::ComputePipelineCreateInfo::default()
                .flags(vk::PipelineCreateFlags::CAPTURE_STATISTICS_KHR)
                .stage(stage)
                .layout(layout);
            let made = device.create_compute_pipelines(vk::PipelineCache::null(), &[create], None);
            let told = made.map_err(|(_, error)| error).and_then(|pipelines| {
                let told = self.statistics_of(pipelines[0]);
                device.destroy_pipeline(pipelines[0], None);
                told
            });
            device.destroy_pipeline_layout(layout, None);
            device.destroy_descriptor_set_layout(sets[0], None);
            device.destroy_shader_module(module, None);
            told
        }
    }

    fn statistics_of(&self, pipeline: vk::Pipeline) -> Result<Statistics, vk::Result> {
        let of_first = vk::PipelineExecutableInfoKHR::default().pipeline(pipeline);
        // SAFETY: the pipeline was made by this device to be asked this; a kernel has one executable.
        let told = unsafe { self.statistics.get_pipeline_executable_statistics(&of_first) }?;
        let number = |told: &vk::PipelineExecutableStatisticKHR<'_>| {
            // SAFETY: the format says which of the numbers it is.
            unsafe {
                match told.format {
                    vk::PipelineExecutableStatisticFormatKHR::BOOL32 => f64::from(told.value.b32),
                    vk::PipelineExecutableStatisticFormatKHR::INT64 => told.value.i64 as f64,
                    vk::PipelineExecutableStatisticFormatKHR::UINT64 => told.value.u64 as f64,
                    _ => told.value.f64,
                }
            }
        };
        Ok(told.iter().map(|told| (text(&told.name), number(told))).collect())
    }
}

impl Drop for Driver {
    fn drop(&mut self) {
        // SAFETY: all that was made of them is gone.
        unsafe {
            self.device.destroy_device(None);
            self.instance.destroy_instance(None);
        }
    }
}

/// What a kernel binds at a place.
fn binding(of: u32, place: u32) -> vk::DescriptorSetLayoutBinding<'static> {
    let kind = match RESOURCES[of as usize].access {
        Access::Uniform => vk::DescriptorType::UNIFORM_BUFFER,
        Access::Read | Access::Write => vk::DescriptorType::STORAGE_BUFFER,
    };
    vk::DescriptorSetLayoutBinding::default()
        .binding(place)
        .descriptor_type(kind)
        .descriptor_count(1)
        .stage_flags(vk::ShaderStageFlags::COMPUTE)
}

/// A text of the driver's, which ends with a zero.
fn text(bytes: &[std::ffi::c_char]) -> String {
    let bytes: Vec<u8> = bytes.iter().map(|&byte| byte as u8).collect();
    CStr::from_bytes_until_nul(&bytes).map(|text| text.to_string_lossy().into_owned()).unwrap_or_default()
}

/// The first device that tells of its compiler's work, and its name.
fn of_instance(instance: &Instance) -> Option<(Device, String)> {
    // SAFETY: the instance lives, and so do all pointers until the calls return; the extension is there that is enabled.
    unsafe {
        instance.enumerate_physical_devices().ok()?.into_iter().find_map(|physical| {
            let extension = khr::pipeline_executable_properties::NAME;
            let all = instance.enumerate_device_extension_properties(physical).ok()?;
            all.iter().find(|one| one.extension_name_as_c_str() == Ok(extension))?;
            let extensions = [extension.as_ptr()];
            let mut tells =
                vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR::default().pipeline_executable_info(true);
            let queue = [vk::DeviceQueueCreateInfo::default().queue_priorities(&[1.0])];
            let create = vk::DeviceCreateInfo::default()
                .queue_create_infos(&queue)
                .enabled_extension_names(&extensions)
                .push_next(&mut tells);
            let device = instance.create_device(physical, &create, None).ok()?;
            Some((device, text(&instance.get_physical_device_properties(physical).device_name)))
        })
    }
}
