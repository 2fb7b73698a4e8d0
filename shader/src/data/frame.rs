//! What changes from launch to launch.

use super::{Camera, Launch};
use crate::medium::Inside;
use crate::real::{Real, SMALL, Scalar};
use bytemuck::{Pod, Zeroable};
use glam::UVec4;

/// What a launch renders: samples of every pixel of a region. Its uniform buffer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Frame {
    /// Where rays come from and how they spread over the image.
    pub camera: Camera,
    /// Background at the horizon and below, linear RGB.
    pub horizon: UVec4,
    /// Background straight up, linear RGB.
    pub zenith: UVec4,
    /// The middle of a box around all light that rays find, in the normalised scene; the integer is 0.
    pub lamps: UVec4,
    /// Half its size; below zero if they find none, and very large where the background is light.
    pub lamps_half: UVec4,
    /// The place that became zero when the scene was normalised, as the rows of [`Instance`](super::Instance)s give places.
    pub origin: UVec4,
    /// The image's width in pixels.
    pub width: u32,
    /// The image's height in pixels.
    pub height: u32,
    /// Samples along a pixel's edge.
    pub samples: u32,
    /// The launch's first sample within each pixel.
    pub sample: u32,
    /// The region's left column.
    pub left: u32,
    /// The region's top row.
    pub top: u32,
    /// The region's columns.
    pub columns: u32,
    /// The region's rows.
    pub rows: u32,
    /// Blocks of pixels that lie beside each other in the region, see [`crate::camera::across`].
    pub across: u32,
    /// Slots for one sample of every pixel of the region.
    pub pixel_slots: u32,
    /// Slots of the launch, which takes several samples at once: a multiple of `pixel_slots`. Of a stream, its rays.
    pub slots: u32,
    /// How often a ray is reflected or refracted at most.
    pub bounces: u32,
    /// The least share of its sample that a ray is followed for.
    pub min_contribution: f32,
    /// How many lights there are.
    pub lights: u32,
    /// The word at which the vertices of indexed triangles start.
    pub vertices: u32,
    /// Shadow rays that a slot asks for in a wave.
    pub shadow_rays: u32,
    /// What pixels draw their numbers from, beside their place.
    pub seed: u32,
    /// How many lights an integrator chooses from that samples one of them.
    pub emitters: u32,
    /// Bounces before Russian roulette may end a path.
    pub roulette: u32,
    /// The most that light adds to a sample which was scattered more than once; 0 for no limit.
    pub clamp: f32,
    /// How far ambient occlusion looks, in the normalised scene.
    pub reach: f32,
    /// How much wider a sample of the camera becomes on a unit of its way, or how wide it is where rays are parallel.
    pub spread: f32,
    /// The probability that the environment is chosen of all lights.
    pub environment: f32,
    /// How many of the emitters are far away, which are the first, where there are [many](super::Effects::MANY_LIGHTS).
    pub far: u32,
    /// Not 0 if the film starts anew with this launch.
    pub anew: u32,
    /// Steps of the table of a pixel filter ([`Launch::FILTERED`]) that are half a cell.
    pub filter_steps: f32,
    /// The diameter of the camera's lens in the normalised scene, 0 without one ([`Launch::LENS`]).
    pub aperture: f32,
    /// What half a cell is of an angle where rays go all around ([`Launch::ROUND`]): of a turn, or, for
    /// [`Projection::EQUISOLID`](super::Projection), of the sine of half the angle from the middle.
    pub angle: f32,
    /// How far from the camera's plane, or from a camera that sees all around, its rays start, in the normalised scene ([`Launch::CLIPPED`]).
    pub near: f32,
    /// And end; 0 for no end.
    pub farthest: f32,
    /// How far each of two eyes is from the middle, in lengths of the camera's vector to the right ([`Launch::STEREO`]).
    pub eyes: f32,
    /// The same times the part of its distance at which both look at one place: 0 if they look in parallel.
    pub converging: f32,
    /// How many arbitrary output variables the film keeps ([`Aovs`](super::Aovs)).
    pub aovs: u32,
    /// The group of lamps that the surroundings are in; 0 for none.
    pub group: u32,
    /// How many pairs of nodes there are: what refers to one behind them refers to a copy of a mesh.
    pub pairs: u32,
    /// How many even steps the time has in which the shutter is open, each with a key at its start and its end
    /// ([`Launch::MOVING`], [`Launch::PANNED`]); 0 for rays without a time, as those of streams.
    pub steps: u32,
    /// For how much of that time each row is exposed: 1 without a rolling shutter.
    pub exposure: f32,
    /// How much later each row's exposure begins than that of the row above.
    pub row_delay: f32,
    /// The first key of the camera, among the records of copies, or [`Frame::STILL`].
    pub keys: u32,
    /// What the camera is in (see [`Inside`](crate::medium::Inside)) and, in the upper eight bits, [`Frame::fog`].
    pub media: u32,
    /// Photons of a sample of the picture; 0 without them ([`photon`](crate::photon)).
    pub photons: u32,
    /// The first of a sample's photons that a launch of photons follows.
    pub photon: u32,
    /// Lists of their grid, a power of two.
    pub heads: u32,
    /// How far the first sample of a pixel looks for photons, in the normalised scene.
    pub radius: f32,
}

impl Frame {
    /// In place of the first key of a camera that does not move.
    pub const STILL: u32 = u32::MAX;

    /// The medium outside of all surfaces, by its number; 0 for none.
    #[inline(always)]
    pub fn fog(&self) -> u32 {
        self.media >> Inside::BITS
    }

    /// What the camera is in.
    #[inline(always)]
    pub fn inside(&self) -> Inside {
        Inside(self.media).scattered()
    }

    /// The step that a time of the shutter is in, of which 0 is its opening and 1 its closing, and the share of the step before it.
    #[inline(always)]
    pub fn step(&self, time: f32) -> (u32, f32) {
        step(self.steps, time)
    }

    /// Does the camera have a lens? Others of the scene may have one.
    #[inline(always)]
    pub fn has_lens(&self, launch: Launch) -> bool {
        launch.has(Launch::LENS) && self.aperture != 0.0
    }
}

// A function of its own on the GPU, so that a module holds it once.
#[cfg_attr(target_arch = "spirv", inline(never))]
#[cfg_attr(not(target_arch = "spirv"), inline(always))]
fn step(steps: u32, time: f32) -> (u32, f32) {
    let all = time * steps as f32;
    let last = if steps == 0 { 0 } else { steps - 1 };
    let step = (all.floor_index() as u32).min(last);
    (step, (all - step as f32).flush(SMALL))
}
