//! What launches exchange, and what kernels bind of it.

use eyerays_shader::camera;
use eyerays_shader::launch::argument;
use eyerays_shader::resources::binding;

use super::Renderer;
use super::cells::Cells;
use crate::error::Result;
use crate::gpu::kernel::Kernel;
use crate::gpu::memory::LaunchBuffers;

/// Launches of fewer slots are not worth a try.
const LEAST_SLOTS: u32 = 1 << 16;

/// What launches exchange, bound to the kernels: for a wave, and for the next, whose queues are exchanged.
pub(in crate::gpu) struct Memory {
    pub buffers: LaunchBuffers,
    /// By the plan's steps; none for those that bind the film.
    pub groups: Vec<Groups>,
    /// That of launches of photons, which lie in the same buffers.
    pub photons: Option<Box<Memory>>,
}

/// For a wave and the next, unless they are of a step that binds the film.
type Groups = Option<[wgpu::BindGroup; 2]>;

impl Renderer {
    pub(super) fn buffers(&self) -> &LaunchBuffers {
        &self.memory.as_ref().expect("it was reserved").buffers
    }

    pub(super) fn slots(&self) -> u32 {
        self.buffers().slots
    }

    /// Has it memory for launches of so many slots?
    pub(super) fn has_slots(&self, slots: u32) -> bool {
        self.memory.as_ref().is_some_and(|memory| memory.buffers.slots >= slots)
    }

    /// Takes memory for launches of so many slots, or of fewer where there is too little.
    pub(super) fn reserve(&mut self, mut slots: u32) -> Result<()> {
        if self.has_slots(slots) {
            return Ok(());
        }
        // What launches under way use is given back only when they are done.
        self.gpu.wait()?;
        (self.memory, self.growing) = (None, None);
        self.cells.iter_mut().for_each(Cells::forget);
        let (columns, rows) = camera::blocks(self.order);
        let mut refusal = None;
        let buffers = loop {
            match LaunchBuffers::new(&self.gpu, &self.plan.slot_bytes, slots) {
                Ok(buffers) => break buffers,
                Err(error) if slots > LEAST_SLOTS => {
                    refusal.get_or_insert(error);
                    slots = (slots / 2).next_multiple_of(columns * rows);
                    self.most_slots = slots;
                }
                Err(error) => return Err(refusal.unwrap_or(error)),
            }
        };
        // The kernels write how many groups there are in a row, and no more.
        let mut arguments = [0; argument::LENGTH as usize];
        for (of, rows) in [(argument::SLOTS, 1), (argument::SHADOWS, self.plan.shadow_rays)] {
            (arguments[of as usize + 1], arguments[of as usize + 2]) = (rows, 1);
        }
        self.gpu.queue.write_buffer(buffers.of(binding::ARGUMENTS), 0, bytemuck::cast_slice::<u32, u8>(&arguments));
        let groups = self.groups(&self.kernels, &buffers, None);
        let photons = self.photon_memory(&buffers);
        self.gpu.check()?;
        self.memory = Some(Memory { buffers, groups, photons });
        Ok(())
    }

    /// What kernels bind that do not bind the film; those over cells bind their table, too.
    pub(super) fn groups(
        &self,
        kernels: &[Kernel],
        buffers: &LaunchBuffers,
        table: Option<&wgpu::Buffer>,
    ) -> Vec<Groups> {
        let group = |kernel: &Kernel, is_second| {
            kernel.group(&self.gpu, |binding| match kernel.source(binding, &self.plan) {
                binding::CELLS => table,
                binding => self.scene.find(binding).or_else(|| buffers.find(binding, is_second)),
            })
        };
        let both = |kernel: &Kernel| [group(kernel, false), group(kernel, true)];
        kernels.iter().map(|kernel| (!kernel.binds(binding::FILM)).then(|| both(kernel))).collect()
    }

    /// What the kernel that keeps the film binds.
    pub(super) fn film_group(&self, kernels: &[Kernel], film: &wgpu::Buffer) -> wgpu::BindGroup {
        let kernel = kernels.iter().find(|kernel| kernel.binds(binding::FILM)).expect("a step keeps the film");
        kernel.group(&self.gpu, |binding| match binding {
            binding::FILM => Some(film),
            other => self.buffers().find(other, false),
        })
    }
}
