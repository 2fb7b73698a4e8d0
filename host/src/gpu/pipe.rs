//! Rays through a GPU, chunk after chunk: while one is traced, the next is packed and the one before is told of.

use std::collections::{HashMap, VecDeque};
use std::ops::Range;
use std::sync::{Arc, PoisonError};

use eyerays_shader::resources::binding;
use glam::UVec4;
use rayon::prelude::*;
use wgpu::BufferUsages as Use;

use super::cast::{Cast, Caster};
use super::kernel::Kernel;
use super::readback::Readback;
use crate::batch::{Measure, Placed, Rays, place};
use crate::error::{Error, Result};
use crate::method::Traversal;
use crate::stream::Question;

/// The fewest and the most rays of a chunk: enough for a GPU and for the threads that write them, and no more than caches hold of them.
const CHUNK: (usize, usize) = (1 << 16, 1 << 19);
/// Rays that a thread packs at once, whose records are in its nearest cache. Chunks are filled up to whole pieces by rays that meet nothing.
const PIECE: usize = 1 << 8;
/// Pieces that are worth a thread.
const PIECES: usize = 8;
/// Bytes of half of their records.
const BYTES: usize = 16 * PIECE;
/// Chunks on their way at once: one is written, one is sent, one is traced and one is told of.
const LANES: usize = 4;

/// What a chunk takes of memory on both sides. To take it takes longer than to trace a million rays, so a caster keeps it.
pub(super) struct Lane {
    cast: Cast,
    upload: wgpu::Buffer,
    back: Readback,
    measures: Vec<Measure>,
    groups: HashMap<Question, wgpu::BindGroup>,
    /// The rays that were written, and how many records there are of them, with those that fill the last piece.
    rays: Range<usize>,
    row: usize,
    /// What is on its way.
    sent: Option<wgpu::SubmissionIndex>,
}

/// What the rays of a call are asked.
struct Asking {
    question: Question,
    kernel: Arc<Kernel>,
    /// Where the answers are, and their bytes.
    binding: u32,
    bytes: u64,
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
pub(crate) type Tell<'t> = dyn FnMut(Chunk<'_>) + Send + 't;

impl Caster {
    /// Answers a question of `count` rays, told of in their order by `threads`; who hears how many are is called by the thread that asks.
    ///
    /// # Errors
    /// What the GPU reports, or who hears.
    pub(crate) fn ask<E: From<Error>>(
        &self,
        question: Question,
        (count, rays): (usize, &impl Rays),
        threads: &rayon::ThreadPool,
        tell: &mut Tell<'_>,
        heard: &mut dyn FnMut(usize) -> std::result::Result<(), E>,
    ) -> std::result::Result<(), E> {
        let asking = self.asking(question)?;
        // All lanes have one, if there are rays for that.
        let chunk = count.div_ceil(LANES).next_multiple_of(PIECE).clamp(CHUNK.0, CHUNK.1);
        let mut free = self.lanes(count, chunk)?;
        let (mut written, mut sent): (Option<Lane>, VecDeque<Lane>) = (None, VecDeque::new());
        for start in (0..count).step_by(chunk) {
            let mut lane = free.pop().expect("a lane is told of before the next is written");
            let write = || self.write(&mut lane, start..count.min(start + chunk), rays);
            let others = || {
                sent.extend(written.take().map(|lane| self.sent(&asking, lane)));
                let oldest = if free.is_empty() { sent.pop_front() } else { None };
                oldest.map(|lane| self.received(&asking, lane, tell)).transpose()
            };
            // While the rays of a chunk are written, those before it are sent, and others told of.
            let (is_written, received) = threads.install(|| rayon::join(write, others));
            is_written?;
            if let Some(lane) = received? {
                heard(lane.rays.end)?;
                free.push(lane);
            }
            written = Some(lane);
        }
        sent.extend(written.map(|lane| self.sent(&asking, lane)));
        for lane in sent {
            let lane = threads.install(|| self.received(&asking, lane, tell))?;
            heard(lane.rays.end)?;
            free.push(lane);
        }
        // Of a call that fails they are thrown away, with what is on its way.
        let mut idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner);
        idle.extend(free);
        idle.truncate(LANES);
        Ok(())
    }

    fn asking(&self, question: Question) -> Result<Asking> {
        let kernel = self.kernel(true, Traversal::default(), question)?;
        let (binding, bytes) = match question {
            Question::Closest => (binding::HITS, 16 * self.rows()),
            Question::Occlusion => (binding::SHADOWS, 4),
        };
        Ok(Asking { question, kernel, binding, bytes })
    }

    /// As many lanes as so many rays fill, a chunk each.
    fn lanes(&self, count: usize, chunk: usize) -> Result<Vec<Lane>> {
        let (wanted, most) = (count.div_ceil(chunk).min(LANES), count.min(chunk).next_multiple_of(PIECE));
        let mut lanes: Vec<Lane> = {
            let mut idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner);
            idle.retain(|lane| lane.measures.len() >= most);
            let kept = idle.len().min(wanted);
            idle.drain(..kept).collect()
        };
        while lanes.len() < wanted {
            lanes.push(self.lane(most)?);
        }
        Ok(lanes)
    }

    fn lane(&self, most: usize) -> Result<Lane> {
        // Its frame is still to be written.
        let cast = Cast { count: 0, ..self.room(most)? };
        let upload = self.gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("rays"),
            size: 32 * most as u64,
            usage: Use::MAP_WRITE | Use::COPY_SRC,
            mapped_at_creation: true,
        });
        let back = Readback::new(&self.gpu, 16 * self.rows() * most as u64);
        self.gpu.check()?;
        let measures = vec![Measure::default(); most];
        Ok(Lane { cast, upload, back, measures, groups: HashMap::new(), rays: 0..0, row: 0, sent: None })
    }

    /// A lane whose rays the GPU is asked.
    fn sent(&self, asking: &Asking, mut lane: Lane) -> Lane {
        let (gpu, row) = (&self.gpu, lane.row);
        if lane.cast.count as usize != row {
            let frame = self.packed.stream_frame(row);
            gpu.queue.write_buffer(lane.cast.buffers.of(binding::FRAME), 0, bytemuck::bytes_of(&frame));
            lane.cast.count = row as u32;
        }
        let group = lane.groups.entry(asking.question).or_insert_with(|| self.group(&lane.cast, &asking.kernel));
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let paths = lane.cast.buffers.of(binding::PATHS);
        encoder.copy_buffer_to_buffer(&lane.upload, 0, paths, 0, 32 * row as u64);
        lane.cast.dispatch(&mut encoder, (&asking.kernel, group), None);
        lane.back.copy(&mut encoder, lane.cast.buffers.of(asking.binding), 0, asking.bytes * row as u64);
        lane.sent = Some(gpu.queue.submit([encoder.finish()]));
        lane
    }

    /// Writes the records of rays, all first ones before all second ones.
    fn write(&self, lane: &mut Lane, range: Range<usize>, rays: &impl Rays) -> Result<()> {
        let row = range.len().next_multiple_of(PIECE);
        (lane.rays, lane.row) = (range.clone(), row);
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
            let of_piece = range.end.min(range.start + PIECE * piece)..range.end;
            let to = Placed { firsts: &mut first, seconds: &mut second, measures };
            place(self.packed.normalisation(), rays, of_piece, to);
            firsts.write(bytemuck::cast(first));
            seconds.write(bytemuck::cast(second));
        });
        drop(view);
        lane.upload.unmap();
        Ok(())
    }

    /// A lane that was waited for, and told of.
    fn received(&self, asking: &Asking, mut lane: Lane, tell: &mut Tell<'_>) -> Result<Lane> {
        let Lane { upload, back, measures, rays, row, sent, .. } = &mut lane;
        if let Some(submission) = sent.take() {
            let (rays, row) = (rays.clone(), *row);
            // The GPU is done with it then, too.
            upload.map_async(wgpu::MapMode::Write, .., |_| {});
            let size = asking.bytes * row as u64;
            back.receive(&self.gpu, submission, size, |bytes| tell(Chunk { rays, measures, bytes, row }))?;
        }
        Ok(lane)
    }
}
