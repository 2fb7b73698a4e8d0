//! The hierarchy by which one light of many is chosen, see [`LightNode`].

mod cone;
mod split;
#[cfg(test)]
mod tests;

use eyerays_shader::data::{LightNode, pack};
use glam::DVec3;

pub use cone::Cone;
use split::split;

/// A light that has a place, or several of them.
#[derive(Debug, Clone, Copy)]
pub struct Bounded {
    /// The least corner of a box around them, in the normalised scene.
    pub least: DVec3,
    /// The greatest.
    pub greatest: DVec3,
    /// The sum of their greatest radiant intensities, the mean of the channels.
    pub intensity: f64,
    /// Where they shine.
    pub cone: Cone,
}

impl Bounded {
    fn with(self, other: Bounded) -> Bounded {
        // What is black shines nowhere.
        let cone = match (self.intensity > 0.0, other.intensity > 0.0) {
            (true, false) => self.cone,
            (false, true) => other.cone,
            _ => self.cone.with(other.cone),
        };
        Bounded {
            least: self.least.min(other.least),
            greatest: self.greatest.max(other.greatest),
            intensity: self.intensity + other.intensity,
            cone,
        }
    }

    fn middle(&self) -> DVec3 {
        (self.least + self.greatest) / 2.0
    }
}

/// Its nodes, the root first, and for each light the way to its leaf, see
/// [`Emitter::trail`](eyerays_shader::data::Emitter::trail).
#[derive(Debug)]
pub struct LightTree {
    pub nodes: Vec<LightNode>,
    pub trails: Vec<u32>,
}

impl LightTree {
    /// Of lights whose emitters are numbered from `first` on: the same nodes for the same lights, two less one for each.
    pub fn new(lights: &[Bounded], first: u32) -> LightTree {
        let total: f64 = lights.iter().map(|light| light.intensity).sum();
        let mut builder = Builder { lights, first, total, nodes: Vec::new(), trails: vec![0; lights.len()] };
        let mut order: Vec<u32> = (0..lights.len() as u32).collect();
        if !order.is_empty() {
            builder.nodes.reserve_exact(2 * order.len() - 1);
            builder.add(&mut order, 0, 0);
        }
        LightTree { nodes: builder.nodes, trails: builder.trails }
    }
}

struct Builder<'a> {
    lights: &'a [Bounded],
    first: u32,
    total: f64,
    nodes: Vec<LightNode>,
    trails: Vec<u32>,
}

impl Builder<'_> {
    /// Adds the node of some lights and all below; `trail` is the way to it.
    fn add(&mut self, order: &mut [u32], level: u32, trail: u32) -> Bounded {
        if let &mut [light] = order {
            let bounded = self.lights[light as usize];
            self.trails[light as usize] = trail;
            self.nodes.push(self.node(&bounded, LightNode::LEAF, self.first + light));
            return bounded;
        }
        let at = self.nodes.len();
        let nothing = pack(glam::Vec3::ZERO, 0);
        self.nodes.push(LightNode { middle: nothing, half: nothing, axis: nothing });
        // As many as have ways of one word.
        let most = 1u64 << (LightNode::MOST_LEVELS - level - 1);
        let middle = split(self.lights, order, most);
        let (left, right) = order.split_at_mut(middle);
        let left = self.add(left, level + 1, trail);
        let second = self.nodes.len() as u32;
        let right = self.add(right, level + 1, trail | 1 << level);
        let bounded = left.with(right);
        self.nodes[at] = self.node(&bounded, 0, second);
        bounded
    }

    fn node(&self, bounded: &Bounded, flags: u32, number: u32) -> LightNode {
        /// The least share that counts as more than none.
        const LEAST: f64 = 1.0 / (1u64 << 40) as f64;
        /// More than what single precision takes off.
        const MARGIN: f64 = 1e-6;
        let middle = bounded.middle().as_vec3();
        let half = (bounded.greatest - middle.as_dvec3()).max(middle.as_dvec3() - bounded.least) * (1.0 + MARGIN);
        let share = if self.total > 0.0 { bounded.intensity / self.total } else { 0.0 };
        let share = if share > 0.0 { share.max(LEAST) } else { 0.0 };
        let Cone { axis, opening, is_spread, is_two_sided } = bounded.cone;
        let flag = |holds, flag| if holds { flag } else { 0 };
        let flags = flags | flag(is_spread, LightNode::SPREAD) | flag(is_two_sided, LightNode::TWO_SIDED);
        let cosine = (crate::math::cos(opening) - MARGIN).max(-1.0) as f32;
        LightNode {
            middle: pack(super::flushed(middle), (share as f32).to_bits()),
            half: pack(super::flushed(half.as_vec3()), cosine.to_bits()),
            axis: pack(super::flushed(axis.as_vec3()), flags | number),
        }
    }
}
