//! Photons on the GPU: launches of their own before those of the samples that look for them.

use eyerays_shader::resources::binding;

use super::{Memory, Renderer};
use crate::error::{Error, Result};
use crate::gpu::kernel::Kernel;
use crate::gpu::launch::Launch;
use crate::gpu::memory::LaunchBuffers;
use crate::plan::{self, Plan};
use crate::view::View;

/// What launches of photons take beside those of samples.
pub(super) struct Photons {
    pub plan: Plan,
    /// By the plan's steps.
    pub kernels: Vec<Kernel>,
}

impl Renderer {
    /// Slots that launches of at least so many samples need for their photons.
    pub(super) fn photon_slots(&self, view: &View, samples: u32) -> u64 {
        u64::from(view.photons(&self.job)) * u64::from(samples)
    }

    /// The most samples whose photons have a place in so many slots.
    pub(super) fn photon_samples(&self, view: &View, slots: u32) -> u32 {
        slots.checked_div(view.photons(&self.job)).unwrap_or(u32::MAX)
    }

    /// What launches of photons exchange: what those of samples do, but for counters of their own, since nobody counts their rays.
    pub(super) fn photon_memory(&self, buffers: &LaunchBuffers) -> Option<Box<Memory>> {
        let Photons { kernels, .. } = self.photons.as_ref()?;
        let buffers = buffers.with_own_counters(&self.gpu);
        let groups = self.groups(kernels, &buffers, None);
        Some(Box::new(Memory { buffers, groups, photons: None }))
    }

    /// Has the photons of some samples land, if there are any.
    ///
    /// # Errors
    /// There is too little memory for them, or what the GPU reports.
    pub(super) fn land(&mut self, view: &View, first: u32, count: u32) -> Result<()> {
        let Some(Photons { plan, kernels }) = &self.photons else { return Ok(()) };
        let memory = self.memory.as_ref().expect("it was reserved");
        let of_photons = memory.photons.as_ref().expect("its plan has photons");
        let frame = view.launch_of_photons(&self.job, first, count, self.order);
        if frame.slots > of_photons.buffers.slots {
            return Err(Error::new("the GPU has too little memory for so many photons: ask for fewer (caustics)"));
        }
        let counted = memory.buffers.of(binding::COUNTERS);
        let mut launch = Launch::of_photons(plan, kernels, of_photons, &frame, &mut self.queue, counted)?;
        plan::run(plan, &mut launch)?;
        launch.submit(0)
    }
}
