//! Every kernel, and what they share beside stages.

use crate::buffer::{read, write};
use crate::camera;
use crate::data::*;
use crate::integrator::{self, Exchange, ScatterContext, Wave};
use crate::launch::{ROW, WORKGROUP, argument, counter};
use crate::light::Lighting;
use crate::material::Albedos;
use crate::photon::{self, Casters, Photons};
use crate::real::Scalar;
use crate::resources::resources;
use crate::scene::{LaunchContext, ShadingData, TraceContext};
use crate::stage::{self, CameraTables, ShadowInputs, TransmitInputs};
use crate::texture::Textures;
use crate::traverse::{
    Closest, Cut, Cutout, CwbvhMethod, Hybrid, IfIf, Interleaved, Occlusion, Packet, Primitives, Sequential,
    Speculative, StackMax, WhileWhile,
};
use crate::warp::{Alone, Subgroup, append, take};
use glam::{UVec3, UVec4};
use spirv_std::arch::{IndexUnchecked, atomic_exchange, atomic_i_add};
use spirv_std::memory::{Scope, Semantics};
use spirv_std::spirv;

/// The slot of a thread that has none, since the wave has fewer.
const IDLE: u32 = u32::MAX;

/// How many slots the wave has: those of the launch in the first wave, those of the queue later.
#[inline(always)]
fn slots(spec: Specialisation, frame: &Frame, counters: &[u32]) -> u32 {
    if spec.launch.has(Launch::SECONDARY) { read(counters, counter::COUNT) } else { frame.slots }
}

/// The number of a thread that follows a ray: in a stream it may be in a further row.
#[inline(always)]
fn thread(spec: Specialisation, id: UVec3) -> u32 {
    if spec.launch.has(Launch::STREAM) { id.y * ROW + id.x } else { id.x }
}

/// The slot of a thread: its own number in the first wave, an entry of the queue later.
#[inline(always)]
fn slot(spec: Specialisation, frame: &Frame, thread: u32, queue: &[u32], counters: &[u32]) -> u32 {
    if thread < slots(spec, frame, counters) { queued(spec, thread, queue) } else { IDLE }
}

/// The slot of a wave's ray by its number.
#[inline(always)]
fn queued(spec: Specialisation, number: u32, queue: &[u32]) -> u32 {
    if spec.launch.has(Launch::SECONDARY) { read(queue, number) } else { number }
}

/// Adds a slot that goes on to the next wave: by an atomic of its own, or the slots of a subgroup take their places at once.
#[inline(always)]
fn enqueue(spec: Specialisation, goes_on: bool, slot: u32, next: &mut [u32], counters: &mut [u32]) {
    let position = if spec.launch.has(Launch::SUBGROUPS) {
        append(goes_on, counters, counter::NEXT)
    } else if goes_on {
        // SAFETY: the host sizes the counters.
        unsafe {
            let count = counters.index_unchecked_mut(counter::NEXT as usize);
            atomic_i_add::<u32, { Scope::QueueFamily as u32 }, { Semantics::NONE.bits() }>(count, 1)
        }
    } else {
        0
    };
    if goes_on {
        write(next, position, slot);
    }
}

/// Gives a list another first entry, and returns the one before.
#[inline(always)]
fn exchange(heads: &mut [u32], list: u32, first: u32) -> u32 {
    // SAFETY: the host tells no more lists than there are words.
    unsafe {
        let head = heads.index_unchecked_mut(list as usize);
        atomic_exchange::<u32, { Scope::QueueFamily as u32 }, { Semantics::NONE.bits() }>(head, first)
    }
}

/// Starts the next wave: its count, the widths of its dispatches, and what has been traced so far.
#[inline(always)]
fn advance_wave(counters: &mut [u32], arguments: &mut [u32]) {
    let count = read(counters, counter::NEXT);
    let groups = count.div_ceil(WORKGROUP);
    write(arguments, argument::SLOTS, groups);
    write(arguments, argument::SHADOWS, groups);
    write(counters, counter::COUNT, count);
    write(counters, counter::NEXT, 0);
    write(counters, counter::TRACED, 0);
    write(counters, counter::ASKED, 0);
    let waves = read(counters, counter::WAVES);
    write(counters, counter::WAVES, if count > 0 { waves + 1 } else { waves });
    let rays = read(counters, counter::RAYS);
    write(counters, counter::RAYS, rays.wrapping_add(count));
}

resources!(declare_entry $);

/// The kernels of the methods of one precision: those whose lanes are alone, those whose lanes vote, or persistent ones.
macro_rules! methods {
    ([$only:ident $R:ty] $($(#[$doc:meta])* $variant:ident $module:ident $name:literal:
        gpu($lanes:ident, $method:ty), persistent($($persistent:ty)?), cpu($($cpu:tt)*);)*) => {
        $(methods! { @$only $lanes $R, $module, $method, $($persistent)? })*
    };
    (@alone alone $R:ty, $module:ident, $method:ty, $($persistent:ty)?) => {
        /// A method.
        pub mod $module {
            use super::*;
            tracing!($R, $method);
        }
    };
    (@subgroup subgroup $R:ty, $module:ident, $method:ty,) => {
        /// A method.
        pub mod $module {
            use super::*;
            tracing!($R, $method);
        }
    };
    (@persistent $lanes:ident $R:ty, $module:ident, $method:ty, $persistent:ty) => {
        /// A method.
        pub mod $module {
            use super::*;
            persistent_tracing!($R, $persistent);
        }
    };
    (@$($other:tt)*) => {};
}

/// A precision's kernels, those that always vote apart: a device without subgroups takes the others.
macro_rules! precision {
    ($R:ty, $alone:ident, $subgroup:ident $(, $more:ident)?) => {
        /// Kernels whose lanes need not hear of each other.
        pub mod $alone {
            use super::*;
            shading!($R);
            $($more!($R);)?
            crate::for_each_method!(methods alone $R);
        }
        /// Kernels whose lanes vote.
        pub mod $subgroup {
            use super::*;
            crate::for_each_method!(methods subgroup $R);
            /// Kernels of persistent subgroups.
            pub mod persistent {
                use super::*;
                crate::for_each_method!(methods persistent $R);
            }
        }
    };
}

#[cfg(feature = "exact")]
precision!(f32, exact, subgroup_exact, asking);
#[cfg(feature = "fast")]
precision!(crate::real::Fast, fast, subgroup_fast);

/// What tests run.
#[cfg(feature = "exact")]
pub mod numerics {
    use super::*;

    /// Evaluates functions of exact arithmetic, one a thread.
    #[spirv(compute(threads(64)))]
    pub fn evaluate(
        #[spirv(global_invocation_id)] id: UVec3,
        #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] operations: &[UVec4],
        #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] values: &mut [u32],
    ) {
        if id.x < values.len() as u32 {
            write(values, id.x, crate::numerics::evaluate(read(operations, id.x)));
        }
    }
}

#[cfg(feature = "exact")]
pub mod refit;
#[cfg(feature = "exact")]
pub mod screen;
