//! The thin entry points: buffers to stages, nothing else.
//!
//! What any stage writes is declared writable by all, since the stages share one layout and naga wants
//! its accesses to match.

use crate::buffer::{read, write};
use crate::data::{Features, Frame, Light, Material, NodePair, Normals, Triangle};
use crate::launch::{WORKGROUP, counter};
use crate::real::Fast;
use crate::scene::{Geometry, Looks};
use crate::stage::{self, Wave};
use crate::traverse::{IfIf, Packet};
use crate::warp::Subgroup;
use glam::{UVec3, UVec4};
use spirv_std::arch::{IndexUnchecked, atomic_i_add};
use spirv_std::memory::{Scope, Semantics};
use spirv_std::spirv;

/// What a slot index beyond the wave stands for.
const IDLE: u32 = u32::MAX;

/// The slot of a thread: its own number in the first wave, an entry of the queue later.
#[inline(always)]
fn slot(features: Features, frame: &Frame, thread: u32, queue: &[u32], counters: &[u32]) -> u32 {
    if features.has(Features::SECONDARY) {
        if thread < read(counters, counter::COUNT) { read(queue, thread) } else { IDLE }
    } else if thread < frame.limits.z {
        thread
    } else {
        IDLE
    }
}

/// Adds a slot to the next wave.
#[inline(always)]
fn enqueue(slot: u32, next: &mut [u32], counters: &mut [u32]) {
    // SAFETY: the host sizes the counters and gives the next wave room for every slot.
    let place = unsafe {
        let count = counters.index_unchecked_mut(counter::NEXT as usize);
        atomic_i_add::<u32, { Scope::QueueFamily as u32 }, { Semantics::NONE.bits() }>(count, 1)
    };
    write(next, place, slot);
}

/// The arguments of an indirect dispatch.
#[inline(always)]
fn dispatch(at: u32, groups_x: u32, groups_y: u32, counters: &mut [u32]) {
    write(counters, at, groups_x);
    write(counters, at + 1, groups_y);
    write(counters, at + 2, 1);
}

/// Starts the next wave: its count, its dispatches, and the rays so far.
#[inline(always)]
fn advance(lights: u32, counters: &mut [u32]) {
    let count = read(counters, counter::NEXT);
    let groups = count.div_ceil(WORKGROUP);
    dispatch(counter::SLOTS, groups, 1, counters);
    dispatch(counter::SHADOWS, groups, lights, counters);
    write(counters, counter::COUNT, count);
    write(counters, counter::NEXT, 0);
    let rays = read(counters, counter::RAYS);
    write(counters, counter::RAYS, rays.wrapping_add(count));
}

/// The stages of one precision that follow no ray.
macro_rules! shading_entries {
    ($real:ty, $shade:ident, $advance:ident) => {
        /// Shades the slots of a wave.
        #[spirv(compute(threads(64)))]
        pub fn $shade(
            #[spirv(global_invocation_id)] id: UVec3, #[spirv(spec_constant(id = 1, default = 0))] features: u32,
            #[spirv(uniform, descriptor_set = 0, binding = 0)] frame: &Frame,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] nodes: &[NodePair],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] triangles: &[Triangle],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] normals: &[Normals],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] materials: &[Material],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] lights: &[Light],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] paths: &mut [UVec4],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 7)] hits: &mut [UVec4],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 8)] shadows: &mut [u32],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 9)] film: &mut [UVec4],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 10)] queue: &mut [u32],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 11)] next: &mut [u32],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 12)] counters: &mut [u32],
        ) {
            let features = Features(features);
            let slot = slot(features, frame, id.x, queue, counters);
            if slot == IDLE {
                return;
            }
            let geometry = Geometry { frame, features, nodes, triangles };
            let looks = Looks { normals, materials, lights };
            let wave = Wave { paths, hits, shadows, film };
            if stage::shade::<$real>(&geometry, &looks, slot, wave) {
                enqueue(slot, next, counters);
            }
        }

        /// Turns to the next wave; one thread.
        #[spirv(compute(threads(1)))]
        pub fn $advance(
            #[spirv(uniform, descriptor_set = 0, binding = 0)] frame: &Frame,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 12)] counters: &mut [u32],
        ) {
            advance(frame.top.w, counters);
        }
    };
}

/// The stages of one precision that follow rays, by one method.
macro_rules! tracing_entries {
    ($real:ty, $method:ty, $trace:ident, $shadow:ident) => {
        /// Traces the rays of a wave.
        #[spirv(compute(threads(64)))]
        pub fn $trace(
            #[spirv(global_invocation_id)] id: UVec3, #[spirv(spec_constant(id = 1, default = 0))] features: u32,
            #[spirv(uniform, descriptor_set = 0, binding = 0)] frame: &Frame,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] nodes: &[NodePair],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] triangles: &[Triangle],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] paths: &mut [UVec4],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 7)] hits: &mut [UVec4],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 10)] queue: &mut [u32],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 12)] counters: &mut [u32],
        ) {
            let features = Features(features);
            let slot = slot(features, frame, id.x, queue, counters);
            if slot == IDLE {
                return;
            }
            let geometry = Geometry { frame, features, nodes, triangles };
            write(hits, slot, stage::trace::<$real, $method>(&geometry, slot, paths));
        }

        /// Traces the shadow rays of a wave: one row of threads a light.
        #[spirv(compute(threads(64)))]
        pub fn $shadow(
            #[spirv(global_invocation_id)] id: UVec3, #[spirv(spec_constant(id = 1, default = 0))] features: u32,
            #[spirv(uniform, descriptor_set = 0, binding = 0)] frame: &Frame,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] nodes: &[NodePair],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] triangles: &[Triangle],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] lights: &[Light],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] paths: &mut [UVec4],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 7)] hits: &mut [UVec4],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 8)] shadows: &mut [u32],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 10)] queue: &mut [u32],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 12)] counters: &mut [u32],
        ) {
            let features = Features(features);
            let slot = slot(features, frame, id.x, queue, counters);
            if slot == IDLE {
                return;
            }
            let geometry = Geometry { frame, features, nodes, triangles };
            let answer = stage::shadow::<$real, $method>(&geometry, lights, slot, id.y, paths, hits);
            write(shadows, id.y * geometry.slots() + slot, answer);
        }
    };
}

shading_entries!(f32, exact_shade, exact_advance);
shading_entries!(Fast, fast_shade, fast_advance);
tracing_entries!(f32, IfIf, exact_trace_if_if, exact_shadow_if_if);
tracing_entries!(Fast, IfIf, fast_trace_if_if, fast_shadow_if_if);
tracing_entries!(f32, Packet<Subgroup>, subgroup_exact_trace_packet, subgroup_exact_shadow_packet);
tracing_entries!(Fast, Packet<Subgroup>, subgroup_fast_trace_packet, subgroup_fast_shadow_packet);
