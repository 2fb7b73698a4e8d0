//! Rays through a GPU, chunk after chunk: while one is traced, the next is packed and the one before is told of.

use std::collections::VecDeque;
use std::ops::Range;
use std::sync::PoisonError;

use eyerays_shader::data::pack;
use eyerays_shader::resources::binding;
use glam::UVec4;
use rayon::prelude::*;
use wgpu::BufferUsages as Use;

use super::cast::{Cast, Caster};
use super::kernel::Kernel;
use super::readback::Readback;
use crate::batch::Measure;
use crate::error::{Error, Result};
use crate::method::Traversal;
use crate::stream::{Question, StreamRay};

/// Rays of a chunk.
const CHUNK: usize = 1 << 19;
/// Rays that a thread packs at once, whose records are in its nearest cache. Chunks are filled up to whole pieces by rays that meet nothing.
const PIECE: usize = 1 << 8;
/// Pieces that are worth a thread.
const PIECES: usize = 8;
/// Bytes of half of their records.
const BYTES: usize = 16 * PIECE;
/// Chunks on their way at once.
const LANES: usize = 3;

/// What a chunk takes of memory on both sides. To take it takes longer than to trace a million rays, so a caster keeps it.
pub(super) struct Lane {
    cast: Cast,
    upload: wgpu::Buffer,
    back: Readback,
    measures: Vec<Measure>,
    /// What is on its way.
    sent: Option<(Range<usize>, wgpu::SubmissionIndex)>,
}

/// What rays have found, by their numbers in the chunk.
pub(crate) struct Chunk<'a> {
    /// Which rays they are.
    pub rays: Range<usize>,
    /// How far they were moved.
    pub measures: &'a [Measure],
    /// Their answers, as [`Answers`](crate::stream::Answers) has them, of `row` rays.
    pub bytes: &'a [u8],
    /// Of the answers.
    pub row: usize,
}

/// Who is told of chunks.
pub(crate) type Tell<'t, E> = dyn FnMut(Chunk<'_>) -> std::result::Result<(), E> + 't;

impl Caster {
    /// Answers a question of `count` rays that are made as they are needed, told of in their order.
    ///
    /// # Errors
    /// What the GPU reports, or who is told.
    pub(crate) fn ask<E: From<Error>>(
        &self,
        question: Question,
        count: usize,
        ray: &(impl Fn(usize) -> (StreamRay, Measure) + Sync),
        tell: &mut Tell<'_, E>,
    ) -> std::result::Result<(), E> {
        let kernel = self.kernel(true, Traversal::default(), question)?;
        let answer = match question {
            Question::Closest => (binding::HITS, 16 * self.rows()),
            Question::Occlusion => (binding::SHADOWS, 4),
        };
        let mut lanes = self.lanes(count)?;
        // The one that was sent first is the next.
        for start in (0..count).step_by(CHUNK) {
            let mut lane = lanes.pop_front().expect("there is a lane for a ray");
            self.receive(&mut lane, answer, tell)?;
            let rays = start..count.min(start + CHUNK);
            let row = rays.len().next_multiple_of(PIECE);
            self.write(&mut lane, (rays.clone(), row), ray)?;
            self.send(&kernel, &mut lane, (rays, row), answer);
            lanes.push_back(lane);
        }
        for lane in &mut lanes {
            self.receive(lane, answer, tell)?;
        }
        // Of a call that fails they are thrown away, with what is on its way.
        self.idle.lock().unwrap_or_else(PoisonError::into_inner).extend(lanes);
        Ok(())
    }

    /// As many lanes as so many rays fill.
    fn lanes(&self, count: usize) -> Result<VecDeque<Lane>> {
        let (wanted, most) = (count.div_ceil(CHUNK).min(LANES), count.min(CHUNK).next_multiple_of(PIECE));
        let mut lanes: VecDeque<Lane> = {
            let mut idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner);
            idle.retain(|lane| lane.measures.len() >= most);
            let kept = idle.len().min(wanted);
            idle.drain(..kept).collect()
        };
        while lanes.len() < wanted {
            lanes.push_back(self.lane(most)?);
        }
        Ok(lanes)
    }

    fn lane(&self, most: usize) -> Result<Lane> {
        let cast = self.room(most)?;
        let upload = self.gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("rays"),
            size: 32 * most as u64,
            usage: Use::MAP_WRITE | Use::COPY_SRC,
            mapped_at_creation: true,
        });
        let back = Readback::new(&self.gpu, 16 * self.rows() * most as u64);
        self.gpu.check()?;
        Ok(Lane { cast, upload, back, measures: vec![Measure::default(); most], sent: None })
    }

    /// Asks the GPU what was written.
    fn send(&self, kernel: &Kernel, lane: &mut Lane, (rays, row): (Range<usize>, usize), answer: (u32, u64)) {
        let (frame, gpu) = (self.packed.stream_frame(row), &self.gpu);
        gpu.queue.write_buffer(lane.cast.buffers.of(binding::FRAME), 0, bytemuck::bytes_of(&frame));
        lane.cast.count = row as u32;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let paths = lane.cast.buffers.of(binding::PATHS);
        encoder.copy_buffer_to_buffer(&lane.upload, 0, paths, 0, 32 * row as u64);
        self.dispatch(&mut encoder, &lane.cast, kernel, None);
        lane.back.copy(&mut encoder, lane.cast.buffers.of(answer.0), 0, answer.1 * row as u64);
        lane.sent = Some((rays, gpu.queue.submit([encoder.finish()])));
    }

    /// Writes the records of rays, all first ones before all second ones.
    fn write(
        &self,
        lane: &mut Lane,
        (rays, row): (Range<usize>, usize),
        ray: &(impl Fn(usize) -> (StreamRay, Measure) + Sync),
    ) -> Result<()> {
        let failed = |error: wgpu::MapRangeError| Error::DeviceFailed {
            device: self.gpu.report.name.clone(),
            message: format!("a buffer can't be written: {error}"),
        };
        let mut view = lane.upload.get_mapped_range_mut(..32 * row as u64).map_err(failed)?;
        let (pieces, _) = view.slice(..).into_chunks::<BYTES>();
        let (firsts, seconds) = pieces.split_at(row / PIECE);
        let pieces: Vec<_> = firsts.into_iter().zip(seconds).collect();
        let tasks = pieces.into_par_iter().with_min_len(PIECES).zip(lane.measures.par_chunks_mut(PIECE)).enumerate();
        tasks.for_each(|(piece, ((firsts, seconds), measures))| {
            let (mut first, mut second) = ([UVec4::ZERO; PIECE], [UVec4::ZERO; PIECE]);
            for (i, measure) in measures.iter_mut().enumerate() {
                let number = rays.start + PIECE * piece + i;
                let (of, own) = if number < rays.end { ray(number) } else { (StreamRay::AWAY, Measure::default()) };
                *measure = own;
                first[i] = pack(of.origin, of.source_primitive);
                second[i] = pack(of.direction, of.limit.to_bits());
            }
            firsts.write(bytemuck::cast(first));
            seconds.write(bytemuck::cast(second));
        });
        drop(view);
        lane.upload.unmap();
        Ok(())
    }

    /// Waits for what a lane has sent, if anything, and tells of it.
    fn receive<E: From<Error>>(
        &self,
        lane: &mut Lane,
        answer: (u32, u64),
        tell: &mut Tell<'_, E>,
    ) -> std::result::Result<(), E> {
        let Some((rays, submission)) = lane.sent.take() else { return Ok(()) };
        let row = lane.cast.count as usize;
        let size = answer.1 * row as u64;
        // The GPU is done with it then, too.
        lane.upload.map_async(wgpu::MapMode::Write, .., |_| {});
        lane.back
            .receive(&self.gpu, submission, size, |bytes| tell(Chunk { measures: &lane.measures, rays, bytes, row }))?
    }
}
