//! The rays of a block of pixels, as a launch has them in memory.

use eyerays_kernels_cpu::Records;
use eyerays_shader::camera;
use eyerays_shader::data::Order;
use eyerays_shader::ray::{Hit, Ray};
use eyerays_shader::real::{F32xN, U32xN, V3};
use eyerays_shader::scene::TraceContext;
use eyerays_shader::stage::{Found, Segment};

/// Rays of a block, and of a packet: a subgroup of most GPUs, whatever vectors the CPU has.
pub(super) const LANES: usize = 32;

/// A limit that no box lies before, of lanes without a ray.
const NOWHERE: f32 = -1.0;

/// The rays of a block of 8x4 pixels, by lane.
pub(super) struct Block {
    rays: [Ray<f32>; LANES],
    limits: [f32; LANES],
    /// A bit for each lane that has a ray.
    pub lanes: u32,
}

impl Block {
    /// The block of some slots of a launch that has traced them: one or more of the same block.
    pub fn of(scene: &TraceContext<'_>, slots: &[u32], records: &Records<f32>) -> Block {
        let ray = |slot: u32| {
            let time = Found::<f32>::load(&scene.base, slot, &records.hits).time;
            let segment = Segment::<f32>::load(scene.base.frame.slots, slot, &records.paths);
            (segment.ray().at(time), segment.limit)
        };
        let mut block = Block { rays: [ray(slots[0]).0; LANES], limits: [NOWHERE; LANES], lanes: 0 };
        for &slot in slots {
            let lane = slot as usize % LANES;
            (block.rays[lane], block.limits[lane]) = ray(slot);
            block.lanes |= 1 << lane;
        }
        block
    }

    /// The ray of a lane, and its limit.
    pub fn ray(&self, lane: usize) -> (Ray<f32>, f32) {
        (self.rays[lane], self.limits[lane])
    }

    /// The lanes that have rays.
    pub fn each(&self) -> impl Iterator<Item = usize> + use<> {
        let lanes = self.lanes;
        (0..LANES).filter(move |lane| lanes >> lane & 1 == 1)
    }

    /// All rays as one packet, and their limits.
    pub fn packet(&self) -> (Ray<F32xN<LANES>>, Hit<F32xN<LANES>>) {
        let origin = V3::of_lanes(|i| self.rays[i].origin);
        let direction = V3::of_lanes(|i| self.rays[i].direction);
        let source = U32xN(self.rays.map(|ray| ray.source_primitive));
        (Ray::leaving(source, origin, direction).at(self.rays[0].time), Hit::none(F32xN(self.limits)))
    }
}

/// The order of pixels in which slots of a block follow each other.
pub(super) const ORDER: Order = Order(0);

/// Columns and rows of a block.
pub(super) fn size() -> (u32, u32) {
    camera::blocks(ORDER)
}

#[cfg(test)]
impl Block {
    /// Rays from zero.
    pub fn along(directions: impl Fn(usize) -> glam::Vec3) -> Block {
        let ray = |lane| Ray::new(V3::zero(), V3::splat(directions(lane)));
        Block { rays: std::array::from_fn(ray), limits: [f32::MAX; LANES], lanes: u32::MAX }
    }
}
