//! The thin entry points: buffers to stages, nothing else.
//!
//! What any stage writes is declared writable by all, since the stages share one layout and naga wants
//! its accesses to match.

use crate::buffer::{read, write};
use crate::data::{Bounds, CwbvhNode, Features, Frame, Light, Material, Normals, Tuning};
use crate::launch::{ROW, WORKGROUP, counter};
use crate::numerics;
use crate::real::Fast;
use crate::scene::{Geometry, Looks};
use crate::stage::{self, Asking, Wave};
use crate::traverse::{
    Closest, Cut, CwbvhMethod, Hybrid, IfIf, Interleaved, Occlusion, Packet, Sequential, Speculative, StackMax,
    WhileWhile,
};
use crate::warp::{Alone, Subgroup, take};
use glam::{UVec3, UVec4};
use spirv_std::arch::{IndexUnchecked, atomic_i_add};
use spirv_std::memory::{Scope, Semantics};
use spirv_std::spirv;

/// What a slot index beyond the wave stands for.
const IDLE: u32 = u32::MAX;

/// How many slots the wave has: those of the launch in the first wave, those of the queue later.
#[inline(always)]
fn slots(features: Features, frame: &Frame, counters: &[u32]) -> u32 {
    if features.has(Features::SECONDARY) { read(counters, counter::COUNT) } else { frame.limits.z }
}

/// The number of a thread that follows a ray: in a stream it may be in a further row.
#[inline(always)]
fn thread(features: Features, id: UVec3) -> u32 {
    if features.has(Features::STREAM) { id.y * ROW + id.x } else { id.x }
}

/// The slot of a thread: its own number in the first wave, an entry of the queue later.
#[inline(always)]
fn slot(features: Features, frame: &Frame, thread: u32, queue: &[u32], counters: &[u32]) -> u32 {
    if thread < slots(features, frame, counters) { queued(features, thread, queue) } else { IDLE }
}

/// The slot of a wave's ray by its number.
#[inline(always)]
fn queued(features: Features, number: u32, queue: &[u32]) -> u32 {
    if features.has(Features::SECONDARY) { read(queue, number) } else { number }
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
    write(counters, counter::TRACED, 0);
    write(counters, counter::ASKED, 0);
    let rays = read(counters, counter::RAYS);
    write(counters, counter::RAYS, rays.wrapping_add(count));
}

/// The stages of one precision that follow no ray.
macro_rules! shading_entries {
    ($real:ty, $shade:ident, $advance:ident) => {
        /// Shades the slots of a wave.
        #[spirv(compute(threads(64)))]
        pub fn $shade(
            #[spirv(global_invocation_id)] id: UVec3,
            #[spirv(spec_constant(id = 1, default = 0))] features: u32,
            #[spirv(uniform, descriptor_set = 0, binding = 0)] frame: &Frame,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] nodes: &[UVec4],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] triangles: &[UVec4],
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
            #[spirv(storage_buffer, descriptor_set = 0, binding = 13)] wide: &[CwbvhNode],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 14)] bounds: &[Bounds],
        ) {
            let features = Features(features);
            let slot = slot(features, frame, id.x, queue, counters);
            if slot == IDLE {
                return;
            }
            let geometry = Geometry { frame, features, tuning: Tuning(0), nodes, wide, triangles, bounds };
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
            #[spirv(global_invocation_id)] id: UVec3,
            #[spirv(spec_constant(id = 1, default = 0))] features: u32,
            #[spirv(spec_constant(id = 2, default = 0))] tuning: u32,
            #[spirv(uniform, descriptor_set = 0, binding = 0)] frame: &Frame,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] nodes: &[UVec4],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] triangles: &[UVec4],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] paths: &mut [UVec4],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 7)] hits: &mut [UVec4],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 10)] queue: &mut [u32],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 12)] counters: &mut [u32],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 13)] wide: &[CwbvhNode],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 14)] bounds: &[Bounds],
        ) {
            let features = Features(features);
            let slot = slot(features, frame, thread(features, id), queue, counters);
            if slot == IDLE {
                return;
            }
            let geometry = Geometry { frame, features, tuning: Tuning(tuning), nodes, wide, triangles, bounds };
            write(hits, slot, stage::trace::<$real, $method>(&geometry, slot, paths));
        }

        /// Traces the shadow rays of a wave: one row of threads a light.
        #[spirv(compute(threads(64)))]
        pub fn $shadow(
            #[spirv(global_invocation_id)] id: UVec3,
            #[spirv(spec_constant(id = 1, default = 0))] features: u32,
            #[spirv(spec_constant(id = 2, default = 0))] tuning: u32,
            #[spirv(uniform, descriptor_set = 0, binding = 0)] frame: &Frame,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] nodes: &[UVec4],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] triangles: &[UVec4],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] lights: &[Light],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] paths: &mut [UVec4],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 7)] hits: &mut [UVec4],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 8)] shadows: &mut [u32],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 10)] queue: &mut [u32],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 12)] counters: &mut [u32],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 13)] wide: &[CwbvhNode],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 14)] bounds: &[Bounds],
        ) {
            let features = Features(features);
            let slot = slot(features, frame, thread(features, id), queue, counters);
            if slot == IDLE {
                return;
            }
            let geometry = Geometry { frame, features, tuning: Tuning(tuning), nodes, wide, triangles, bounds };
            let light = if features.has(Features::STREAM) { 0 } else { id.y };
            let answer = stage::shadow::<$real, $method>(&geometry, Asking { lights, paths, hits }, slot, light);
            write(shadows, light * geometry.slots() + slot, answer);
        }
    };
}

/// The stages of one precision that follow rays, by one method, in persistent subgroups.
macro_rules! persistent_entries {
    ($real:ty, $method:ty, $trace:ident, $shadow:ident) => {
        /// Traces the rays of a wave.
        #[spirv(compute(threads(64)))]
        pub fn $trace(
            #[spirv(subgroup_local_invocation_id)] lane: u32,
            #[spirv(spec_constant(id = 1, default = 0))] features: u32,
            #[spirv(spec_constant(id = 2, default = 0))] tuning: u32,
            #[spirv(uniform, descriptor_set = 0, binding = 0)] frame: &Frame,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] nodes: &[UVec4],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] triangles: &[UVec4],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] paths: &mut [UVec4],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 7)] hits: &mut [UVec4],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 10)] queue: &mut [u32],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 12)] counters: &mut [u32],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 13)] wide: &[CwbvhNode],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 14)] bounds: &[Bounds],
        ) {
            let features = Features(features);
            let geometry = Geometry { frame, features, tuning: Tuning(tuning), nodes, wide, triangles, bounds };
            let (count, paths, queue) = (slots(features, frame, counters), &*paths, &*queue);
            stage::persistent::<$real, $method, Closest, Subgroup>(
                &geometry,
                count,
                move |wants| take(wants, lane, counters, counter::TRACED),
                move |number| (stage::traced::<$real>(&geometry, queued(features, number, queue), paths), true),
                move |number, _, ray, hit| {
                    write(hits, queued(features, number, queue), stage::found(&geometry, ray, hit));
                },
            );
        }

        /// Traces the shadow rays of a wave, light after light.
        #[spirv(compute(threads(64)))]
        pub fn $shadow(
            #[spirv(subgroup_local_invocation_id)] lane: u32,
            #[spirv(spec_constant(id = 1, default = 0))] features: u32,
            #[spirv(spec_constant(id = 2, default = 0))] tuning: u32,
            #[spirv(uniform, descriptor_set = 0, binding = 0)] frame: &Frame,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] nodes: &[UVec4],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] triangles: &[UVec4],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] lights: &[Light],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] paths: &mut [UVec4],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 7)] hits: &mut [UVec4],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 8)] shadows: &mut [u32],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 10)] queue: &mut [u32],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 12)] counters: &mut [u32],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 13)] wide: &[CwbvhNode],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 14)] bounds: &[Bounds],
        ) {
            let features = Features(features);
            let geometry = Geometry { frame, features, tuning: Tuning(tuning), nodes, wide, triangles, bounds };
            let asking = Asking { lights, paths: &*paths, hits: &*hits };
            let (count, queue) = (slots(features, frame, counters), &*queue);
            // A launch without slots takes no number; the guard spares the division's panic.
            let row = if count == 0 { 1 } else { count };
            let rows = if features.has(Features::STREAM) { 1 } else { geometry.light_count() };
            stage::persistent::<$real, $method, Occlusion, Subgroup>(
                &geometry,
                count * rows,
                move |wants| take(wants, lane, counters, counter::ASKED),
                move |number| stage::asked(&geometry, asking, queued(features, number % row, queue), number / row),
                move |number, traced, _, hit| {
                    let answer = if traced { stage::answered(hit) } else { stage::FACES_AWAY };
                    let slot = queued(features, number % row, queue);
                    write(shadows, number / row * geometry.slots() + slot, answer);
                },
            );
        }
    };
}

/// Evaluates functions of exact arithmetic for tests, one a thread.
#[spirv(compute(threads(64)))]
pub fn numerics_evaluate(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] operations: &[UVec4],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] values: &mut [u32],
) {
    if id.x < values.len() as u32 {
        write(values, id.x, numerics::evaluate(read(operations, id.x)));
    }
}

shading_entries!(f32, exact_shade, exact_advance);
shading_entries!(Fast, fast_shade, fast_advance);

/// Both precisions of a method, a thread a ray.
macro_rules! grid {
    ($($method:ty: $exact:ident $exact_shadow:ident $fast:ident $fast_shadow:ident;)*) => {
        $(
            tracing_entries!(f32, $method, $exact, $exact_shadow);
            tracing_entries!(Fast, $method, $fast, $fast_shadow);
        )*
    };
}

/// Both precisions of a method, in persistent subgroups.
macro_rules! persistent {
    ($($method:ty: $exact:ident $exact_shadow:ident $fast:ident $fast_shadow:ident;)*) => {
        $(
            persistent_entries!(f32, $method, $exact, $exact_shadow);
            persistent_entries!(Fast, $method, $fast, $fast_shadow);
        )*
    };
}

grid! {
    IfIf: exact_trace_if_if exact_shadow_if_if fast_trace_if_if fast_shadow_if_if;
    WhileWhile<Alone>: exact_trace_while_while exact_shadow_while_while fast_trace_while_while fast_shadow_while_while;
    CwbvhMethod: exact_trace_wide exact_shadow_wide fast_trace_wide fast_shadow_wide;
    Packet<Subgroup>:
        subgroup_exact_trace_packet subgroup_exact_shadow_packet
        subgroup_fast_trace_packet subgroup_fast_shadow_packet;
    Speculative<Subgroup>:
        subgroup_exact_trace_speculative subgroup_exact_shadow_speculative
        subgroup_fast_trace_speculative subgroup_fast_shadow_speculative;
    Hybrid<Subgroup, StackMax, Sequential>:
        subgroup_exact_trace_sequential_stack subgroup_exact_shadow_sequential_stack
        subgroup_fast_trace_sequential_stack subgroup_fast_shadow_sequential_stack;
    Hybrid<Subgroup, Cut, Sequential>:
        subgroup_exact_trace_sequential_cut subgroup_exact_shadow_sequential_cut
        subgroup_fast_trace_sequential_cut subgroup_fast_shadow_sequential_cut;
    Hybrid<Subgroup, StackMax, Interleaved>:
        subgroup_exact_trace_interleaved_stack subgroup_exact_shadow_interleaved_stack
        subgroup_fast_trace_interleaved_stack subgroup_fast_shadow_interleaved_stack;
    Hybrid<Subgroup, Cut, Interleaved>:
        subgroup_exact_trace_interleaved_cut subgroup_exact_shadow_interleaved_cut
        subgroup_fast_trace_interleaved_cut subgroup_fast_shadow_interleaved_cut;
}

persistent! {
    IfIf:
        subgroup_exact_trace_if_if_persistent subgroup_exact_shadow_if_if_persistent
        subgroup_fast_trace_if_if_persistent subgroup_fast_shadow_if_if_persistent;
    WhileWhile<Subgroup>:
        subgroup_exact_trace_while_while_persistent subgroup_exact_shadow_while_while_persistent
        subgroup_fast_trace_while_while_persistent subgroup_fast_shadow_while_while_persistent;
    CwbvhMethod:
        subgroup_exact_trace_wide_persistent subgroup_exact_shadow_wide_persistent
        subgroup_fast_trace_wide_persistent subgroup_fast_shadow_wide_persistent;
}
