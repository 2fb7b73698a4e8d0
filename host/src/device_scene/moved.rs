//! A scene at another moment, by the hierarchy that it has.

use eyerays_bvh::Bvh;
use eyerays_bvh::refit::refit;
use eyerays_shader::data::Primitive;

use super::DeviceScene;
use crate::error::Result;
use crate::scene::Scene;

impl DeviceScene {
    /// The scene with its surfaces elsewhere, or another one: with the hierarchy that there is, fitted to where they are (thesis 4.1.1), as
    /// long as it has the same number of triangles, spheres and disks, and costs at most [`DeviceScene::WORN`] times what it cost
    /// when it was built; else by a new one.
    ///
    /// # Errors
    /// As [`DeviceScene::new`].
    pub fn moved(&self, scene: &Scene) -> Result<DeviceScene> {
        scene.check()?;
        let (quality, is_wide) = self.quality;
        Self::of_checked(scene, quality, is_wide, Some(self))
    }

    /// How many times what it cost by the surface area heuristic a hierarchy may cost that is fitted to what has moved.
    pub const WORN: f64 = 1.5;

    /// Was its hierarchy [fitted](DeviceScene::moved) from that of another moment?
    pub fn is_fitted(&self) -> bool {
        self.is_fitted
    }

    /// Its hierarchy for primitives elsewhere, if it may be.
    pub(super) fn fitted(&self, primitives: &[Primitive]) -> Option<Bvh> {
        let is_alike = !self.is_left_open() && self.statistics().primitives == primitives.len();
        if !self.instances.is_empty() || !is_alike {
            return None;
        }
        let order = self.primitives.iter().map(Primitive::number).collect();
        let (bvh, cost) = refit(self.nodes(), order, primitives).ok()?;
        (cost <= Self::WORN * self.built_cost).then_some(bvh)
    }
}
